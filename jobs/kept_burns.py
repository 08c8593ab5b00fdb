"""Burns as fixed cuts of the nest that was told from them: one way each, so that only the order can change."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from itertools import zip_longest

import numpy as np
import shapely

from kerfwise.arrays import Ints
from kerfwise.encoder.candidates.candidate import Candidate
from kerfwise.encoder.cut import Cut
from kerfwise.encoder.facts import compute_facts
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.check.rebuild import rebuild
from kerfwise.postproc.clock.contour_heat import contour_heat_kj
from kerfwise.postproc.dialects import fitting_dialect
from kerfwise.postproc.nc.body import cut_comment
from kerfwise.postproc.nc.names import program_names
from kerfwise.postproc.nc.program import head_comments
from kerfwise.postproc.old.contours import Told
from kerfwise.postproc.old.orders import in_turn
from kerfwise.postproc.old.pieces import TakenApart
from kerfwise.postproc.old.reordered import reordered
from kerfwise.postproc.old.unclear import NoNest, Unclear
from kerfwise.rules.profile.profile import Profile

from .ask import ask
from .kept_rows import keep_rows
from .listening import Listener
from .old_program import OldJob
from .produce import Produced, produce

_ON_RING_MM = 0.05


@dataclass(frozen=True, eq=False, slots=True)
class KeptBurns:
    """The facts of a nest with one candidate a contour, the cut that its burn makes of it; `cuts` are those cuts."""

    facts: Facts
    cuts: tuple[Cut, ...]


def plan_order(
    job: OldJob, kept: KeptBurns, told: Told, apart: TakenApart, limits: SolveOptions, listener: Listener
) -> Produced:
    """The best order of the burns by the rules of the profile; what no order can keep is relaxed, and said.

    Raises
    ------
    RulesConflict
        If no order was found.
    """
    chains, turns = _chains(told), _turns(told, apart)
    asked = ask(kept.facts, job.profile, relax=True, limits=limits)
    asked = keep_rows(asked, job.profile, chains, kept.cuts, turns)
    fixed = bool(chains) or len(turns) > 0  # other zones would be stated without them
    writer = BurnWriter(told, apart)
    with listener:
        return produce(
            asked, job.profile, limits, listener, and_zones=not fixed, write=writer.write, trusted=job.trusted
        )


def _chains(told: Told) -> list[list[int]]:
    """The contours of each burn that cuts several, in its order."""
    cut_by: dict[int, list[int]] = defaultdict(list)
    for name, burn in told.burn_of.items():
        cut_by[burn].append(told.nest.index[name])
    return [contours for contours in cut_by.values() if len(contours) > 1]


def _turns(told: Told, apart: TakenApart) -> Ints:
    """Pairs (before, after) of contours whose burns keep their turn."""
    of_burn = {burn: told.nest.index[name] for name, burn in told.burn_of.items()}  # of a chain the last one
    pairs = [(of_burn[one], of_burn[then]) for one, then in sorted(in_turn(apart.pieces))]
    return np.array(pairs, dtype=np.int64).reshape(-1, 2)


def facts_of_burns(job: OldJob, told: Told) -> KeptBurns:
    """The facts of the nest, with one candidate a contour: what its burn makes of it.

    Raises
    ------
    NoNest
        If a burn is not clearly the cut of its contours.
    """
    profile, nest = job.profile, told.nest
    kerf_mm = profile.material.kerf_mm
    built = rebuild(nest, job.program, kerf_mm, profile.home_on(nest), tabs_asked=profile.tabs())
    by_contour = {cut.contour: cut for cut in built.cuts}
    lines = {name: job.program.burns[k].line for name, k in told.burn_of.items()}
    wrong = {name: violation.text for violation in built.violations for name in violation.contours}
    wrong |= {name: f"it is not clearly the cut of {name}" for name in nest.index if name not in by_contour}
    wrong |= {cut.contour: f"it is not clearly how {cut.contour} is cut" for cut in built.cuts if not _plain(cut)}
    for cut, name in zip_longest(built.cuts, told.burn_of):
        if cut is None or cut.contour != name:
            wrong.setdefault(name or cut.contour, "its burns are not clearly its cut")
    if wrong:
        raise NoNest([Unclear(lines[name], text.partition(": ")[2] or text) for name, text in wrong.items()])
    lengths_mm = {run.name: run.length_mm for run in built.runs}
    cuts = tuple(by_contour[contour.id] for contour in nest.contours)
    candidates = [_candidate(cut, told, job, lengths_mm[cut.contour]) for cut in cuts]
    heat_kj = contour_heat_kj(nest, candidates, profile)
    return KeptBurns(compute_facts(nest, profile.fact_options(nest), candidates, heat_kj), cuts)


def _plain(cut: Cut) -> bool:
    """Whether a cut goes all round by itself, on the way from the one before if it is linked with that."""
    return cut.span is None and (not cut.linked or cut.lead_in is not None)


def _candidate(cut: Cut, told: Told, job: OldJob, length_mm: float) -> Candidate:
    nest, contour = told.nest, told.nest.contour(cut.contour)
    path = job.program.burns[told.burn_of[cut.contour]].path
    ring = told.round_of[cut.contour].line() if contour.encloses else path.line()
    pierce, end = cut.pierce, cut.end if contour.encloses else _last(path)
    lead_in = None if cut.linked else cut.lead_in
    if cut.linked and cut.lead_in is not None:  # the way to it, not of it
        pierce, length_mm = _last(cut.lead_in), length_mm - cut.lead_in.length_mm
    outside = nest.sheet.stated and not bool(shapely.contains_xy(nest.sheet.polygon, *pierce))
    return Candidate(
        contour=nest.index[cut.contour],
        entry_mm=contour.curve.project(cut.entry)[0],
        entry=cut.entry,
        direction=cut.direction,
        pierce=pierce,
        lead_in=lead_in,
        lead_out=cut.lead_out,
        end=end,
        cut_mm=length_mm,
        edge_start=outside,
        leaves=bool(shapely.distance(ring, shapely.Point(end)) > _ON_RING_MM),
        tabs=cut.tabs,
    )


def _last(path: Curve) -> Point:
    x, y = path.vertices[-1, :2].tolist()
    return x, y


@dataclass(frozen=True, eq=False, slots=True)
class BurnWriter:
    """Writes the program of a plan: the old burns in its order."""

    told: Told
    apart: TakenApart

    def order(self, plan: Plan) -> list[int]:
        """The burns, from 0, in the plan's order."""
        return list(dict.fromkeys(self.told.burn_of[planned.cut.contour] for planned in plan.cuts))

    def write(self, plan: Plan, nest: Nest, profile: Profile) -> str:
        """The program."""
        dialect = fitting_dialect(profile)
        names = program_names(nest, dialect)
        headings: dict[int, list[str]] = defaultdict(list)
        for k, planned in enumerate(plan.cuts, 1):
            text = cut_comment(k, names[planned.cut.contour], planned.cut, planned.kind == "mark", dialect)
            headings[self.told.burn_of[planned.cut.contour]] += [text] if text else []
        order = self.order(plan)
        return reordered(self.apart, order, head_comments(plan, nest, profile), [headings[k] for k in order])
