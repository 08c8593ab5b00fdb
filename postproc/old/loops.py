"""The rounds that a burn makes, and which burns cannot be told."""

from __future__ import annotations

import math
from collections.abc import Sequence, Set
from dataclasses import dataclass

import numpy as np
import shapely

from kerfwise.arrays import Floats, point_tree
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point, Segment
from kerfwise.postproc.check.reader.program import Burn

# The rounds that a burn makes: the longest stretches of its path that end where they began.

CLOSED_MM = 0.02
"""How far the two ends of a round may lie apart."""
_LEAST_MM2 = 0.05
_STRAIGHT_MM = 0.002
"""How far a vertex may lie off the line or arc that goes on without it."""
_MOST_PAIRS = 2_000_000
OPEN = "its path does not close"


class NotRound(Exception):
    """Why a burn is not rounds with their leads, as the end of a sentence."""


@dataclass(frozen=True, eq=False, slots=True)
class Round:
    """A closed ring with what leads to it and away from it; `lead_in` and `lead_out` may have no length."""

    ring: Curve
    lead_in: Curve
    lead_out: Curve


def rounds_of(path: Curve) -> tuple[Round, ...]:
    """The rounds of an open torch-on path, in order: what leads to each comes from the end of the one before.

    Block ends that coincide bound a round; where a lead runs along the contour itself, the path's first or last point
    lies within a block. Raises NoRound if the path has no round, or one that crosses itself.

    Examples
    --------
    >>> two = [(0, 0), (9, 0), (9, 9), (0, 9), (0, 0), (20, 0), (60, 0), (60, 40), (20, 40), (20, 0)]
    >>> [(r.lead_in.length_mm, r.ring.length_mm) for r in rounds_of(Curve.of(two, closed=False))]
    [(0.0, 36.0), (20.0, 160.0)]
    """
    if path.length_mm <= 0:
        raise NotRound("it only pierces")
    bounds = _bounds(path)
    if not bounds:
        raise NotRound(OPEN)
    rounds, at_mm = [], 0.0
    for number, (begin_mm, end_mm) in enumerate(bounds, 1):
        until_mm = path.length_mm if number == len(bounds) else end_mm
        lead_in, lead_out = path.between(at_mm, begin_mm - at_mm), path.between(end_mm, until_mm - end_mm)
        rounds.append(Round(_closed(path, begin_mm, end_mm), lead_in, lead_out))
        at_mm = end_mm
    return tuple(rounds)


def _bounds(path: Curve) -> list[tuple[float, float]]:
    """Where rounds begin and end, mm along a path: the longest, and those of what leads to it and away from it."""
    found = _longest(path) if path.length_mm > 0 else None
    if found is None:
        return []
    begin_mm, end_mm = found
    ring = _closed(path, begin_mm, end_mm)
    if abs(ring.signed_area_mm2) < _LEAST_MM2:
        return []
    if not ring.polygon().is_valid:
        raise NotRound("its round crosses itself")
    after = _bounds(path.between(end_mm, path.length_mm - end_mm))
    return [*_bounds(path.between(0.0, begin_mm)), found, *((low + end_mm, high + end_mm) for low, high in after)]


def simplify_ring(ring: Curve) -> Curve:
    """The same closed curve without vertices in the middle of a line or an arc; arcs turn by half a turn at the most.

    Examples
    --------
    >>> simplify_ring(Curve.of([(5, 0), (10, 0), (10, 10), (0, 10), (0, 0)])).as_rows()
    [[10.0, 0.0], [10.0, 10.0], [0.0, 10.0], [0.0, 0.0]]
    """
    segments = list(ring.segments)
    k, passed = 0, 0
    while passed < len(segments) and len(segments) > 2:
        one, then = segments[k % len(segments)], segments[(k + 1) % len(segments)]
        joined = _joined(one, then)
        if joined is None:
            k, passed = k + 1, passed + 1
            continue
        segments[k % len(segments)] = joined
        del segments[(k + 1) % len(segments)]
        k, passed = k % len(segments), 0
    return Curve.of([(*segment.start, segment.bulge) for segment in segments])


def _joined(one: Segment, then: Segment) -> Segment | None:
    """Two segments as one, if the second goes on as the first does."""
    if one.is_arc != then.is_arc:
        return None
    if not one.is_arc:
        (ax, ay), (bx, by) = one.tangent_at(1.0), then.tangent_at(0.0)
        straight = abs(ax * by - ay * bx) * min(one.length_mm, then.length_mm) < _STRAIGHT_MM and ax * bx + ay * by > 0
        return Segment(one.start, then.end) if straight else None
    sweep = one.sweep_rad + then.sweep_rad
    same = math.dist(one.centre, then.centre) < _STRAIGHT_MM and one.bulge * then.bulge > 0
    if not same or abs(sweep) > math.pi + 1e-9:
        return None
    return Segment(one.start, then.end, math.tan(sweep / 4))


def _closed(path: Curve, begin_mm: float, end_mm: float) -> Curve:
    rows = path.between(begin_mm, end_mm - begin_mm).vertices
    return Curve(rows[:-1], closed=True)


def _longest(path: Curve) -> tuple[float, float] | None:
    """Path lengths at which the longest round begins and ends; of several alike, the first."""
    points = np.array([path.segments[0].start, *(segment.end for segment in path.segments)])
    at_mm = path.starts_mm
    found: list[tuple[float, float]] = []

    tree = point_tree(points)
    if tree.count_neighbors(tree, CLOSED_MM) > _MOST_PAIRS:
        raise NotRound("its path touches itself too often")
    pairs = tree.query_pairs(CLOSED_MM, output_type="ndarray")
    if len(pairs):
        low, high = at_mm[pairs.min(axis=1)], at_mm[pairs.max(axis=1)]
        found += zip(low.tolist(), high.tolist(), strict=True)
    last = len(path.segments)
    for k in {0, min(1, last)}:
        found += [(float(at_mm[k]), mm) for mm in _meets(path, points[k], k + 1, last)]
    for k in {last, max(last - 1, 0)}:
        found += [(mm, float(at_mm[k])) for mm in _meets(path, points[k], 0, k - 1)]
    found = [pair for pair in found if pair[1] - pair[0] > 4 * CLOSED_MM]
    return min(found, key=lambda pair: (round(pair[0] - pair[1], 3), pair[0]), default=None)


def _meets(path: Curve, point: Floats, first: int, end: int) -> list[float]:
    """Path lengths at which some of the segments come back to a point."""
    segments = path.segments[max(first, 0) : max(end, 0)]
    if not segments:
        return []
    lines = np.array([shapely.LineString(_chords(segment)) for segment in segments], dtype=object)
    near = np.flatnonzero(shapely.dwithin(lines, shapely.Point(*point), 2 * CLOSED_MM))
    met = []
    for k in near.tolist():
        share, off_mm = segments[k].project((float(point[0]), float(point[1])))
        if off_mm <= CLOSED_MM:
            met.append(float(path.starts_mm[first + k]) + share * segments[k].length_mm)
    return met


def _chords(segment: Segment) -> list[tuple[float, float]]:
    if not segment.is_arc:
        return [segment.start, segment.end]
    return [segment.start, *map(tuple, segment.flatten(CLOSED_MM / 4).tolist())]


# Rounds that are open but for a tab: the torch goes off short of where it joined, on its way there.

_BEND_RAD = math.radians(25.0)
"""How far the way over a tab may turn at either end of it."""


def round_up_to_tab(path: Curve, most_mm: float) -> Round:
    """The round of a path that ends no more than `most_mm` before a block's end that it has passed, heading for it.

    What is missing is filled by the line or arc that goes on as the path ends, and comes to that block as it begins.
    Raises NoRound if there is no such block, or more than one.

    Examples
    --------
    >>> square = [(5, -3), (5, 0), (10, 0), (10, 10), (0, 10), (0, 0), (2, 0)]
    >>> found = round_up_to_tab(Curve.of(square, closed=False), 4.0)
    >>> found.lead_in.length_mm, found.ring.length_mm
    (3.0, 40.0)
    """
    last = path.segments[-1]
    begins = [k for k, segment in enumerate(path.segments[:-2]) if _heads_for(last, segment, most_mm)]
    if not begins:
        raise NotRound(OPEN)
    if len(begins) > 1:
        raise NotRound(f"{OPEN}, and nobody can be sure where a tab of it ends")
    begin_mm = float(path.starts_mm[begins[0]])
    rows = path.between(begin_mm, path.length_mm - begin_mm).as_rows()
    (tx, ty), (ux, uy) = last.tangent_at(1.0), path.segments[begins[0]].tangent_at(0.0)
    turn = math.atan2(tx * uy - ty * ux, tx * ux + ty * uy)
    *joined, (x, y, *_) = rows
    ring = Curve.of([*joined, (x, y, math.tan(turn / 4))])
    if not ring.polygon().is_valid:
        raise NotRound("its round crosses itself")
    return Round(ring, path.between(0.0, begin_mm), path.between(path.length_mm, 0.0))


def _heads_for(last: Segment, begins: Segment, most_mm: float) -> bool:
    """Whether a path that ends so is on its way to where a block begins, which goes on that way."""
    apart_mm = math.dist(last.end, begins.start)
    if not CLOSED_MM < apart_mm <= most_mm:
        return False
    way = (begins.start[0] - last.end[0]) / apart_mm, (begins.start[1] - last.end[1]) / apart_mm
    return max(_turn_rad(last.tangent_at(1.0), way), _turn_rad(way, begins.tangent_at(0.0))) <= _BEND_RAD


def _turn_rad(one: Point, then: Point) -> float:
    return math.acos(min(max(one[0] * then[0] + one[1] * then[1], -1.0), 1.0))


# What each burn of a program goes round: nothing for a mark, one contour mostly, several where the torch stays on.

_TABS = "if it stops before a tab, have the profile ask for tabs"


@dataclass(frozen=True, eq=False, slots=True)
class BurnContour:
    """One thing that a burn cuts: the number of the burn, and a round of it; marks have none."""

    number: int
    burn: Burn
    round: Round | None


def contours_of_burns(burns: Sequence[Burn], tab_mm: float, aside: Set[int]) -> tuple[list[BurnContour], list[Unclear]]:
    """What all burns cut, in order, and those of which nobody can say it.

    A burn that stops no more than `tab_mm` short of where it joined has left a tab there; 0 where there are none. Burns
    of the lines `aside` are not looked at.
    """
    found: list[BurnContour] = []
    unclear: list[Unclear] = []
    for number, burn in enumerate(burns):
        if burn.line in aside:
            continue
        try:
            found += [BurnContour(number, burn, one) for one in (_rounds(burn, tab_mm) if burn.tool == 0 else (None,))]
        except NotRound as why:
            hint = f" ({_TABS})" if str(why) == OPEN and not tab_mm else ""
            unclear.append(Unclear(burn.line, f"{why}{hint}"))
    return found, unclear


def _rounds(burn: Burn, tab_mm: float) -> tuple[Round, ...]:
    try:
        return rounds_of(burn.path)
    except NotRound as why:
        if str(why) != OPEN or not tab_mm or burn.unlit:
            raise
        return (round_up_to_tab(burn.path, tab_mm),)


# Burns of which nobody can say what they cut.


@dataclass(frozen=True, slots=True)
class Unclear:
    """A burn of which nobody can say what it cuts: the line, and why."""

    line: int
    why: str

    def __str__(self) -> str:
        return f"line {self.line}: {self.why}"


class AmbiguousNest(Exception):
    """The burns of a program make no nest; `unclear` are those at fault."""

    def __init__(self, unclear: Sequence[Unclear]) -> None:
        self.unclear = tuple(unclear)
        super().__init__("; ".join(map(str, unclear)))
