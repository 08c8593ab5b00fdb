"""Several copies of a part as one block: side by side in the least rectangle, by the method of the defining line."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from kerfwise.encoder.candidates.candidate import CommonOptions
from kerfwise.encoder.candidates.common_edges import CommonEdges, common_edges
from kerfwise.encoder.candidates.common_ways import states
from kerfwise.encoder.compensation import compensated
from kerfwise.encoder.components import weak_components
from kerfwise.encoder.nest import Nest, Sheet

from .defining_line import Beside, places_beside, turns_to_try
from .pose import Placed, Pose
from .wanted import Common, PartType

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

    Parameters
    ----------
    kind
        The part type.
    taken
        What one copy takes, half the gap around it included.
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

    Parameters
    ----------
    kind
        The part type.
    half
        The copies of one of the two blocks.
    taken
        What one copy takes, half the gap around it included.
    common
        The distance, and how long the edge is at least.
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
        if _hang_together(kind, members, common) and (made := _block(kind, members, taken, edges=True)) is not None:
            return made
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


def _shifted(shift: tuple[float, float], other: Pose, beside: Beside) -> tuple[float, float]:
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
    if set(edges.of) != set(outers) or not all(_one_stretch_left(nest, k, edges, common.apart_mm) for k in outers):
        return False
    if len(set(weak_components(len(nest.contours), edges.pairs)[outers].tolist())) > 1:
        return False
    one, other = shapely.STRtree(areas).query(areas, "dwithin", distance=common.apart_mm - common.tolerance_mm)
    return not (one != other).any()


def _one_stretch_left(nest: Nest, number: int, edges: CommonEdges, kerf_mm: float) -> bool:
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
