"""A path of lines and arcs in the plane: the one shape that everything else is made of.

Vertices carry DXF bulges: the bulge of vertex k belongs to the segment from k to k + 1 and is the tangent of a
quarter of the arc's sweep, positive for a counter-clockwise arc; 0 is a straight line.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate
from typing import Protocol

import numpy as np
import shapely
from numpy.typing import NDArray

from kerfwise.arrays import Floats, Ints, concat_ranges

from .segment import Point, Segment, length_between_mm


@dataclass(frozen=True, eq=False)
class Curve:
    """Lines and arcs that follow each other, open or closed.

    Parameters
    ----------
    vertices
        Array (n, 3) of x, y in mm and the bulge of the segment that starts there. In an open curve the bulge of
        the last vertex is ignored.
    closed
        Whether the last vertex is joined to the first.

    Examples
    --------
    >>> circle = Curve.of([(-10, 0, 1), (10, 0, 1)])
    >>> round(circle.length_mm, 3), circle.is_ccw
    (62.832, True)
    """

    vertices: Floats
    closed: bool = True

    @staticmethod
    def of(points: Iterable[Sequence[float]], closed: bool = True) -> Curve:
        """Make a curve of (x, y) or (x, y, bulge) tuples; a missing bulge is 0."""
        rows = [(float(p[0]), float(p[1]), float(p[2]) if len(p) > 2 else 0.0) for p in points]
        return Curve(np.array(rows, dtype=np.float64).reshape(-1, 3), closed)

    def as_rows(self) -> list[list[float]]:
        """The vertices as JSON rows: [x, y] or [x, y, bulge]."""
        return [[x, y] if b == 0 else [x, y, b] for x, y, b in self.vertices.tolist()]

    @cached_property
    def segments(self) -> tuple[Segment, ...]:
        """The lines and arcs in order; zero-length ones are left out."""
        return tuple(self.made_anew())

    def made_anew(self) -> Iterator[Segment]:
        """The same, not kept: for the many short curves, such as leads, that are asked once or twice."""
        x, y, bulges = self.vertices.T.tolist()
        points = list(zip(x, y, strict=True))
        ends = points[1:] + points[:1] if self.closed else points[1:]
        return (s for s in map(Segment, points, ends, bulges) if s.length_mm > SHORTEST_MM)

    @property
    def start(self) -> Point:
        """The first vertex."""
        x, y = self.vertices[0, :2].tolist()
        return x, y

    @property
    def end(self) -> Point:
        """The last vertex: where an open curve ends."""
        x, y = self.vertices[-1, :2].tolist()
        return x, y

    @cached_property
    def starts_mm(self) -> Floats:
        """Array (segments + 1,): path length from the start to the start of each segment, then the total."""
        return np.array([0.0, *accumulate(self._lengths_mm)])

    @cached_property
    def _lengths_mm(self) -> list[float]:
        return [s.length_mm for s in self.segments]

    @property
    def length_mm(self) -> float:
        """Path length, mm."""
        if not self.closed and (count := len(self.vertices)) <= 2:  # most leads: their segments are not made for it
            if count < 2:
                return 0.0
            (x0, y0, bulge), (x1, y1, _) = self.vertices.tolist()
            length_mm = length_between_mm((x0, y0), (x1, y1), bulge)
            return length_mm if length_mm > SHORTEST_MM else 0.0
        return float(self.starts_mm[-1])

    @cached_property
    def signed_area_mm2(self) -> float:
        """Area enclosed (Green's theorem, exact on arcs); positive when counter-clockwise."""
        return sum(s.area_term_mm2 for s in self.segments)

    @property
    def is_ccw(self) -> bool:
        """True when the curve runs counter-clockwise (y up)."""
        return self.signed_area_mm2 > 0

    def locate(self, s_mm: float) -> tuple[int, float]:
        """Segment index and fraction 0…1 along it at path length `s_mm` (wraps on a closed curve)."""
        total = self.length_mm
        s = s_mm % total if self.closed else min(max(s_mm, 0.0), total)
        k = int(self.starts_mm.searchsorted(s, side="right")) - 1
        k = min(max(k, 0), len(self.segments) - 1)
        return k, float(min(max((s - self.starts_mm[k]) / self._lengths_mm[k], 0.0), 1.0))

    def point_at(self, s_mm: float) -> Point:
        """The point at path length `s_mm`."""
        k, f = self.locate(s_mm)
        return self.segments[k].point_at(f)

    def tangent_at(self, s_mm: float) -> Point:
        """Unit tangent at path length `s_mm` (of the segment that starts there, at a corner)."""
        k, f = self.locate(s_mm)
        return self.segments[k].tangent_at(f)

    def project(self, point: Sequence[float]) -> tuple[float, float]:
        """Path length of the nearest point of the curve to `point`, and the distance to it, mm."""
        best, at = (0.0, math.inf), (point[0], point[1])
        for start, seg, length_mm in zip(self.starts_mm.tolist(), self.segments, self._lengths_mm, strict=False):
            f, d = seg.project(at)
            if d < best[1] - 1e-12:
                best = (start + f * length_mm, d)
        return best

    def nearest(self, point: Sequence[float]) -> Point:
        """The point of the curve nearest to `point`."""
        return self.point_at(self.project(point)[0])

    def reversed(self) -> Curve:
        """The same path the other way round (a closed curve keeps its first vertex)."""
        v = self.vertices
        if self.closed:
            points = np.concatenate([v[:1, :2], v[:0:-1, :2]])
            bulges = -v[::-1, 2]
        else:
            points = v[::-1, :2]
            bulges = np.concatenate([-v[-2::-1, 2], [0.0]])
        return Curve(np.column_stack([points, bulges]), self.closed)

    def towards(self, direction: str) -> Curve:
        """The closed curve run "cw" or "ccw"."""
        return self if self.is_ccw == (direction == "ccw") else self._turned

    @cached_property
    def _turned(self) -> Curve:
        return self.reversed()

    def between(self, start_mm: float, length_mm: float) -> Curve:
        """The open piece of `length_mm` that begins at path length `start_mm`; it may wrap, even more than once."""
        rows: list[tuple[float, float, float]] = []
        left, segments, lengths_mm = length_mm, self.segments, self._lengths_mm
        k, f = self.locate(start_mm)
        end = segments[k].point_at(f) if left <= 1e-9 else (0.0, 0.0)
        while left > 1e-9:
            seg, whole_mm = segments[k], lengths_mm[k]
            take = min(left, whole_mm * (1 - f))
            if f == 0.0 and take == whole_mm:  # most of them
                rows.append((*seg.start, seg.bulge_between(0.0, 1.0)))
                end = seg.end
                left -= take
            elif take > 1e-9:
                piece = seg.between(f, f + take / whole_mm)
                rows.append((*piece.start, piece.bulge))
                end = piece.end
                left -= take
            k, f = (k + 1) % len(segments), 0.0
        rows.append((*end, 0.0))
        return Curve(np.array(rows, dtype=np.float64), closed=False)

    def piece(self, first: int, last: int) -> Curve:
        """An open path from one of its vertices to another; what is known of its lines and arcs is not made again.

        Examples
        --------
        >>> Curve.of([(0, 0), (4, 0), (4, 3)], closed=False).piece(1, 2).as_rows()
        [[4.0, 0.0], [4.0, 3.0]]
        """
        piece = Curve(self.vertices[first : last + 1], closed=False)
        if len(known := vars(self).get("segments", ())) == len(self.vertices) - 1:
            vars(piece)["segments"] = known[first:last]
        return piece

    def opened_at(self, s_mm: float) -> Curve:
        """The closed curve as an open path that starts and ends at path length `s_mm`."""
        return self.between(s_mm, self.length_mm)

    def flatten(self, tolerance_mm: float = 0.01) -> Floats:
        """Array (m, 2) of points whose chords stay within `tolerance_mm`; a closed curve does not repeat its first.

        Those of closed curves are kept: contours are asked for them again and again. They are not to be changed.
        """
        if not self.closed:
            return self._flattened(tolerance_mm)
        known = self._kept.get(tolerance_mm)
        return self._keep(tolerance_mm, self._flattened(tolerance_mm)) if known is None else known

    def _keep(self, tolerance_mm: float, points: Floats) -> Floats:
        points.flags.writeable = False
        self._kept[tolerance_mm] = points
        return points

    @cached_property
    def _kept(self) -> dict[float, Floats]:
        """The points of a closed curve by tolerance."""
        return {}

    @cached_property
    def beside(self) -> dict[float, Curve | None]:
        """Offsets of a closed curve by distance, mm, as far as they are known; None where neighbours do not tell it."""
        return {}

    def _flattened(self, tolerance_mm: float) -> Floats:
        own = self.segments
        if not own:
            return self.vertices[:1, :2].copy()
        if len(own) == len(self.vertices) - (not self.closed) and not self.vertices[:, 2].any():
            return self.vertices[:, :2].copy()
        points = np.concatenate([[own[0].start], *[s.flatten(tolerance_mm) for s in own]])
        return points[:-1] if self.closed else points

    def line(self, tolerance_mm: float = 0.01) -> shapely.LineString:
        """The path as a shapely LineString, closed ones repeat their first point, as a mere point does."""
        points = self.flatten(tolerance_mm)
        return shapely.LineString(np.concatenate([points, points[:1]]) if self.closed or len(points) < 2 else points)

    def polygon(self, tolerance_mm: float = 0.01) -> shapely.Polygon:
        """The area inside a closed curve (not checked for validity); empty for fewer than three points."""
        points = self.flatten(tolerance_mm)
        return shapely.Polygon(points) if len(points) > 2 else shapely.Polygon()

    def moved(self, dx_mm: float, dy_mm: float) -> Curve:
        """The curve shifted by (dx, dy)."""
        return Curve(self.vertices + np.array([dx_mm, dy_mm, 0.0]), self.closed)


def lines_of(curves: Sequence[Curve], tolerance_mm: float) -> NDArray[np.object_]:
    """As `Curve.line` of each; their points are made together, and not kept.

    Examples
    --------
    >>> [line.wkt for line in lines_of([Curve.of([(0, 0), (4, 0), (4, 3)]), Curve.of([(1, 1)], closed=False)], 0.1)]
    ['LINESTRING (0 0, 4 0, 4 3, 0 0)', 'LINESTRING (1 1, 1 1)']
    """
    if not curves:
        return np.zeros(0, dtype=object)
    rows: list[Floats] = []
    for curve, points in zip(curves, _cached_points(curves, tolerance_mm), strict=True):
        rows += [points, points[:1] if curve.closed or len(points) < 2 else points[:0]]
    count = np.array([len(points) + len(first) for points, first in zip(rows[::2], rows[1::2], strict=True)])
    lines: NDArray[np.object_] = np.full(len(curves), shapely.LineString(), dtype=object)
    (some,) = np.nonzero(count)
    if len(some):
        each = np.repeat(np.arange(len(some)), count[some])
        lines[some] = shapely.linestrings(np.concatenate(rows), indices=each)
    return lines


def polygons_of(curves: Sequence[Curve], tolerance_mm: float) -> NDArray[np.object_]:
    """As `Curve.polygon` of each closed curve; their points are made together, and not kept.

    Examples
    --------
    >>> polygons_of([Curve.of([(0, 0), (4, 0), (4, 3)]), Curve.of([(1, 1)])], 0.1).tolist()
    [<POLYGON ((0 0, 4 0, 4 3, 0 0))>, <POLYGON EMPTY>]
    """
    lines = lines_of(curves, tolerance_mm)
    areas: NDArray[np.object_] = np.full(len(lines), shapely.Polygon(), dtype=object)
    some = np.flatnonzero(shapely.get_num_coordinates(lines) > 3)
    if len(some):
        points, of = shapely.get_coordinates(lines[some], return_index=True)
        areas[some] = shapely.polygons(shapely.linearrings(points, indices=of))
    return areas


def flattened(curves: Sequence[Curve], tolerance_mm: float) -> list[Floats]:
    """As `Curve.flatten` of each; what is not known is made together.

    Examples
    --------
    >>> [points.tolist() for points in flattened([Curve.of([(0, 0), (4, 0), (4, 3)])], 0.1)]
    [[[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]]]
    """
    found = []
    for curve, points in zip(curves, _cached_points(curves, tolerance_mm), strict=True):
        if not curve.closed:
            points = points.copy()
        elif tolerance_mm not in curve._kept:
            points = curve._keep(tolerance_mm, points.copy())
        found.append(points)
    return found


def _cached_points(curves: Sequence[Curve], tolerance_mm: float) -> Iterator[Floats]:
    """The points of each; what is not known is made together, and not kept."""
    kept = [curve._kept.get(tolerance_mm) if curve.closed else None for curve in curves]
    new = flatten_curves([c for c, known in zip(curves, kept, strict=True) if known is None], tolerance_mm)
    return (next(new) if known is None else known for known in kept)


# Paths of lines and arcs as points: the arcs of several are cut into chords at once.

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


def flatten_curves(curves: Sequence[Bulged], tolerance_mm: float) -> Iterator[Floats]:
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
    """See `flatten_curves`; of curves that may have arcs."""
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
        place, each = concat_ranges(np.zeros_like(n), n), np.repeat(np.arange(len(n)), n)
        x, y, r, begin, sweep = np.stack([*self.centre, self.radius_mm, self.angle, self.sweep]).take(each, axis=1)
        angle = begin + sweep * (place + 1) / n.take(each)
        at = (last[self.which] - n + 1).take(each) + place
        points[at, 0] = x + r * np.cos(angle)
        points[at, 1] = y + r * np.sin(angle)


def _each(function: Callable[..., float], *numbers: Floats) -> Floats:
    """A function of the math module for each number: numpy's own may differ in the last bit."""
    return np.fromiter(map(function, *(row.tolist() for row in numbers)), np.float64, len(numbers[0]))
