"""Whether lines surely run along each other, told for many at once: points are held against the chord they belong to.

What this does not show is looked at by shapely, which knows no order of the points along a line.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely

from kerfwise.arrays import Bools, Floats, Ints

ROUNDING_MM = 1e-7
"""What rounding makes of a distance, and far more."""
AT_ONCE = 1024
"""Lines whose points are looked at together: more would take memory, and no less time."""
FROM_CHORD = (0, -1, 1)
"""The chord that a point should be beside, and those before and behind it: chords of two lines differ in length."""


class _Chords:
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
    for begin in range(0, len(lines), AT_ONCE):
        some = slice(begin, begin + AT_ONCE)
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
    chords, within_mm = _Chords(lines), within_mm - ROUNDING_MM
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
