"""The page of a plan: nest, plan, verdict and program as data for the browser."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.torch_path import paced
from kerfwise.jobs.display import proof_of, summary_lines
from kerfwise.jobs.inputs import Inputs
from kerfwise.jobs.programs import check_made
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.check import CheckResult
from kerfwise.postproc.check.reader.program import Burn
from kerfwise.postproc.check.result import Judgement
from kerfwise.postproc.clock import read_program
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.nc.toolpaths import Toolpath, toolpaths
from kerfwise.postproc.report.legend import nest_name
from kerfwise.rules.profile.profile import Profile

from .page_html import Data, cut_data, page_html, page_of, plain_page, rows_of, short, side_data, state_data
from .page_reasons import Detail, heat_data, reasons


def page_data(
    inputs: Inputs,
    plan: Plan | None,
    verdict: CheckResult | None = None,
    program: str | None = None,
    heat: bool | None = None,
    detail: Detail | None = None,
) -> Data:
    """All that the page of a plan shows, as JSON can hold it; of a nest alone where there is no plan.

    Parameters
    ----------
    inputs
        Nest and profile.
    plan
        Of that nest.
    verdict, program
        Of the plan, where they are known; else they are made. "" is a program that is not written yet.
    heat
        Whether to simulate the heat; None simulates it where that takes seconds.
    detail
        How much is worked out of why each contour is cut where it is; None for all in plans of up to `FULL` contours,
        and for what holds each in larger ones.

    Raises InputError if the plan is one of another nest.
    """
    home = inputs.profile.home_on(inputs.nest)
    if plan is None:
        return plain_page(inputs.nest, None, home)
    profile = inputs.profile.at_origin(plan.origin)
    side = plan_side(inputs, plan, verdict or check_made(inputs, plan))
    side["why"] = reasons(inputs, plan, detail)
    side["heat"] = heat_data(inputs, plan, heat)
    side["unchecked"] = program == ""
    if program is None:
        program = write_program(plan, inputs.nest, profile)
    side["nc"] = program_data(program, inputs.nest, profile) if program else None
    return page_of(inputs.nest, [side], nest_name(inputs.nest, plan))


def page_bytes(data: Data) -> bytes:
    """The page as the content of a file."""
    return page_html(data).encode("utf-8")


# One way to cut a nest as data: where the torch is at every moment, and what the check says of it.


def plan_side(inputs: Inputs, plan: Plan, verdict: CheckResult) -> Data:
    """A plan on its machine: the torch's own paths, with the kerf beside them.

    Raises InputError if the plan is one of another nest.
    """
    profile = inputs.profile.at_origin(plan.origin)
    nest = inputs.nest
    cuts = [cut for toolpath in toolpaths(plan, nest, profile) for cut in _cuts(nest, toolpath, profile)]
    side = side_data(nest, plan, profile.home_on(nest), cuts)
    side |= {
        "profile": profile.name,
        "kerf_mm": short(profile.material.kerf_mm),
        "said": summary_lines(plan),
        "ok": verdict.ok,
        "state": state_data(verdict.state),
        "rules": rules_data(verdict, profile),
        "warnings": list(verdict.warnings),
    }
    side["figures"] |= {"proof": proof_of(plan), "cost": None if plan.cost is None else str(plan.cost)}
    return side


def _cuts(nest: Nest, toolpath: Toolpath, profile: Profile) -> list[Data]:
    """A cut of the first torch, and those that further ones make with it: they go the same way beside it."""
    first = _cut(nest, toolpath, profile)
    found, (x, y) = [first], toolpath.planned.cut.pierce
    for planned in toolpath.together:
        away = planned.cut.pierce[0] - x, planned.cut.pierce[1] - y
        rows = [short(v + away[k % 3]) if k % 3 < 2 else v for k, v in enumerate(first["path"])]
        own = cut_data(nest, planned, toolpath.path) | {"path": rows, "torch": planned.cut.torch}
        found.append({**own, **{key: first[key] for key in ("stand_s", "unlit", "slow", "wait_s")}})
    return found


def _cut(nest: Nest, toolpath: Toolpath, profile: Profile) -> Data:
    """A cut with its torch's way; where corners are slower, the way is in stretches, each so many times slower."""
    data = cut_data(nest, toolpath.planned, toolpath.path)
    data["stand_s"] = short(_stands_s(toolpath, profile))
    data["unlit"] = [[short(low), short(high)] for low, high in toolpath.unlit]
    law = profile.corner_feed()
    if law is not None and not toolpath.marks:
        pieces = [(segment, share) for segment, share in paced(toolpath.path, law) if segment.length_mm > 0]
        if len({share for _, share in pieces}) > 1:
            rows = [(*segment.start, segment.bulge) for segment, _ in pieces]
            data["path"] = rows_of(Curve.of([*rows, (*pieces[-1][0].end, 0.0)], closed=False))
            data["slow"] = [short(1 / share) for _, share in pieces]
    return data


def _stands_s(toolpath: Toolpath, profile: Profile) -> float:
    """How long the torch stands where a cut begins; a mark is begun without a pierce."""
    if toolpath.linked or toolpath.marks:
        return 0.0
    if toolpath.pierced:
        return profile.machine.at_hole_s
    return profile.machine.unpierced_s if toolpath.edge_start else profile.machine.pierce_time_s


# What the check says of every rule, as data.


def rules_data(verdict: CheckResult, profile: Profile) -> list[Data]:
    """Every rule that is on: its strength, its verdict, where it is broken or excused, and what that costs, mm."""
    settings = profile.settings()
    weights = {name: setting.weight for name, setting in settings.items()}
    return [_rule(judged, weights.get(judged.id)) for judged in verdict.rules if judged.strength != "off"]


def _rule(judged: Judgement, weight_mm: float | None) -> Data:
    return {
        "id": judged.id,
        "sentence": judged.sentence,
        "strength": judged.strength,
        "verdict": judged.verdict,
        "cost_mm": short(len(judged.violations) * (weight_mm or 0.0), 1),
        "unjudged": judged.unjudged or "",
        "breaches": [{"contours": list(v.contours), "text": v.text} for v in judged.violations],
        "excused": [
            {"contours": list(e.violation.contours), "text": e.violation.text, "why": e.why} for e in judged.excused
        ],
    }


_COMMENT = re.compile(r"\([^)]*\)|;.*")
_MOVES = re.compile(r"[XYxy]\s*[-+.\d]")


def program_data(text: str, nest: Nest, profile: Profile) -> Data | None:
    """The text, and for each burn, from 0 on, its lines: where it begins, then one for each line or arc of its path.

    Where the lines of a burn cannot be told apart, as in a control's own language, it has the first and the last only.
    None for a program that cannot be read.
    """
    try:
        burns = read_program(text, nest, profile).burns
    except InputError:
        return None
    lines = text.splitlines()
    return {"text": text, "lines": [_lines(burn, after, lines) for burn, after in _with_next(burns, len(lines) + 1)]}


def _with_next(burns: Sequence[Burn], end: int) -> list[tuple[Burn, int]]:
    return list(zip(burns, [*(b.line for b in burns[1:]), end][: len(burns)], strict=True))


def _lines(burn: Burn, after: int, lines: Sequence[str]) -> list[int]:
    """Line numbers, from 1."""
    moves = [k for k in range(burn.line, after) if _MOVES.search(_COMMENT.sub("", lines[k - 1]))]
    count = len(burn.path.segments)
    if count and len(moves) >= count and all(a < b for a, b in pairwise(moves)):
        return [burn.line, *moves[:count]]
    return [burn.line, max(burn.line, after - 1)]
