"""Parts whose straight edges touch, drawn half a kerf smaller there: one cut between them makes both."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from kerfwise.encoder.candidates.common_edges import FacingEdge, facing_edges
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point, Segment

from .errors import InputError
from .graphs import weak_components
from .nest import Contour, Loss, Nest, cached_with_nest, with_parts

# A closed curve of which a straight edge is moved inwards.

_ON_LINE_MM = 0.01
_STEEP = 0.3
"""What turns away from the inside behind an edge is lengthened to the moved edge, if it is as steep; else a step is."""
_LEAST_MM = 0.1


@dataclass(frozen=True, slots=True)
class _Line:
    """A line from a point on, in a direction of length 1; `height` is how far to its left a point lies."""

    at: Point
    way: Point

    def along(self, p: Point) -> float:
        return (p[0] - self.at[0]) * self.way[0] + (p[1] - self.at[1]) * self.way[1]

    def height(self, p: Point) -> float:
        return (p[1] - self.at[1]) * self.way[0] - (p[0] - self.at[0]) * self.way[1]

    def above(self, p: Point, by_mm: float) -> Point:
        return p[0] - by_mm * self.way[1], p[1] + by_mm * self.way[0]

    def holds(self, s: Segment) -> bool:
        """Whether a segment lies on the line and goes its way."""
        on = max(abs(self.height(s.start)), abs(self.height(s.end))) <= _ON_LINE_MM
        return not s.is_arc and on and self.along(s.end) > self.along(s.start)


def move_edge_in(curve: Curve, begin: Point, end: Point, by_mm: float) -> Curve:
    """A counter-clockwise curve whose edge along the line from `begin` to `end` is moved in by `by_mm`.

    What lies in line with it goes with it. What lies beside it is shortened, or lengthened, to where the moved edge
    meets it. Where no edge lies there any more, nothing changes. Raises ValueError if what lies beside the edge does
    not reach as far as it is moved, or nothing is left of the edge.

    Examples
    --------
    >>> square = Curve.of([(0, 0), (10, 0), (10, 10), (0, 10)])
    >>> move_edge_in(square, (2, 0), (8, 0), 1.0).as_rows()
    [[10.0, 1.0], [10.0, 10.0], [0.0, 10.0], [0.0, 1.0]]
    """
    length_mm = math.dist(begin, end)
    line = _Line(begin, ((end[0] - begin[0]) / length_mm, (end[1] - begin[1]) / length_mm))
    segments = list(curve.segments)
    edge = next((k for k, s in enumerate(segments) if line.holds(s) and _meet(line, s, length_mm)), None)
    if edge is None:
        return curve
    beside = segments[edge + 1 :] + segments[:edge]
    beside = _from_height(beside, line, by_mm)
    beside = _backwards(_from_height(_backwards(beside), line, by_mm))
    if not beside or line.along(beside[0].start) - line.along(beside[-1].end) < _LEAST_MM:
        raise ValueError(_too_small(begin))
    return Curve.of([*((*s.start, s.bulge) for s in beside), (*beside[-1].end, 0.0)])


def _meet(line: _Line, s: Segment, length_mm: float) -> bool:
    return min(line.along(s.end), length_mm) - max(line.along(s.start), 0.0) > _ON_LINE_MM


def _backwards(segments: Sequence[Segment]) -> list[Segment]:
    return [Segment(s.end, s.start, -s.bulge) for s in reversed(segments)]


def _from_height(segments: Sequence[Segment], line: _Line, by_mm: float) -> list[Segment]:
    """What follows an edge on the line, from where it is `by_mm` above that."""
    for k, s in enumerate(segments):
        rest = list(segments[k + 1 :])
        fraction = _first_at(s, line, by_mm)
        if _lowest(s, line, 1.0 if fraction is None else fraction) < -_ON_LINE_MM:
            start_mm = line.height(s.start)
            if abs(start_mm) > _ON_LINE_MM:
                raise ValueError(_too_small(s.start))
            rise = line.height(s.end) - start_mm
            if s.is_arc or -rise < _STEEP * s.length_mm:
                return [Segment(line.above(s.start, by_mm - start_mm), s.start), s, *rest]
            back = (by_mm - start_mm) / rise
            x, y = (a + (b - a) * back for a, b in zip(s.start, s.end, strict=True))
            return [Segment((x, y), s.end), *rest]
        if fraction is not None:
            return [s.between(fraction, 1.0), *rest] if fraction < 1.0 else rest
    raise ValueError(_too_small(segments[0].start))


def _first_at(s: Segment, line: _Line, height_mm: float) -> float | None:
    """The least share of a segment at which it is as high above the line."""
    low, high = line.height(s.start), line.height(s.end)
    if not s.is_arc:
        return (height_mm - low) / (high - low) if low < height_mm <= high else None
    middle, radius = line.height(s.centre), s.radius_mm
    if abs(height_mm - middle) > radius:
        return None
    up, turn = math.atan2(line.way[0], -line.way[1]), math.acos((height_mm - middle) / radius)
    shares = (_share(s, up + by) for by in (turn, -turn))
    return min((share for share in shares if share is not None), default=None)


def _share(s: Segment, angle_rad: float) -> float | None:
    """How far along an arc a direction from its centre is met."""
    turned = (angle_rad - s.angle_rad) % math.tau
    turned = turned if s.sweep_rad > 0 else turned - math.tau
    share = turned / s.sweep_rad
    return share if share <= 1.0 else None


def _lowest(s: Segment, line: _Line, until: float) -> float:
    """The least height of a segment above the line, up to a share of it."""
    ends = [line.height(s.start), line.height(s.point_at(until))]
    if s.is_arc:
        down = _share(s, math.atan2(-line.way[0], line.way[1]))
        if down is not None and down <= until:
            ends.append(line.height(s.centre) - s.radius_mm)
    return min(ends)


def _too_small(at: Point) -> str:
    return f"what lies beside its edge at ({at[0]:z.1f}, {at[1]:z.1f}) is too small"


# What is left stands one kerf apart, as parts with common edges do. An edge is moved as a whole, with all that lies
# in line with it, so that it stays straight: the part loses half a kerf along all of it.

_OVERLAP_MM = 0.01


@cached_with_nest(most=4)
def with_touching_edges_cut(nest: Nest, kerf_mm: float, shortest_mm: float, within_mm: float) -> Nest:
    """The nest without what touching parts lose to the cut between them; it keeps the nest as drawn.

    Edges touch where they look at each other and are no more than `within_mm` apart. Of parts that hang together by
    such edges one has to touch along `shortest_mm` at least; else none is changed. What was noted of pairs that touch
    is answered by what they lose (`losses`), and left out of the notes. Raises InputError if an edge cannot be moved:
    what lies beside it is too small, or a hole too near.

    Examples
    --------
    >>> from kerfwise.rules.case import nest, part, rect
    >>> two = nest(300, 200, part("A", rect(10, 10, 80, 60)), part("B", rect(90, 30, 80, 60)))
    >>> made = with_touching_edges_cut(two, 1.5, 20.0, 0.05)
    >>> [contour.polygon.bounds for contour in made.contours]
    [(10.0, 10.0, 89.25, 70.0), (90.75, 30.0, 170.0, 90.0)]
    >>> [(loss.contour, loss.others, loss.loss_mm) for loss in made.losses]
    [('A.outer', ('B.outer',), 0.75), ('B.outer', ('A.outer',), 0.75)]
    """
    touching = list(_touching(nest, shortest_mm, within_mm)) if kerf_mm > 0 else []
    rows: dict[int, list[FacingEdge]] = {}
    for edge in touching:
        rows.setdefault(edge.contour, []).append(edge)
    if not rows:
        return nest
    problems: list[str] = []
    moved = {}
    for number, edges in sorted(rows.items()):
        contour = nest.contours[number]
        try:
            moved[contour.id] = replace(contour, curve=_moved_in(nest, contour, edges, kerf_mm / 2))
        except ValueError as error:
            problems.append(f"{contour.id}: {error}")
    if problems:
        raise InputError(
            f"an edge that touches another part cannot lose half a kerf, {kerf_mm / 2:g} mm "
            "(cuts.common.accept_loss): leave a web there",
            file=nest.file or None,
            details=tuple(problems),
        )
    parts = (replace(p, outer=moved[p.outer.id]) if p.outer.id in moved else p for p in nest.parts)
    losses = []
    for number, edges in sorted(rows.items()):
        others = tuple(nest.contours[k].id for k in sorted({edge.other for edge in edges}))
        losses.append(Loss(nest.contours[number].id, others, kerf_mm / 2))
    pairs = {frozenset((loss.contour, other)) for loss in losses for other in loss.others}
    notes = tuple(note for note in nest.notes if note.common or frozenset(note.contours) not in pairs)
    return replace(with_parts(nest, tuple(parts)), losses=tuple(losses), notes=notes)


def _touching(nest: Nest, shortest_mm: float, within_mm: float) -> Iterator[FacingEdge]:
    """Edges of two outer contours that touch, of parts that hang together by one as long as asked."""
    outers = [(k, c) for k, c in enumerate(nest.contours) if c.kind == "outer"]
    found = [edge for edge in facing_edges(outers, 0.0, within_mm) if edge.length_mm > _OVERLAP_MM]
    if not found:
        return
    pairs = np.array([(edge.contour, edge.other) for edge in found], dtype=np.int64)
    label = weak_components(len(nest.contours), pairs)
    long = {int(label[edge.contour]) for edge in found if edge.length_mm >= shortest_mm}
    yield from (edge for edge in found if int(label[edge.contour]) in long)


def _moved_in(nest: Nest, contour: Contour, edges: Sequence[FacingEdge], by_mm: float) -> Curve:
    curve = contour.curve.towards("ccw")
    for edge in edges:
        curve = move_edge_in(curve, edge.begin, edge.end, by_mm)
    area, part = curve.polygon(), nest.part_of[contour.part]
    if not area.is_valid:
        raise ValueError("what is left would cross itself")
    for hole in part.holes:
        if not area.contains(hole.polygon):
            raise ValueError(f"{hole.id} is nearer to the edge than that")
    return curve if contour.curve.is_ccw else curve.reversed()
