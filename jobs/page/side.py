"""One way to cut a nest as data: where the torch is at every moment, and what the check says of it."""

from __future__ import annotations

from kerfwise.encoder.corner_feed import paced
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Nest
from kerfwise.jobs.compare.side import Side
from kerfwise.jobs.given import Given
from kerfwise.jobs.summary import proof_of, summary_lines
from kerfwise.models.plan.plan import Plan, PlannedCut
from kerfwise.postproc.check import CheckResult
from kerfwise.postproc.nc.plan_paths import Toolpath, toolpaths
from kerfwise.postproc.report.page_data import Data, cut_data, rows_of, short, side_data
from kerfwise.rules.profile.profile import Profile

from .verdict import rules_data


def plan_side(given: Given, plan: Plan, verdict: CheckResult) -> Data:
    """A plan on its machine: the torch's own paths, with the kerf beside them.

    Raises
    ------
    InputError
        If the plan is one of another nest.
    """
    profile = given.profile.at_origin(plan.origin)
    nest = given.nest
    side = side_data(nest, plan, profile.home_on(nest))
    side |= {
        "profile": profile.name,
        "kerf_mm": short(profile.material.kerf_mm),
        "said": summary_lines(plan),
        "ok": verdict.ok,
        "cuts": [_cut(nest, made, profile) for made in toolpaths(plan, nest, profile)],
        "rules": rules_data(verdict, profile),
        "warnings": list(verdict.warnings),
    }
    side["figures"] |= {"proof": proof_of(plan), "cost": None if plan.cost is None else str(plan.cost)}
    return side


def program_side(side: Side) -> Data:
    """A program on its machine: its own burns, and what the check says of it."""
    nest, job = side.given.nest, side.times.timed.job
    begun = {round(burn.start_s, 3): burn for burn in side.burns}
    cuts = []
    for cut in side.cuts.new:
        contour = nest.contour(cut.contour)
        burn = begun.get(round(cut.start_s, 3))
        length_mm = contour.curve.length_mm if burn is None else burn.path.length_mm
        planned = PlannedCut(cut, contour.part, contour.kind, length_mm)
        data = cut_data(nest, planned, None if burn is None else burn.path)
        if burn is not None:
            data |= {"stand_s": short(burn.held_s + burn.pierce_s), "wait_s": short(burn.wait_s)}
        cuts.append(data)
    return {
        "name": side.name,
        "profile": side.profile.name,
        "kerf_mm": short(side.profile.material.kerf_mm),
        "home": [short(v) for v in side.home],
        "made": side.cuts.made,
        "end_s": short(max([side.times.total_s, *(cut["to_s"] for cut in cuts)])),
        "figures": {
            "cut_mm": short(job.on_mm), "idle_mm": short(job.idle_mm), "pierces": job.pierces, "status": "",
            "gap": None, "light_gap": None, "proof": side.proof, "cost": None,
        },
        "said": [],
        "ok": side.verdict.ok,
        "cuts": cuts,
        "pierces": [],
        "already": [nest.index[cut.contour] for cut in side.cuts.cuts[: side.cuts.made]],
        "rules": rules_data(side.verdict, side.profile),
        "warnings": list(side.verdict.warnings),
        "dropped": [],
        "left_out": [],
        "why": {},
        "heat": None,
        "nc": None,
    }  # fmt: skip


def _cut(nest: Nest, made: Toolpath, profile: Profile) -> Data:
    """A cut with its torch's way; where corners are slower, the way is in stretches, each so many times slower."""
    data = cut_data(nest, made.planned, made.path)
    data["stand_s"] = short(_stands_s(made, profile))
    data["unlit"] = [[short(low), short(high)] for low, high in made.unlit]
    law = profile.corner_feed()
    if law is not None and not made.marks:
        pieces = [(segment, share) for segment, share in paced(made.path, law) if segment.length_mm > 0]
        if len({share for _, share in pieces}) > 1:
            rows = [(*segment.start, segment.bulge) for segment, _ in pieces]
            data["path"] = rows_of(Curve.of([*rows, (*pieces[-1][0].end, 0.0)], closed=False))
            data["slow"] = [short(1 / share) for _, share in pieces]
    return data


def _stands_s(made: Toolpath, profile: Profile) -> float:
    """How long the torch stands where a cut begins; a mark is begun without a pierce."""
    if made.linked or made.marks:
        return 0.0
    if made.pierced:
        return profile.machine.at_hole_s
    return profile.machine.unpierced_s if made.edge_start else profile.machine.pierce_time_s
