"""What a plan says of itself, against what its cuts come to."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import shapely

from kerfwise.encoder.cut import Cut, CutSequence
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest
from kerfwise.rules.rule import Violation

from .judgement import Judgement
from .program_rules import tolerance_mm
from .torch_run import TorchRun

_IDLE_MM, _LENGTH_MM, _LENGTH_SHARE, _TIME_S = 0.1, 0.1, 0.001, 0.01


@dataclass(frozen=True, slots=True)
class Claims:
    """What a plan states: totals, the torch-on length of each cut, and which rules hold (none where it is silent).

    `of_all` is false for a plan made with another profile than it is judged by: it knows nothing of further rules.
    """

    cut_mm: float
    idle_mm: float
    pierces: int
    time_s: float
    lengths_mm: tuple[float, ...]
    rules: Mapping[str, bool] = field(default_factory=dict)
    of_all: bool = True


def idle_mm(nest: Nest, cuts: CutSequence) -> float:
    """Idle travel: home, every pierce and end in order, those of pierce passes among them, and home again, mm."""
    ends = [cuts.home, *(end_of(nest, cut) for cut in cuts.way)]
    starts = [*(cut.pierce for cut in cuts.way), cuts.home]
    pierced = cuts.pierced
    ways = (
        (a, *(hole.at for hole in pierced.get(k, ())), b) for k, (a, b) in enumerate(zip(ends, starts, strict=True), 1)
    )
    return math.fsum(math.dist(a, b) for way in ways for a, b in pairwise(way))


def totals(
    nest: Nest, cuts: CutSequence, runs: Sequence[TorchRun], claims: Claims, unpierced: Collection[int] = ()
) -> list[Violation]:
    """Totals, lengths and times that do not fit the cuts; those at the positions `unpierced` begin in an old kerf."""
    found: list[Violation] = []

    def wrong(text: str, position: int | None = None) -> None:
        contours = () if position is None else (cuts[position - 1].contour,)
        found.append(Violation("totals", contours, text, () if position is None else (position,)))

    idle = idle_mm(nest, cuts)
    if abs(idle - claims.idle_mm) > _IDLE_MM:
        wrong(f"the idle travel is {idle:.3f} mm, the plan says {claims.idle_mm:.3f} mm")
    allowed = 0.0
    for run in runs:
        slack = _LENGTH_MM + _LENGTH_SHARE * run.length_mm
        allowed += slack
        said = claims.lengths_mm[run.position - 1 - cuts.made]
        if abs(run.length_mm - said) > slack:
            wrong(f"{run.where}: {run.name} is {run.length_mm:.3f} mm long, the plan says {said:.3f} mm", run.position)
    cut = math.fsum(run.length_mm for run in runs)
    if abs(cut - claims.cut_mm) > max(allowed, _LENGTH_MM):
        wrong(f"the torch is on for {cut:.3f} mm, the plan says {claims.cut_mm:.3f} mm")
    fewest, most = _pierces(nest, cuts, unpierced)
    if not fewest <= claims.pierces <= most:
        wrong(f"there are {fewest} pierces, the plan says {claims.pierces}")
    _times(cuts, claims, wrong)
    return found


def _times(cuts: CutSequence, claims: Claims, wrong: Callable[..., None]) -> None:
    """What is wrong with the order of times: cuts, and holes of passes, follow each other."""
    before = 0.0
    pierced = cuts.pierced
    for position, one in enumerate(cuts.new, cuts.made + 1):
        for hole in pierced.get(position, ()):
            if hole.start_s < before - _TIME_S or hole.end_s < hole.start_s:
                wrong(f"the hole of {hole.contour} is pierced before what comes before it has ended", position)
            before = max(before, hole.end_s)
        if one.torch == 1 and (one.start_s < before - _TIME_S or one.end_s < one.start_s):
            wrong(f"cut {position} of {one.contour} begins before the one before it has ended, or ends first", position)
        before = max(before, one.end_s)
    if claims.time_s < before - _TIME_S:
        wrong(f"the last cut ends at {before:.1f} s, the plan says that all takes {claims.time_s:.1f} s")


def end_of(nest: Nest, cut: Cut) -> Point:
    """Where the torch goes off: at the end of the lead-out, of an open mark, or of the round, which is its start."""
    if cut.lead_out is not None:
        return cut.end
    contour = nest.contours[nest.index[cut.contour]] if cut.contour in nest.index else None
    if contour is not None and not contour.curve.closed:
        x, y = contour.curve.vertices[-1 if cut.direction == "ccw" else 0, :2].tolist()
        return x, y
    if cut.lead_in is not None:
        x, y = cut.lead_in.vertices[-1, :2].tolist()
        return x, y
    return cut.entry


def _pierces(nest: Nest, cuts: CutSequence, unpierced: Collection[int]) -> tuple[int, int]:
    """Cuts that pierce the sheet; an edge start right at the edge may count or not."""
    new = enumerate(cuts.new, cuts.made + 1)
    cut = (c for k, c in new if not c.linked and k not in unpierced and c.contour in nest.index)
    torch = [c.pierce for c in cut if nest.contour(c.contour).kind != "mark"]
    points = shapely.points(torch) if torch else []
    sheet = shapely.make_valid(nest.sheet.polygon)
    counts = [
        int(shapely.contains(shapely.buffer(sheet, by), points).sum()) for by in (-tolerance_mm(), tolerance_mm())
    ]
    return counts[0], counts[1]


def claims_kept(claims: Claims, judged: Sequence[Judgement]) -> tuple[list[Violation], list[str]]:
    """Rules that the plan says hold and that do not, or the other way round: violations if hard, warnings if soft."""
    violations: list[Violation] = []
    warnings: list[str] = []
    for judgement in judged if claims.rules else ():
        said = claims.rules.get(judgement.id)
        if said == judgement.holds or judgement.verdict in ("not judged", "off"):
            continue
        if said is None and not claims.of_all:
            continue
        state = "holds" if judgement.holds else "is broken"
        says = "nothing of it" if said is None else "that it holds" if said else "that it is broken"
        text = f"rule {judgement.id} {state}, the plan says {says}"
        if judgement.strength == "hard":
            violations.append(Violation("claims", (), text))
        else:
            warnings.append(text)
    return violations, warnings
