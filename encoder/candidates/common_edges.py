"""Straight edges that two parts have in common: one kerf apart, so that one cut makes both."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import shapely

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.geometry.tolerances import tolerance_mm
from kerfwise.encoder.graphs import weak_components
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.encoder.torch_path import compensated

from .candidate import CommonOptions

_TURN_RAD = math.radians(0.2)
_ROUNDING_MM = 1e-3
_MOST_KERFS = 1.2
_COVERED = 0.9
"""Of the tolerance: so near to a burn a ring is covered by it, for sure."""
_CHORD_MM, _STEP_MM, _LONGEST_MM = 0.002, 0.02, 20.0

Stretches = tuple[tuple[float, float], ...]
"""Where each stretch of a ring begins, mm along it as it is drawn, and how long it is."""


@dataclass(frozen=True, slots=True)
class Junction:
    """Where three parts meet in a T: a stretch of one's ring, a kerf long, between the edges that two others share.

    Whichever of the two is cut second goes straight on over it, from `begin` to `end` or back, into the kerf of the
    first: `one` lies at `begin`, `other` at `end`.
    """

    one: int
    other: int
    stretch: tuple[float, float]
    begin: Point
    end: Point


@dataclass(frozen=True, slots=True)
class CommonEdges:
    """Contour number → the number of each neighbour with common edges → the stretches of its ring that both share.

    `junctions` are those over each contour's ring.
    """

    of: Mapping[int, Mapping[int, Stretches]]
    junctions: Mapping[int, tuple[Junction, ...]] = field(default_factory=dict)

    @property
    def pairs(self) -> Ints:
        """The numbers of each two contours that have edges in common, (k, 2)."""
        rows = [(one, other) for one, beside in self.of.items() for other in beside if one < other]
        return np.array(rows, dtype=np.int64).reshape(-1, 2)


@dataclass(frozen=True, eq=False)
class _Edges:
    """Straight edges of outer contours, all counter-clockwise round their part: its metal lies to their left."""

    contour: Ints
    begin: Floats
    end: Floats

    @property
    def length_mm(self) -> Floats:
        return np.asarray(np.hypot(*(self.end - self.begin).T), dtype=np.float64)

    @cached_property
    def along(self) -> Floats:
        return np.asarray((self.end - self.begin) / self.length_mm[:, None])

    @staticmethod
    def of(contours: Sequence[tuple[int, Contour]]) -> _Edges:
        rows = [
            (number, *((s.start, s.end) if contour.curve.is_ccw else (s.end, s.start)))
            for number, contour in contours
            for s in contour.curve.segments
            if not s.is_arc
        ]
        return _Edges(
            np.array([row[0] for row in rows], dtype=np.int64),
            np.array([row[1] for row in rows], dtype=np.float64).reshape(-1, 2),
            np.array([row[2] for row in rows], dtype=np.float64).reshape(-1, 2),
        )


@dataclass(frozen=True, slots=True)
class FacingEdge:
    """A stretch of an outer contour's straight edge, from `begin` to `end` counter-clockwise, and whom it faces."""

    contour: int
    other: int
    begin: Point
    end: Point

    @property
    def length_mm(self) -> float:
        return math.dist(self.begin, self.end)


def facing_edges(outers: Sequence[tuple[int, Contour]], gap_mm: float, within_mm: float) -> Iterator[FacingEdge]:
    """Straight edges of two outer contours that look at each other so far apart; each pair from both sides."""
    edges = _Edges.of(outers)
    for a, b, low, high in _facing(edges, gap_mm, within_mm):
        begin, end = (tuple((edges.begin[a] + mm * edges.along[a]).tolist()) for mm in (low, high))
        yield FacingEdge(int(edges.contour[a]), int(edges.contour[b]), begin, end)


def common_edges(
    nest: Nest, numbers: Sequence[int], kerf_mm: float, options: CommonOptions, held: Collection[int] = ()
) -> CommonEdges:
    """The common edges of the outer contours with these numbers, but for those that tabs hold.

    Two edges are common where they look at each other, turn by 0.2° at the most, and are one kerf apart within the
    tolerance. Of parts that hang together by such edges all are common, down to a kerf's length, if one of them is as
    long as the options ask, and no round edge of another part comes as near: else none.

    Examples
    --------
    >>> from kerfwise.rules.case import nest, part, rect
    >>> two = nest(300, 200, part("A", rect(10, 10, 80, 60)), part("B", rect(91.5, 30, 80, 60)))
    >>> edges = common_edges(two, [0, 1], 1.5, CommonOptions(20.0, 0.05))
    >>> [(round(begin), round(mm)) for beside in edges.of.values() for rows in beside.values() for begin, mm in rows]
    [(101, 40), (244, 40)]
    """
    outers = [(k, nest.contours[k]) for k in numbers if nest.contours[k].kind == "outer"]
    edges = _Edges.of([row for row in outers if row[0] not in held])
    found: dict[int, dict[int, list[tuple[float, float]]]] = {}
    longest: dict[tuple[int, int], float] = {}
    for a, b, low, high in _facing(edges, kerf_mm, min(options.gap_mm, tolerance_mm(kerf_mm)) + _ROUNDING_MM):
        one, other = int(edges.contour[a]), int(edges.contour[b])
        ends = (edges.begin[a] + mm * edges.along[a] for mm in (low, high))
        row = _on_ring(nest.contours[one], kerf_mm, *(_offset(at, edges.along[a], kerf_mm / 2) for at in ends))
        if row is not None:
            pair = min(one, other), max(one, other)
            longest[pair] = max(longest.get(pair, 0.0), row[1])
            found.setdefault(one, {}).setdefault(other, []).append(
                _until_apart(row, nest.contours[one], nest.contours[other], kerf_mm)
            )
    every = {
        one: {other: tuple(sorted(rows)) for other, rows in sorted(beside.items())}
        for one, beside in sorted(found.items())
    }
    kept = _long_enough(longest, options.shortest_mm, len(nest.contours), set(_closer(nest, outers, every, kerf_mm)))
    edges_of = {one: beside for one, beside in every.items() if one in kept}
    return CommonEdges(edges_of, {k: tuple(_junctions(nest.contours[k], k, edges_of, kerf_mm)) for k in edges_of})


def _junctions(
    contour: Contour, number: int, edges: Mapping[int, Mapping[int, Stretches]], kerf_mm: float
) -> Iterator[Junction]:
    ring = compensated(contour, kerf_mm)
    rows = sorted((low, mm, other) for other, stretches in edges[number].items() for low, mm in stretches)
    for (low, mm, one), (after, _, other) in zip(rows, rows[1:] + rows[:1], strict=True):
        begin_mm, gap_mm = low + mm, (after - low - mm) % ring.length_mm
        if other not in edges.get(one, {}) or not 0 < gap_mm <= _MOST_KERFS * kerf_mm:
            continue
        begin, end = ring.point_at(begin_mm), ring.point_at(begin_mm + gap_mm)
        if math.dist(begin, end) > gap_mm - _ROUNDING_MM:
            yield Junction(one, other, (begin_mm, gap_mm), begin, end)


def rounds_at_corners(ring: Curve, kerf_mm: float) -> Stretches:
    """The stretches of an outer contour's ring that go round its corners."""
    return tuple(
        (float(begin), s.length_mm)
        for begin, s in zip(ring.starts_mm, ring.segments, strict=False)
        if s.is_arc and abs(s.radius_mm - kerf_mm / 2) < _ROUNDING_MM
    )


def _facing(edges: _Edges, kerf_mm: float, within_mm: float) -> Iterator[tuple[int, int, float, float]]:
    """Edges a and b that are common, both ways round: where on a, mm from its begin."""
    if not len(edges.contour):
        return
    lines = shapely.linestrings(np.stack([edges.begin, edges.end], axis=1))
    a, b = shapely.STRtree(lines).query(lines, "dwithin", distance=kerf_mm + within_mm)
    apart = edges.contour[a] != edges.contour[b]
    a, b = a[apart], b[apart]
    along, other = edges.along[a], edges.along[b]
    turned = np.abs(along[:, 0] * other[:, 1] - along[:, 1] * other[:, 0]) <= math.sin(_TURN_RAD)
    against = turned & ((along * other).sum(axis=1) < 0)
    a, b, along = a[against], b[against], along[against]
    right = np.column_stack([along[:, 1], -along[:, 0]])
    begin, end = edges.begin[b] - edges.begin[a], edges.end[b] - edges.begin[a]
    at_begin, at_end = (begin * along).sum(axis=1), (end * along).sum(axis=1)
    low, high = np.maximum(at_end, 0.0), np.minimum(at_begin, edges.length_mm[a])
    off_begin, off_end = (begin * right).sum(axis=1), (end * right).sum(axis=1)
    slope = (off_begin - off_end) / (at_begin - at_end)
    gaps = [off_end + slope * (at - at_end) for at in (low, high)]
    common = high - low > kerf_mm
    for gap in gaps:
        common &= np.abs(gap - kerf_mm) <= within_mm
    rows = np.flatnonzero(common)
    rows = rows[np.lexsort((b[rows], a[rows]))]
    yield from zip(a[rows].tolist(), b[rows].tolist(), low[rows].tolist(), high[rows].tolist(), strict=True)


def _offset(at: Floats, along: Floats, by_mm: float) -> tuple[float, float]:
    return float(at[0] + by_mm * along[1]), float(at[1] - by_mm * along[0])


def _on_ring(
    contour: Contour, kerf_mm: float, begin: tuple[float, float], end: tuple[float, float]
) -> tuple[float, float] | None:
    """A straight stretch of the torch's way round a contour, as drawn; None where the torch does not go straight."""
    ring = compensated(contour, kerf_mm)
    (low, off_low), (high, off_high) = ring.project(begin), ring.project(end)
    if not contour.curve.is_ccw:
        low, high = high, low
    length_mm = (high - low) % ring.length_mm
    straight_mm = math.dist(ring.point_at(low), ring.point_at(high))
    if max(off_low, off_high) > kerf_mm or abs(length_mm - straight_mm) > _ROUNDING_MM or length_mm <= kerf_mm:
        return None
    return float(low), float(length_mm)


def _until_apart(row: tuple[float, float], contour: Contour, other: Contour, kerf_mm: float) -> tuple[float, float]:
    """A stretch with what lies before and after it where the torch's ways part slowly, as at large fillets.

    So far the cut of one covers the other. Ways that part within a kerf stay as they are, also where they meet again
    behind a corner.
    """
    ring, line = compensated(contour, kerf_mm), compensated(other, kerf_mm).line(_CHORD_MM)
    within_mm = _COVERED * tolerance_mm(kerf_mm)

    def apart(at_mm: float) -> bool:
        return bool(line.distance(shapely.Point(ring.point_at(at_mm))) > within_mm)

    def within_a_kerf(begin_mm: float) -> bool:
        beyond = shapely.segmentize(ring.between(begin_mm, kerf_mm).line(_CHORD_MM), _STEP_MM)
        return bool((shapely.distance(line, shapely.points(shapely.get_coordinates(beyond))) > within_mm).any())

    more = []
    for end_mm, sign in ((row[0], -1), (row[0] + row[1], 1)):
        steps = int(_LONGEST_MM / _STEP_MM)
        first = (
            0
            if within_a_kerf(end_mm if sign > 0 else end_mm - kerf_mm)
            else next((k for k in range(steps) if apart(end_mm + sign * (kerf_mm + k * _STEP_MM))), steps)
        )
        more.append(max(kerf_mm + (first - 1) * _STEP_MM, 0.0) if first else 0.0)
    return row[0] - more[0], row[1] + more[0] + more[1]


def _closer(
    nest: Nest, outers: Sequence[tuple[int, Contour]], edges: Mapping[int, Mapping[int, Stretches]], kerf_mm: float
) -> Iterator[int]:
    """Contours whose ring another one covers for more than their common edges, as a disc a kerf away does.

    Cut along stretches, such a place would be burnt twice.
    """
    rings = [compensated(contour, kerf_mm).line(_CHORD_MM) for _, contour in outers]
    tree, within_mm = shapely.STRtree(rings), tolerance_mm(kerf_mm)
    for k, (number, _) in enumerate(outers):
        for other in tree.query(rings[k], "dwithin", distance=within_mm).tolist() if number in edges else ():
            shared_mm = sum(mm for _, mm in edges[number].get(outers[other][0], ()))
            if other != k:
                near_mm = shapely.intersection(rings[k], shapely.buffer(rings[other], within_mm)).length
                if near_mm - shared_mm > 2 * kerf_mm + within_mm:
                    yield number


def _long_enough(
    longest: Mapping[tuple[int, int], float], shortest_mm: float, count: int, spoilt: Collection[int]
) -> set[int]:
    """The contours that hang together by common edges, with one as long as asked, and with none that is spoilt."""
    pairs = np.array(list(longest), dtype=np.int64).reshape(-1, 2)
    label = weak_components(count, pairs)
    groups = {int(label[pair[0]]) for pair, mm in longest.items() if mm >= shortest_mm - _ROUNDING_MM}
    groups -= {int(label[k]) for k in spoilt}
    return {k for pair in longest for k in pair if int(label[k]) in groups}
