"""Several copies of a part as one block: side by side in the least rectangle, by the method of the defining line."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.candidates.candidate import CommonOptions
from kerfwise.encoder.candidates.common_edges import CommonEdges, common_edges
from kerfwise.encoder.candidates.common_paths import states
from kerfwise.encoder.graphs import weak_components
from kerfwise.encoder.nest import Nest, Part, Sheet
from kerfwise.encoder.torch_path import compensated

from .demand import Common, PartType
from .nofit import Placed, Pose, forbidden

_APART_MM = 2e-3
"""A pair is laid so much wider, as places are rounded to a thousandth of a millimetre."""
_WORTH = 1.03
"""A pair is one where it fills its rectangle so much better than a part alone fills its own."""
_WORTH_COMMON = 0.97
"""Copies with a common edge are a block even where they fill their rectangle a little worse."""
_MOST_TRIED = 40
_TIP_KERFS = 20
"""Two stretches no further apart end at one corner."""
_MOST_CORNERS = 100
"""Blocks with more vertices are not doubled again: the look for a place would take seconds."""
_SEAM_MM = 1e-3
_MANY, _LOST_MM = 60, 0.01
"""Outlines of more vertices lose so much in the look for a place; whether edges are common is asked of the part."""

Member = tuple[float, tuple[float, float]]
"""How a copy lies in its block: its turn, degrees, then its shift, mm."""
ALONE: tuple[Member, ...] = ((0.0, (0.0, 0.0)),)


@dataclass(frozen=True, eq=False, slots=True)
class Block:
    """Copies of one part, the first as it is drawn; `taken` is what they take with half the gap around them.

    `poses` are those in which each copy is turned as its type allows. `edges` says that each copy is a kerf from
    another, along a straight edge of both.
    """

    members: tuple[Member, ...]
    taken: shapely.Polygon
    poses: tuple[Pose, ...]
    edges: bool = False

    def placed(self, kind: int, pose: Pose, dx_mm: float, dy_mm: float) -> list[Placed]:
        """The copies where the block is turned and shifted so."""
        found = []
        for turn_deg, shift in self.members:
            dx, dy = pose.moved(np.array([shift]), dx_mm, dy_mm).round(3)[0].tolist()
            found.append(Placed(kind, Pose((pose.turn_deg + turn_deg) % 360.0), dx, dy))
        return found


def pair_of(kind: PartType, taken: shapely.Polygon) -> Block | None:
    """How two copies lie best, by turns that the type allows; None where pairs do not pay, or would not hang together.

    `taken`: what one copy takes, half the gap around it included.
    """
    if kind.quantity < 2:
        return None
    outline = shapely.Polygon(taken.exterior).buffer(_APART_MM, join_style="mitre")
    beside = places_beside(outline, outline, _turns(kind, outline))[0]
    if 2 * outline.area / beside.area_mm2 < _share(outline) * _WORTH:
        return None
    members = (*ALONE, (beside.turn_deg, beside.shift))
    return _block(kind, members, taken.buffer(_APART_MM, join_style="mitre"))


def twice(kind: PartType, half: tuple[Member, ...], taken: shapely.Polygon, common: Common) -> Block | None:
    """Two blocks with common edges as one, a kerf apart along another straight edge; None where there is no such place.

    `half`: the copies of one of the two blocks. `taken`: what one copy takes, half the gap around it included.
    `common`: the distance, and how long the edge is at least.
    """
    if kind.quantity < 2 * len(half) or kind.held or kind.part.tabs or kind.part.marks:
        return None
    if max((s.length_mm for s in kind.part.outer.curve.segments if not s.is_arc), default=0.0) < common.shortest_mm:
        return None
    outline = kind.part.outer.polygon.buffer(common.apart_mm / 2, join_style="mitre", mitre_limit=10.0)
    if len(outline.exterior.coords) > _MANY:
        outline = outline.simplify(_LOST_MM)
    both = _filled(_closed(list(_moved(outline, half))))
    if both is None:
        return None
    if len(both.exterior.coords) > _MOST_CORNERS:
        return None
    own = kind.part.outer.polygon
    for beside in places_beside(both, both, _turns(kind, both))[:_MOST_TRIED]:
        if len(half) * 2 * own.area / beside.area_mm2 < _share(own) * _WORTH_COMMON:
            return None
        other = Pose(beside.turn_deg)
        members = (*half, *((_turned(turn, other), _shifted(shift, other, beside)) for turn, shift in half))
        if _hang_together(kind, members, common) and (block := _block(kind, members, taken, edges=True)) is not None:
            return block
    return None


def _turns(kind: PartType, outline: shapely.Polygon) -> Sequence[float]:
    """How a second block may be turned beside the first."""
    if kind.free:
        return turns_to_try(outline, outline)
    return sorted({(b - a) % 360.0 for a in kind.turns_deg for b in kind.turns_deg})


def _share(outline: shapely.Polygon) -> float:
    x0, y0, x1, y1 = outline.bounds
    return float(outline.area / ((x1 - x0) * (y1 - y0)))


def _turned(turn_deg: float, other: Pose) -> float:
    return round((turn_deg + other.turn_deg) % 360.0, 9)


def _shifted(shift: tuple[float, float], other: Pose, beside: PairPlacement) -> tuple[float, float]:
    x, y = other.moved(np.array([shift]), *beside.shift)[0].tolist()
    return x, y


def _moved(area: shapely.Geometry, members: Iterable[Member]) -> Iterator[shapely.Geometry]:
    for turn_deg, shift in members:
        yield Placed(0, Pose(turn_deg), *shift).area(area)


def _closed(areas: Sequence[shapely.Geometry]) -> shapely.Geometry:
    """Areas that touch as one."""
    wide = shapely.union_all([area.buffer(_SEAM_MM, join_style="mitre") for area in areas])
    return wide.buffer(-_SEAM_MM, join_style="mitre")


def _filled(area: shapely.Geometry) -> shapely.Polygon | None:
    """An area without its holes; None where it is in pieces."""
    return shapely.Polygon(area.exterior) if area.geom_type == "Polygon" else None


def _block(kind: PartType, members: tuple[Member, ...], taken: shapely.Polygon, edges: bool = False) -> Block | None:
    allowed = {round(turn % 360.0, 9) for turn in kind.turns_deg}
    poses = tuple(
        Pose(turn)
        for turn in kind.turns_deg
        if kind.free or all(round((turn + by) % 360.0, 9) in allowed for by, _ in members)
    )
    both = shapely.union_all(list(_moved(taken, members)))
    return Block(members, both, poses, edges) if poses and both.geom_type == "Polygon" else None


def _hang_together(kind: PartType, members: Sequence[Member], common: Common) -> bool:
    """Whether all copies hang together by edges that are cut once, each two by one stretch, and none is nearer."""
    laid = [Placed(0, Pose(turn), *shift).part(kind.part, f"{number}") for number, (turn, shift) in enumerate(members)]
    areas = np.array([part.outer.polygon for part in laid], dtype=object)
    x0, y0, x1, y1 = shapely.total_bounds(areas).tolist()
    sheet = Sheet.rectangle(2 * (x1 - x0), 2 * (y1 - y0))
    nest = Nest(sheet, tuple(laid))
    outers = [number for number, contour in enumerate(nest.contours) if contour.kind == "outer"]
    edges = common_edges(nest, outers, common.apart_mm, CommonOptions(common.shortest_mm, common.tolerance_mm))
    if set(edges.of) != set(outers) or not all(_leaves_one_stretch(nest, k, edges, common.apart_mm) for k in outers):
        return False
    if len(set(weak_components(len(nest.contours), edges.pairs)[outers].tolist())) > 1:
        return False
    one, other = shapely.STRtree(areas).query(areas, "dwithin", distance=common.apart_mm - common.tolerance_mm)
    return not (one != other).any()


def _leaves_one_stretch(nest: Nest, number: int, edges: CommonEdges, kerf_mm: float) -> bool:
    """Whether a copy has one stretch in common with each neighbour, and one is left of it where two share its corner.

    At a sharp tip a piece stays between the edges of two neighbours: once both are out, no cut is along what is left.
    """
    beside, ring = edges.of[number], compensated(nest.contours[number], kerf_mm)
    if any(len(rows) > 1 for rows in beside.values()):
        return False
    left = {out for out, _ in states(ring, beside, kerf_mm, edges.junctions[number])}
    rows = sorted((low, mm, other) for other, [(low, mm)] in beside.items())
    return all(
        one == other or (after - low - mm) % ring.length_mm > _TIP_KERFS * kerf_mm or frozenset((one, other)) in left
        for (low, mm, one), (after, _, other) in zip(rows, rows[1:] + rows[:1], strict=True)
    )


# Pavlov's method of the defining line: two polygons side by side in the least rectangle, among finitely many places.
#
# Pavlov 1999: one part is fixed, one of its sides is the defining line, and the other part slides and turns along it.
# The rectangle around both is least where a side of the second lies on the defining line, or is parallel to an axis.
# So the turns that need trying are finite, two for each pair of sides; and of each turn the places are the corners of
# where the second part may lie, that is, where it touches the first.

_SAME_DEG = 1e-6
_SIDES = 4
"""So many sides of a part that may be turned at will are laid along axes, the longest."""
_PLACES = 6
"""Places of each turn that are told."""


@dataclass(frozen=True, slots=True)
class PairPlacement:
    """How the second part lies: turned, then shifted; and the rectangle around both, its sides along the axes."""

    turn_deg: float
    shift: tuple[float, float]
    width_mm: float
    height_mm: float

    @property
    def area_mm2(self) -> float:
        """Of the rectangle."""
        return self.width_mm * self.height_mm


def turns_to_try(fixed: shapely.Polygon, coming: shapely.Polygon) -> list[float]:
    """The turns of the second part, degrees: a side of it on a side of the first, or parallel to the x axis."""
    first, second = _directions(fixed), _directions(coming)
    on_line = ((a + 180.0 - b) % 360.0 for a in first for b in second)
    on_axis = ((axis - b) % 360.0 for axis in (0.0, 90.0, 180.0, 270.0) for b in second)
    return _different(round(turn, 9) for turn in (*on_line, *on_axis))


def _different(turns_deg: Iterable[float]) -> list[float]:
    """Turns, the least first, each once: a whole turn is none."""
    kept: list[float] = []
    for turn in sorted(turns_deg):
        if not kept or turn - kept[-1] > _SAME_DEG:
            kept.append(turn)
    return [turn for turn in kept if 360.0 - turn > _SAME_DEG]


def sides_on_axes(part: Part) -> tuple[float, ...]:
    """The turns, degrees, that lay one of the longest sides of a part's hull along an axis; the drawn one among them.

    Examples
    --------
    >>> from kerfwise.rules.case import part
    >>> sides_on_axes(part("A", [(0, 0), (40, 0), (0, 40)]))
    (0.0, 45.0, 90.0, 135.0, 180.0, 225.0, 270.0, 315.0)
    """
    hull = shapely.geometry.polygon.orient(part.outer.polygon.convex_hull)
    ring = shapely.get_coordinates(hull.exterior)
    lengths = np.hypot(*np.diff(ring, axis=0).T)
    longest = np.argsort(-np.round(lengths, 6), kind="stable")[:_SIDES]
    found = {0.0, 90.0, 180.0, 270.0}
    for k in longest.tolist():
        dx, dy = (ring[k + 1] - ring[k]).tolist()
        along = -math.degrees(math.atan2(dy, dx))
        found |= {round((along + axis) % 360.0, 9) % 360.0 for axis in (0.0, 90.0, 180.0, 270.0)}
    return tuple(_different(found))


def places_beside(
    fixed: shapely.Polygon, coming: shapely.Polygon, turns_deg: Sequence[float] | None = None
) -> list[PairPlacement]:
    """Places of the second part where the rectangle around both is small, the best of all first; they may touch.

    `fixed` and `coming`: polygons, mm, arcs as chords; grown by half the gap where there is to be one. `turns_deg`: the
    turns that are allowed; those of the method where it is not given.

    Examples
    --------
    Two halves of a square:

    >>> half = shapely.Polygon([(0, 0), (10, 0), (0, 10)])
    >>> found = places_beside(half, half)[0]
    >>> found.turn_deg, found.shift, round(found.area_mm2, 6)
    (180.0, (10.0, 10.0), 100.0)
    """
    tried = turns_to_try(fixed, coming) if turns_deg is None else turns_deg
    return sorted(_all_beside(fixed, coming, tried), key=_rank)


def _rank(one: PairPlacement) -> tuple[float, float, float, tuple[float, float]]:
    return round(one.area_mm2, 6), round(one.width_mm + one.height_mm, 6), one.turn_deg, one.shift


def _all_beside(fixed: shapely.Polygon, coming: shapely.Polygon, turns_deg: Sequence[float]) -> Iterator[PairPlacement]:
    x0, y0, x1, y1 = fixed.bounds
    for turn in turns_deg:
        turned = shapely.transform(coming, Pose(turn).moved)
        touching = forbidden(fixed, turned)
        shifts = _where(touching, turned, fixed)
        a0, b0, a1, b1 = turned.bounds
        wide = np.maximum(x1, a1 + shifts[:, 0]) - np.minimum(x0, a0 + shifts[:, 0])
        high = np.maximum(y1, b1 + shifts[:, 1]) - np.minimum(y0, b0 + shifts[:, 1])
        ranked = np.lexsort((shifts[:, 1], shifts[:, 0], np.round(wide + high, 6), np.round(wide * high, 6)))
        for k in ranked[:_PLACES].tolist():
            dx, dy = (round(float(by), 9) + 0.0 for by in shifts[k])
            yield PairPlacement(turn, (dx, dy), float(wide[k]), float(high[k]))


def _where(touching: shapely.Geometry, coming: shapely.Polygon, fixed: shapely.Polygon) -> Floats:
    """Shifts by which the two touch and the rectangle may be least: corners, and where sides of boxes are level.

    On an edge of the border the rectangle's area has its least value at an end, or where a side of the one box passes
    a side of the other.
    """
    corners = shapely.get_coordinates(touching)
    x0, y0, x1, y1 = fixed.bounds
    a0, b0, a1, b1 = coming.bounds
    far = 1e6
    level = [shapely.LineString([(x, -far), (x, far)]) for x in (x0 - a0, x1 - a1)]
    level += [shapely.LineString([(-far, y), (far, y)]) for y in (y0 - b0, y1 - b1)]
    met = [shapely.get_coordinates(touching.boundary.intersection(line)) for line in level]
    shifts: Floats = np.concatenate([corners, *met])
    return shifts


def _directions(shape: shapely.Polygon) -> list[float]:
    """Directions of the sides, degrees, the outline run counter-clockwise."""
    ring = shapely.get_coordinates(shapely.geometry.polygon.orient(shape).exterior)
    sides = np.diff(ring, axis=0)
    return [math.degrees(math.atan2(dy, dx)) % 360.0 for dx, dy in sides.tolist() if math.hypot(dx, dy) > 1e-9]
