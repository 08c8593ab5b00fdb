"""Whether lines surely run along each other, and a torch's round along all of its contour."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely

from kerfwise.arrays import Bools, Floats, Ints, concat_ranges

# Whether a torch's round surely runs beside all of its contour, told for many at once: every chord is followed along.
#
# Each chord of a contour is held against the stretch of the round that should run beside it. What this does not show
# is left to areas.

AT_ONCE = 1024
"""Contours that are looked at together: more would take memory, and no less time."""
_PAIRS = 4
"""Where stretches hold so many times more points than there are points, a round goes to and fro: nothing is known."""


def surely_beside(contours: Any, rounds: Any, beside_mm: float, within_mm: float) -> Bools:
    """Whether every point of each closed contour lies within `within_mm` of the closed line that goes round with it.

    True is proven; False says that it is not known. The round should run `beside_mm` beside the contour.

    Examples
    --------
    >>> square, other = (shapely.LinearRing([(0, 0), (9, 0), (9, 9), (0, y)]) for y in (9, 6))
    >>> one, two = (shapely.buffer(shapely.Polygon(ring), 1).exterior for ring in (square, other))
    >>> surely_beside([square, square], [one, two], 1.0, 1.1).tolist()
    [True, False]
    """
    lines, others = np.array(contours, dtype=object), np.array(rounds, dtype=object)
    found = np.zeros(len(lines), dtype=bool)
    drawn = np.flatnonzero((shapely.length(lines) > 0) & (shapely.length(others) > 0))
    for begin in range(0, len(drawn), AT_ONCE):
        some = drawn[begin : begin + AT_ONCE]
        found[some] = _beside(lines[some], others[some], beside_mm, within_mm)
    return found


def _beside(contours: Any, rounds: Any, beside_mm: float, within_mm: float) -> Bools:
    """A chord lies within the greater distance of its ends from two points of a round, and what that strays between.

    Points of the chord, and of the line between those two points, that are as far along are no further apart than the
    ends are. The round goes from one of the two to the other, so that beside each point of the line between them it has
    one that is no further off than its corners are at most. Which two points these are does not matter for that.
    """
    chords, way = _Chords(contours), _Way(rounds)
    sides = np.where((np.abs(way.turn) > np.abs(chords.turn)) == (chords.turn > 0), -1.0, 1.0).take(chords.of)
    aside = chords.left * (beside_mm * sides)[:, None]
    first = chords.first[:-1]
    start_mm = shapely.line_locate_point(
        rounds, shapely.points(chords.begin.take(first, axis=0) + aside.take(first, axis=0))
    )
    alike = np.where((way.turn > 0) == (chords.turn > 0), 1.0, -1.0)
    far_mm, at_mm, feet = [], [], []
    for ends, gone_mm in zip((chords.begin, chords.end), chords.gone_mm(beside_mm, sides), strict=True):
        near_mm = start_mm.take(chords.of) + alike.take(chords.of) * gone_mm
        foot, foot_mm = way.nearest(ends + aside, near_mm, chords.of)
        far_mm.append(np.hypot(*(ends - foot).T))
        at_mm.append(foot_mm)
        feet.append(foot)
    strays_mm = way.astray_mm(at_mm[0], at_mm[1], feet[0], feet[1], chords.of)
    off_mm = np.maximum(far_mm[0], far_mm[1]) + strays_mm + way.open_mm[chords.of]
    near = np.diff(chords.first) > 0
    near[chords.of[~(off_mm <= within_mm - ROUNDING_MM)]] = False
    return near


class _Chords:
    """The chords of closed lines one behind the other, the directions to their left, and how each line turns."""

    def __init__(self, lines: Any) -> None:
        points, of = shapely.get_coordinates(lines, return_index=True)
        x, y = points.T
        within = np.flatnonzero((of[1:] == of[:-1]) & ((x[1:] != x[:-1]) | (y[1:] != y[:-1])))
        self.begin, self.end = points.take(within, axis=0), points.take(within + 1, axis=0)
        self.of: Ints = of.take(within)
        self.first: Ints = np.searchsorted(self.of, np.arange(len(lines) + 1))
        self.turn = twice_area(points, of, len(lines))
        ways = self.end - self.begin
        self.length_mm: Floats = np.hypot(*ways.T)
        self.left: Floats = np.stack([-ways[:, 1], ways[:, 0]], axis=1) / self.length_mm[:, None]

    def gone_mm(self, beside_mm: float, sides: Floats) -> tuple[Floats, Floats]:
        """How far a line beside these, to the left where `sides` is 1, has gone at each chord's begin, and at its end.

        It rounds the corners that bend away from it, and is the shorter for the others.
        """
        before = np.arange(len(self.of)) - 1
        before[self.first[:-1]] = self.first[1:] - 1
        (x, y), (u, v) = self.left.take(before, axis=0).T, self.left.T
        bend = np.arctan2(x * v - y * u, x * u + y * v) * sides
        trimmed_mm = beside_mm * np.tan(np.clip(bend, 0.0, 3.0) / 2)
        after = np.append(trimmed_mm[1:], 0.0)
        after[self.first[1:] - 1] = trimmed_mm[self.first[:-1]]
        rounded_mm = beside_mm * np.maximum(-bend, 0.0)
        rounded_mm[self.first[:-1]] = 0.0
        ends_mm = np.cumsum(self.length_mm - trimmed_mm - after + rounded_mm)
        ends_mm -= np.repeat(np.append(0.0, ends_mm)[self.first[:-1]], np.diff(self.first))
        return ends_mm - (self.length_mm - trimmed_mm - after), ends_mm


class _Way:
    """The points of closed lines one behind the other, how far along all of them each lies, and how each line turns.

    `open_mm` is how far the ends of each line are apart.
    """

    def __init__(self, lines: Any) -> None:
        self.at, of = shapely.get_coordinates(lines, return_index=True)
        step_mm = np.hypot(*np.diff(self.at, axis=0, prepend=self.at[:1]).T)
        first = np.searchsorted(of, np.arange(len(lines) + 1))
        step_mm[first[:-1]] = 0.0
        self.along_mm = np.cumsum(step_mm)
        self._xy: Floats = np.ascontiguousarray(self.at.T)
        self.first, self.last = first[:-1], first[1:] - 1
        self.begin_mm = self.along_mm[self.first]
        self.round_mm = self.along_mm[self.last] - self.begin_mm
        self.open_mm: Floats = np.hypot(*(self.at[self.last] - self.at[self.first]).T)
        self.turn = twice_area(self.at, of, len(lines))

    def nearest(self, points: Floats, near_mm: Floats, of: Ints) -> tuple[Floats, Floats]:
        """The nearest points (m, 2) of lines `of` beside some place, and how far along their line they lie."""
        chord = self._behind(near_mm % np.maximum(self.round_mm.take(of), ROUNDING_MM), of)
        (at_x, at_y), (x, y) = self._xy, points.T
        first, last, begin_mm = self.first.take(of) + 1, self.last.take(of), self.begin_mm.take(of)
        best_mm2 = np.full(len(of), np.inf)
        foot_x, foot_y, at_mm = x.copy(), y.copy(), np.zeros(len(of))
        for further in FROM_CHORD:
            k = np.clip(chord + further, first, last)
            from_x, from_y = at_x.take(k - 1), at_y.take(k - 1)
            u, v = at_x.take(k) - from_x, at_y.take(k) - from_y
            square = u * u + v * v
            share = ((x - from_x) * u + (y - from_y) * v) / np.where(square > 0, square, 1.0)
            share = np.clip(share, 0.0, 1.0)
            near_x, near_y = from_x + share * u, from_y + share * v
            off_mm2 = (x - near_x) ** 2 + (y - near_y) ** 2
            better = off_mm2 < best_mm2
            np.copyto(best_mm2, off_mm2, where=better)
            np.copyto(foot_x, near_x, where=better)
            np.copyto(foot_y, near_y, where=better)
            np.copyto(at_mm, self.along_mm.take(k - 1) - begin_mm + share * np.sqrt(square), where=better)
        return np.column_stack([foot_x, foot_y]), at_mm

    def _behind(self, at_mm: Floats, of: Ints) -> Ints:
        """The first point of a line that lies further along it."""
        return np.searchsorted(self.along_mm, self.begin_mm.take(of) + at_mm, side="right")

    def astray_mm(self, one_mm: Floats, other_mm: Floats, begin: Floats, end: Floats, of: Ints) -> Floats:
        """How far lines stray from the straight ones between two of their points each, the shorter way round.

        `begin` and `end` are these points (m, 2); infinite where there would be too much to compare.
        """
        low_mm, high_mm = np.minimum(one_mm, other_mm), np.maximum(one_mm, other_mm)
        low, high = self._behind(low_mm - ROUNDING_MM, of), self._behind(high_mm + ROUNDING_MM, of)
        first, last = self.first.take(of), self.last.take(of)
        low, high = np.maximum(low, first), np.minimum(high, last + 1)
        around = 2 * (high_mm - low_mm) > self.round_mm.take(of)
        # the shorter way goes from the first point to the lower one, and from the higher one to the last
        over = self._behind(low_mm + ROUNDING_MM, of), self._behind(high_mm - ROUNDING_MM, of)
        ranges = [
            (np.where(around, first, low), np.where(around, np.minimum(over[0], high), high)),
            (np.where(around, np.maximum(over[1], first), high), np.where(around, last + 1, high)),
        ]
        counts = [np.maximum(until - since, 0) for since, until in ranges]
        whole = np.bincount(of, weights=counts[0] + counts[1], minlength=len(self.first))
        points = self.last - self.first + np.bincount(of, minlength=len(self.first))
        known = (whole <= _PAIRS * points).take(of)
        astray_mm = np.where(known, 0.0, np.inf)
        for (since, _), count in zip(ranges, counts, strict=True):
            count = np.where(known, count, 0)
            row = np.repeat(np.arange(len(of)), count)
            if len(row):
                at = self.at.take(concat_ranges(since, count), axis=0)
                off_mm = _line_distance_mm(at, begin.take(row, axis=0), end.take(row, axis=0))
                some = np.flatnonzero(count)
                most_mm = np.maximum.reduceat(off_mm, (np.cumsum(count) - count)[some])
                astray_mm[some] = np.maximum(astray_mm[some], most_mm)
        return astray_mm


def _line_distance_mm(points: Floats, begin: Floats, end: Floats) -> Floats:
    """How far points are from straight lines."""
    (u, v), (x, y) = (end - begin).T, (points - begin).T
    square = u * u + v * v
    share = np.clip((x * u + y * v) / np.where(square > 0, square, 1.0), 0.0, 1.0)
    return np.asarray(np.hypot(x - share * u, y - share * v))


# Whether lines surely run along each other, told for many at once: points are held against the chord they belong to.
#
# What this does not show is looked at by shapely, which knows no order of the points along a line.

ROUNDING_MM = 1e-7
"""What rounding makes of a distance, and far more."""
RINGS_AT_ONCE = 1024
"""Lines whose points are looked at together: more would take memory, and no less time."""
FROM_CHORD = (0, -1, 1)
"""The chord that a point should be beside, and those before and behind it: chords of two lines differ in length."""


class _RingChords:
    """The chords of lines one behind the other, how far along all of them each ends, mm, and how each line turns."""

    def __init__(self, lines: Any) -> None:
        points, of = shapely.get_coordinates(lines, return_index=True)
        within = of[1:] == of[:-1]
        self.begin: Floats = points[:-1].compress(within, axis=0)
        self.step: Floats = (points[1:] - points[:-1]).compress(within, axis=0)
        self.first: Ints = np.searchsorted(of[1:][within], np.arange(len(lines) + 1))
        length_mm = np.hypot(*self.step.T)
        self.end_mm = np.cumsum(length_mm)
        self.start_mm: Floats = np.concatenate([[0.0], self.end_mm])[self.first]
        self.square: Floats = np.where(length_mm > 0, length_mm, 1.0) ** 2
        self.last = self.first[1:] - 1
        self.turn = twice_area(points, of, len(lines))

    def beside(self, points: Floats, of: Ints, along_mm: Floats, within_mm: float) -> Bools:
        """Whether points (m, 2) lie within `within_mm` of the chord that is `along_mm` from the start of line `of`."""
        found = np.zeros(len(points), dtype=bool)
        chord = np.searchsorted(self.end_mm, self.start_mm.take(of) + along_mm, side="right")
        for further in FROM_CHORD:
            left = np.flatnonzero(~found)
            line = of.take(left)
            k = np.clip(chord.take(left) + further, self.first.take(line), self.last.take(line))
            dx, dy = (points.take(left, axis=0) - self.begin.take(k, axis=0)).T
            u, v = self.step.take(k, axis=0).T
            share = np.clip((dx * u + dy * v) / self.square.take(k), 0.0, 1.0)
            found[left] = (dx - share * u) ** 2 + (dy - share * v) ** 2 <= within_mm * within_mm
        return found


def surely_cover(lines: Any, rings: Any, within_mm: float) -> Bools:
    """Whether every vertex of each closed ring lies within `within_mm` of the line that goes round it, once or more.

    True is proven; False says that it is not known. A line may lead to the ring, and away from it.

    Examples
    --------
    >>> square = shapely.LinearRing([(0, 0), (9, 0), (9, 9), (0, 9)])
    >>> path = shapely.LineString([(9, -3), (9, 0), (9, 9), (0, 9), (0, 0), (9, 0), (12, 0)])
    >>> surely_cover([path, path], [square, shapely.LinearRing([(0, 0), (9, 0), (9, 9), (4, 9.5)])], 0.1).tolist()
    [True, False]
    """
    found = []
    for begin in range(0, len(lines), RINGS_AT_ONCE):
        some = slice(begin, begin + RINGS_AT_ONCE)
        along, round_mm = np.array(lines[some], dtype=object), shapely.length(rings[some])
        points, of = shapely.get_coordinates(np.array(rings[some], dtype=object), return_index=True)
        found.append(_all(_along(along, points, of, round_mm, within_mm), of, len(along)))
    return np.concatenate([np.zeros(0, dtype=bool), *found])


def _all(near: Bools, of: Ints, count: int) -> Bools:
    every = np.ones(count, dtype=bool)
    every[of[~near]] = False
    return every


def _along(lines: Any, points: Floats, of: Ints, round_mm: Floats, within_mm: float) -> Bools:
    """Whether points, in turn, lie beside the chords of their line that are as far along it as they are from the first.

    Where a line goes round, it is `round_mm` long until it is back.
    """
    if not len(points):
        return np.zeros(0, dtype=bool)
    chords, within_mm = _RingChords(lines), within_mm - ROUNDING_MM
    new = np.flatnonzero(np.diff(of, prepend=-1))
    step_mm = np.hypot(*np.diff(points, axis=0, prepend=points[:1]).T)
    step_mm[new] = 0.0
    gone_mm = np.cumsum(step_mm)
    gone_mm -= np.repeat(gone_mm[new], np.diff(new, append=len(of)))
    alike = np.where((twice_area(points, of, len(lines)) > 0) == (chords.turn > 0), 1.0, -1.0)
    begin_mm = shapely.line_locate_point(lines, shapely.points(points[new]))
    at_mm = begin_mm[of] + alike[of] * gone_mm
    near = chords.beside(points, of, at_mm, within_mm)
    for rounds in (-1, 1):
        left = np.flatnonzero(~near)
        k = of[left]
        near[left] = chords.beside(points.take(left, axis=0), k, at_mm[left] + rounds * round_mm[k], within_mm)
    return near


def twice_area(points: Floats, of: Ints, count: int) -> Floats:
    """Twice the area in mm² that the points of each line go round, last joined to first: positive to the left."""
    new = np.flatnonzero(np.diff(of, prepend=-1))
    from_first = points - np.repeat(points.take(new, axis=0), np.diff(new, append=len(of)), axis=0)
    x, y = from_first.T
    cross = np.append(x[:-1] * y[1:] - x[1:] * y[:-1], 0.0)
    cross[np.append(of[1:] != of[:-1], True)] = 0.0
    return np.bincount(of, weights=cross, minlength=count).astype(np.float64)
