"""Paths of lines and arcs as points: the arcs of several are cut into chords at once."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Protocol

import numpy as np

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.ranges import laid_out

from .segment import Segment

SHORT_MM = 1e-8
"""Lines and arcs are surely not left out where their ends are farther apart."""
SHORTEST_MM = 1e-9
"""`Curve.segments` leaves out what is no longer."""


class Bulged(Protocol):
    """A `Curve`, as far as it is looked at here: vertices (m, 3) with bulges, in order."""

    @property
    def vertices(self) -> Floats: ...

    @property
    def closed(self) -> bool: ...


def flattened_together(curves: Sequence[Bulged], tolerance_mm: float) -> Iterator[Floats]:
    """Array (m, 2) of points a curve, whose chords stay within `tolerance_mm`; a closed one does not repeat its first.

    They are views of one array, or of the vertices of curves that are nothing but lines; not to be changed.
    """
    straight = _surely_straight(curves)
    bent = _with_lines([curve for curve, known in zip(curves, straight, strict=True) if not known], tolerance_mm)
    return (curve.vertices[:, :2] if known else next(bent) for curve, known in zip(curves, straight, strict=True))


def _surely_straight(curves: Sequence[Bulged]) -> list[bool]:
    """Whether curves have no arcs, and no lines so short that they are left out."""
    if not curves:
        return []
    rows = _Rows(curves)
    (x, y), bulge = rows.begin.T, rows.bulge
    wrong = np.maximum(abs(x.take(rows.onward) - x), abs(y.take(rows.onward) - y)) <= SHORT_MM
    wrong[rows.open_end] = False
    wrong |= bulge != 0
    straight = (rows.sizes > 1) & (np.bincount(rows.of[wrong], minlength=len(curves)) == 0)
    return straight.tolist()  # type: ignore[no-any-return]


class _Rows:
    """The vertices of curves one behind the other: places, bulges, whose they are, and which of them comes next.

    `open_end` are those behind which an open curve ends.
    """

    def __init__(self, curves: Sequence[Bulged]) -> None:
        vertices = np.concatenate([curve.vertices for curve in curves])
        self.begin, self.bulge = np.ascontiguousarray(vertices[:, :2]), vertices[:, 2]
        self.sizes: Ints = np.array([len(curve.vertices) for curve in curves])
        self.of = np.repeat(np.arange(len(curves)), self.sizes)
        self.drawn = self.sizes > 0
        last = np.cumsum(self.sizes) - 1
        self.first: Ints = last - self.sizes + 1
        self.onward: Ints = np.arange(len(vertices)) + 1
        self.onward[last[self.drawn]] = self.first[self.drawn]
        self.open_end: Ints = last[np.array([not curve.closed for curve in curves]) & self.drawn]

    def long_enough(self) -> Ints:
        """Those behind which a line or an arc has a length, as `Curve.segments` has it."""
        steps = self.begin.take(self.onward, axis=0) - self.begin
        found = np.abs(steps).max(axis=1, initial=0.0) > SHORT_MM
        for k in np.flatnonzero(~found).tolist():
            ends = self.begin[[k, self.onward[k]]].tolist()
            found[k] = Segment(tuple(ends[0]), tuple(ends[1]), float(self.bulge[k])).length_mm > SHORTEST_MM
        found[self.open_end] = False
        return np.flatnonzero(found)


def _with_lines(curves: Sequence[Bulged], tolerance_mm: float) -> Iterator[Floats]:
    """See `flattened_together`; of curves that may have arcs."""
    if not curves:
        return
    rows = _Rows(curves)
    kept = rows.long_enough()
    of, begin, end = rows.of[kept], rows.begin[kept], rows.begin[rows.onward[kept]]
    arcs = _Arcs(begin, end, rows.bulge[kept], tolerance_mm)
    new = np.flatnonzero(np.diff(of, prepend=-1))
    sizes = rows.drawn + np.bincount(of, weights=arcs.count, minlength=len(curves)).astype(np.int64)
    first: Ints = np.cumsum(sizes) - sizes
    points = np.empty((int(sizes.sum()), 2))
    points[first[rows.drawn]] = rows.begin[rows.first[rows.drawn]]
    points[first[of[new]]] = begin[new]
    last = np.cumsum(arcs.count) - 1 + np.cumsum(rows.drawn)[of]
    arcs.draw(points, last)
    points[last] = end
    for curve, since, size in zip(curves, first.tolist(), sizes.tolist(), strict=True):
        yield points[since : since + size - (curve.closed and size > 1)]


class _Arcs:
    """Which of lines and arcs are cut into several chords, and into how many each; one for each other.

    Places are the same to the last bit as those of `Segment`.
    """

    def __init__(self, begin: Floats, end: Floats, bulge: Floats, tolerance_mm: float) -> None:
        self.count: Ints = np.ones(len(bulge), dtype=np.int64)
        bent = np.flatnonzero(bulge)
        (x0, y0), (x1, y1), b = begin[bent].T, end[bent].T, bulge[bent]
        chord_mm = np.array(list(map(math.dist, begin[bent].tolist(), end[bent].tolist())))
        radius_mm = chord_mm * (1 + b * b) / (4 * np.abs(b))
        sweep = 4.0 * _each(math.atan, b)
        narrow = radius_mm <= tolerance_mm
        share = np.sqrt(tolerance_mm / (2 * np.where(narrow, tolerance_mm, radius_mm)))
        step = np.where(narrow, math.pi / 2, np.minimum(4 * _each(math.asin, share), math.pi / 2))
        chords = np.maximum(np.ceil(np.abs(sweep) / step - 1e-9), 1).astype(np.int64)
        self.count[bent] = chords
        some = np.flatnonzero(chords > 1)
        self.which, self.radius_mm, self.sweep = bent[some], radius_mm[some], sweep[some]
        high = (1 - b * b) / (4 * b)
        x, y = (x0 + x1) / 2 - (y1 - y0) * high, (y0 + y1) / 2 + (x1 - x0) * high
        self.centre = np.stack([x[some], y[some]])
        self.angle: Floats = _each(math.atan2, (y0 - y)[some], (x0 - x)[some])

    def draw(self, points: Floats, last: Ints) -> None:
        """Fill in the points of all chords; each line or arc has its `last` one there."""
        n = self.count[self.which]
        place, each = laid_out(np.zeros_like(n), n), np.repeat(np.arange(len(n)), n)
        x, y, r, begin, sweep = np.stack([*self.centre, self.radius_mm, self.angle, self.sweep]).take(each, axis=1)
        angle = begin + sweep * (place + 1) / n.take(each)
        at = (last[self.which] - n + 1).take(each) + place
        points[at, 0] = x + r * np.cos(angle)
        points[at, 1] = y + r * np.sin(angle)


def _each(function: Callable[..., float], *numbers: Floats) -> Floats:
    """A function of the math module for each number: numpy's own may differ in the last bit."""
    return np.fromiter(map(function, *(row.tolist() for row in numbers)), np.float64, len(numbers[0]))
