"""What a plan says of itself against what its cuts come to, and a program against its plan."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import accumulate, pairwise

import shapely

from kerfwise.encoder.cut import Cut, CutSequence
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest
from kerfwise.rules.judging.violation import Violation
from kerfwise.rules.profile.plant_sections import Origin

from .result import Judgement, RelaxedStatement
from .torch_run import TorchRun, step_mm, tolerance_mm

# A program held against the plan that it is said to be made from, where the program itself says nothing of it.
#
# Some controls take no comments. Then names, zones, the start side, excuses, and what was cut before a stop, are the
# plan's, and the program has to follow the plan, cut by cut.

_RULE = "follows-plan"


@dataclass(frozen=True, eq=False, slots=True)
class PlanClaims:
    """What a plan says: its cuts, those made before a stop among them, what it relaxes, and the machine's zero.

    `time_s` is how long the program takes; None where the plan does not say so.
    """

    cuts: CutSequence
    relaxed: tuple[RelaxedStatement, ...] = ()
    origin: Origin = "drawing"
    time_s: float | None = None

    def names_of_burns(self) -> list[str]:
        """The first contour of each burn that the plan asks for."""
        return [cut.contour for _, cut in self.cuts.new_burns if not cut.linked]

    def completed(self, cuts: CutSequence) -> CutSequence:
        """The cuts of a program, with what the plan says of them and the program does not."""
        by_contour = {cut.contour: cut for cut in self.cuts}
        side = cuts.start_side if cuts.start_side is not None else self.cuts.start_side
        return replace(cuts, cuts=tuple(_completed(cut, by_contour.get(cut.contour)) for cut in cuts), start_side=side)


def _completed(cut: Cut, planned: Cut | None) -> Cut:
    """The cut with what the plan knows of it; where it joins the torch's ring as planned, its entry is the plan's.

    Beside a corner the ring is as near to several points of the contour, so that nobody can tell the entry from it.
    """
    if planned is None:
        return cut
    excused = tuple(dict.fromkeys((*cut.excused, *planned.excused)))
    joins = planned.lead_in is not None and math.dist(cut.join, planned.join) <= 2 * tolerance_mm()
    return replace(cut, zone=cut.zone or planned.zone, excused=excused, entry=planned.entry if joins else cut.entry)


def strays_from(planned: PlanClaims, nest: Nest, cuts: CutSequence, kerf_mm: float) -> Iterator[Violation]:
    """Where a program does not follow its plan: another contour, another entry, pierce or direction, more or fewer."""
    if cuts.made != planned.cuts.made:
        text = f"it goes on after cut {cuts.made}, the plan after cut {planned.cuts.made}"
        yield Violation(_RULE, (), text)
        return
    for k, (cut, planned_cut) in enumerate(zip(cuts.new, planned.cuts.new, strict=False), cuts.made + 1):
        if cut.contour != planned_cut.contour:
            text = f"cut {k} is of {cut.contour}, the plan says {planned_cut.contour}"
            yield Violation(_RULE, (cut.contour, planned_cut.contour), text, (k,))
        else:
            closed = cut.contour in nest.index and nest.contour(cut.contour).curve.closed
            for text in _differences(cut, planned_cut, closed, kerf_mm):
                yield Violation(_RULE, (cut.contour,), f"cut {k} of {cut.contour} {text}", (k,))
    yield from _other_stretches(planned.cuts, cuts, kerf_mm)
    asked_holes = planned.cuts.pierces
    for k, (hole, burnt) in enumerate(zip(cuts.pierces, asked_holes, strict=False), 1):
        if hole.before != burnt.before or math.dist(hole.at, burnt.at) > 2 * tolerance_mm(kerf_mm):
            text = f"pierce {k} of its passes is not the one of the plan, at ({burnt.at[0]:z.2f}, {burnt.at[1]:z.2f})"
            yield Violation(_RULE, (burnt.contour,) if burnt.contour else (), text, (hole.before,))
    if len(cuts.pierces) != len(asked_holes):
        text = f"it makes {len(cuts.pierces)} holes in pierce passes, the plan {len(asked_holes)}"
        yield Violation(_RULE, (), text)
    if len(cuts.new) != len(planned.cuts.new):
        yield Violation(_RULE, (), f"it makes {len(cuts.new)} cuts, the plan {len(planned.cuts.new)}")


def _other_stretches(planned: CutSequence, cuts: CutSequence, kerf_mm: float) -> Iterator[Violation]:
    """Burns that finish no contour and begin elsewhere, or at another time, than those of the plan."""
    begun = [(k, cut) for k, cut in planned.begun if k > planned.made and not cut.linked]
    seen = [(k, cut) for k, cut in cuts.begun if k > cuts.made and not cut.linked]
    for (k, cut), (at, other) in zip(begun, seen, strict=False):
        if k != at or math.dist(cut.pierce, other.pierce) > 2 * tolerance_mm(kerf_mm):
            text = f"{cut.way} begins before cut {at} at {_at(other.pierce)}, the plan says before cut {k} at "
            yield Violation(_RULE, (cut.contour,), f"{text}{_at(cut.pierce)}")
    if len(begun) != len(seen):
        yield Violation(_RULE, (), f"{len(seen)} of its burns finish no contour, {len(begun)} of the plan's do")


def _differences(cut: Cut, planned: Cut, closed: bool, kerf_mm: float) -> Iterator[str]:
    allowed_mm = 2 * tolerance_mm(kerf_mm)
    if cut.direction != planned.direction:
        yield f"goes {cut.direction if closed else 'the other way'}, the plan says {planned.direction}"
    if cut.torch != planned.torch:
        yield f"is made by torch {cut.torch}, the plan says torch {planned.torch}"
    if cut.linked != planned.linked:
        yield (
            "is linked with the cut before, the plan has it pierced" if cut.linked else "is pierced, the plan links it"
        )
    for what, at, value in (("enters", cut.entry, planned.entry), ("begins", cut.pierce, planned.pierce)):
        apart_mm = math.dist(at, value)
        if what == "begins" and cut.linked and planned.linked and planned.lead_in is not None:
            # It leaves its ring at a low angle, and after a kerf it is out of it: somewhere there it is seen to begin.
            along_mm, off_mm = planned.lead_in.project(at)
            apart_mm = off_mm if along_mm <= kerf_mm else apart_mm
        if apart_mm > allowed_mm:
            yield f"{what} at {_at(at)}, {apart_mm:.2f} mm from where the plan does, {_at(value)}"


def _at(point: Sequence[float]) -> str:
    return f"({point[0]:z.2f}, {point[1]:z.2f})"


_IDLE_MM, _LENGTH_MM, _LENGTH_SHARE, _TIME_S = 0.1, 0.1, 0.001, 0.01


@dataclass(frozen=True, slots=True)
class Claims:
    """What a plan states: totals, the torch-on length of each cut, and which rules hold (none where it is silent).

    `begun_mm` are the lengths of cuts that leave their contours unfinished. `blocks` are the lines of its program, None
    where no times are judged.

    `of_all` is false for a plan made with another profile than it is judged by: it knows nothing of further rules.
    """

    cut_mm: float
    idle_mm: float
    pierces: int
    time_s: float
    lengths_mm: tuple[float, ...]
    rules: Mapping[str, bool] = field(default_factory=dict)
    of_all: bool = True
    begun_mm: tuple[float, ...] = ()
    blocks: int | None = None


def idle_mm(nest: Nest, cuts: CutSequence) -> float:
    """Idle travel: home, every pierce and end in order, those of pierce passes among them, and home again, mm."""
    way = [(k, cut) for k, cut in cuts.new_burns if cut.torch == 1]
    ends = [cuts.home, *(end_of(nest, cut) for _, cut in way)]
    starts = [*(cut.pierce for _, cut in way), cuts.home]
    pierced = cuts.pierced
    number = [1, *accumulate((int(cuts.finishes(k, cut)) for k, cut in way), initial=1)][1:]
    ways = ((a, *(hole.at for hole in pierced.pop(k, ())), b) for k, a, b in zip(number, ends, starts, strict=True))
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
    begun = iter(claims.begun_mm)
    for run in runs:
        slack = _LENGTH_MM + 4 * step_mm() + _LENGTH_SHARE * run.length_mm
        allowed += slack
        claimed_mm = claims.lengths_mm[run.position - 1 - cuts.made] if run.position else next(begun, 0.0)
        if abs(run.length_mm - claimed_mm) > slack:
            text = f"{run.where}: {run.name} is {run.length_mm:.3f} mm long, the plan says {claimed_mm:.3f} mm"
            wrong(text, run.position or None)
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
        return contour.curve.end if cut.direction == "ccw" else contour.curve.start
    return cut.entry if cut.lead_in is None else cut.lead_in.end


def _pierces(nest: Nest, cuts: CutSequence, unpierced: Collection[int]) -> tuple[int, int]:
    """Cuts that pierce the sheet; an edge start right at the edge may count or not."""
    new = ((k if cuts.finishes(k, c) else 0, c) for k, c in cuts.new_burns)
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
        claim = claims.rules.get(judgement.id)
        if claim == judgement.holds or judgement.verdict in ("not judged", "off"):
            continue
        if claim is None and not claims.of_all:
            continue
        state = "holds" if judgement.holds else "is broken"
        says = "nothing of it" if claim is None else "that it holds" if claim else "that it is broken"
        text = f"rule {judgement.id} {state}, the plan says {says}"
        if judgement.strength == "hard":
            violations.append(Violation("claims", (), text))
        else:
            warnings.append(text)
    return violations, warnings
