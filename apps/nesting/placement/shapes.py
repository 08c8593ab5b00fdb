"""The part types as an engine sees them: each in each of its poses, and where pairs of them may not lie."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import shapely

from kerfwise.encoder.nest import Part

from .blocks import ALONE, Block, pair_of, twice
from .demand import Common, PartType
from .nofit import Placed, Pose, forbidden

Key = tuple[int, Pose]
"""The number of a part type or of a block of it, and how it lies."""
MOST_DOUBLED = 4
"""Blocks with common edges are doubled so often: up to 16 copies."""


@dataclass(frozen=True, eq=False, slots=True)
class Shape:
    """A part type in one pose: what it takes, half the gap around it included; its origin is the part's own."""

    taken: shapely.Polygon
    metal: shapely.Polygon


class Shapes:
    """Shapes by type and pose, and the shifts by which pairs overlap: each worked out once, when it is asked for.

    `types`: the part types; their numbers are those in this order. `gap_mm`: between any two parts. `common`: how far
    edges lie apart that are cut once; without, blocks with such edges are not made. `more_mm`: how much more than half
    the gap parts of some types take all round, by the number of the type. `doubled`: how often blocks with common edges
    are doubled.
    """

    def __init__(
        self,
        types: Sequence[PartType],
        gap_mm: float,
        common: Common | None = None,
        more_mm: Mapping[int, float] | None = None,
        doubled: int = MOST_DOUBLED,
    ) -> None:
        self.types, self.gap_mm, self.common = tuple(types), gap_mm, common
        self._doubled, more = doubled, more_mm or {}
        self._drawn = [grow_outline(kind.part, gap_mm / 2 + more.get(k, 0.0)) for k, kind in enumerate(types)]
        self._shapes: dict[Key, Shape] = {}
        self._pairs: dict[tuple[Key, Key], shapely.Geometry] = {}
        self._poses = [tuple(self._different(k)) for k in range(len(self.types))]
        self._blocks: dict[int, Block | None] = {}

    def poses(self, number: int) -> tuple[Pose, ...]:
        """The poses of a type that differ: a disc has one. Those of a block leave all its parts in poses of theirs."""
        if number < len(self.types):
            return self._poses[number]
        block = self.block(number)
        return () if block is None else block.poses

    def block(self, number: int) -> Block | None:
        """Several of a type as one, by their number: that of the type, and that of all types times the kind of block.

        1 is a pair, where two fill their rectangle better than one does. 2, 3, 4… are two, four, eight… copies a kerf
        apart along straight edges, where edges are cut once. None where there is no such block.
        """
        if number not in self._blocks:
            level, kind = divmod(number, len(self.types))
            self._blocks[number] = self._made(kind, level)
        return self._blocks[number]

    def _made(self, kind: int, level: int) -> Block | None:
        if level == 1:
            return pair_of(self.types[kind], self._drawn[kind])
        half = None if level == 2 else self.block(kind + (level - 1) * len(self.types))
        if self.common is None or (level > 2 and half is None):
            return None
        return twice(self.types[kind], ALONE if half is None else half.members, self._drawn[kind], self.common)

    def ways(self, kind: int, blocks: bool) -> Iterator[tuple[int, int]]:
        """The numbers of a type's blocks, and of the type itself, with how many copies each is: the largest first."""
        if blocks:
            for level in (*range(self._doubled + 1, 1, -1), 1) if self.common is not None else (1,):
                block = self.block(kind + level * len(self.types))
                if block is not None:
                    yield kind + level * len(self.types), len(block.members)
        yield kind, 1

    def members(self, key: Key, dx_mm: float, dy_mm: float) -> list[Placed]:
        """The parts that lie where one, or a block, is laid."""
        number, pose = key
        block = None if number < len(self.types) else self.block(number)
        if block is None:
            return [Placed(number, pose, dx_mm, dy_mm)]
        return block.placed(number % len(self.types), pose, dx_mm, dy_mm)

    def shape(self, key: Key) -> Shape:
        """A type in a pose."""
        if key not in self._shapes:
            kind, pose = key
            if kind >= len(self.types):
                block = self.block(kind)
                assert block is not None
                return self._shapes.setdefault(key, Shape(shapely.transform(block.taken, pose.moved), block.taken))
            taken = shapely.transform(self._drawn[kind], pose.moved)
            metal = shapely.transform(self.types[kind].part.polygon, pose.moved)
            self._shapes[key] = Shape(taken, metal)
        return self._shapes[key]

    def forbidden(self, lying: Key, coming: Key) -> shapely.Geometry:
        """Every shift of the one that comes, from that of the one that lies, by which they overlap."""
        pair = (lying, coming)
        if pair not in self._pairs:
            back = self._pairs.get((coming, lying))
            if back is None:
                self._pairs[pair] = forbidden(self.shape(lying).taken, self.shape(coming).taken)
            else:
                self._pairs[pair] = shapely.transform(back, lambda points: -points)
        return self._pairs[pair]

    def _different(self, kind: int) -> list[Pose]:
        found: list[tuple[Pose, shapely.Geometry]] = []
        for pose in self.types[kind].poses:
            metal = self._at_zero(self.shape((kind, pose)).metal)
            if all(metal.symmetric_difference(other).area > 2 * CHORD_MM * metal.length for _, other in found):
                found.append((pose, metal))
        return [pose for pose, _ in found]

    @staticmethod
    def _at_zero(metal: shapely.Geometry) -> shapely.Geometry:
        x0, y0, _, _ = metal.bounds
        return shapely.transform(metal, lambda points: points - [x0, y0])


# What a part takes on the sheet: its outline and half the gap around it, with few vertices.

LOOSE_MM = 2e-4
"""Parts are grown by so much less than half the gap, so that what fits exactly is found to fit."""
CHORD_MM = 0.01
"""Chords of arcs lie so far inside at most."""
FEW = 16
"""Outlines with no more vertices are kept as they are."""
_MITRE = 1.5
_LEAST_SPLIT = 0.2
_SPLIT_SHARE = 0.003


def grow_outline(part: Part, half_gap_mm: float) -> shapely.Polygon:
    """The part with half the gap around it and in its holes; holes that the gap fills are gone.

    Outlines of many vertices are laid around with fewer: at most 0.3 % of the part's size is lost.

    Examples
    --------
    >>> from kerfwise.rules.case import part, rect
    >>> tuple(round(x, 3) for x in grow_outline(part("A", rect(0, 0, 40, 20)), 5.0).bounds)
    (-5.0, -5.0, 45.0, 25.0)
    """
    curved = any(segment.is_arc for contour in (part.outer, *part.holes) for segment in contour.curve.segments)
    by_mm = half_gap_mm - LOOSE_MM + (CHORD_MM if curved else 0.0)
    outer = _around(shapely.Polygon(part.polygon.exterior), by_mm)
    holes = (_within(shapely.Polygon(ring), by_mm) for ring in part.polygon.interiors)
    return outer.difference(shapely.union_all([hole for hole in holes if not hole.is_empty]))


def _around(polygon: shapely.Polygon, by_mm: float) -> shapely.Polygon:
    if len(polygon.exterior.coords) - 1 <= FEW:
        sharp = polygon.buffer(by_mm, join_style="mitre", mitre_limit=_MITRE)
        if by_mm <= 0:  # a sharp tip would lose much of its length
            near = not sharp.is_empty and shapely.hausdorff_distance(sharp, polygon) < 4 * LOOSE_MM
            return _outer(sharp) if near else polygon
        if sharp.covers(polygon.buffer(by_mm * (1 - 1e-6), quad_segs=8)):
            return _outer(sharp)
    split_mm = _split(polygon)
    wide = polygon.buffer(by_mm + split_mm, quad_segs=8) if by_mm + split_mm > 0 else polygon
    return _outer(_outer(wide).simplify(split_mm * 0.8))


def _within(hole: shapely.Polygon, by_mm: float) -> shapely.Geometry:
    """The room in a hole, or nothing."""
    few = len(hole.exterior.coords) - 1 <= FEW
    split_mm = 0.0 if few else _split(hole)
    room = hole.buffer(-by_mm - split_mm, join_style="mitre", mitre_limit=_MITRE)
    return room if few else room.simplify(split_mm * 0.8)


def _split(polygon: shapely.Polygon) -> float:
    x0, y0, x1, y1 = polygon.bounds
    return max(_LEAST_SPLIT, _SPLIT_SHARE * math.hypot(x1 - x0, y1 - y0))


def _outer(area: shapely.Geometry) -> shapely.Polygon:
    """The outline of the largest piece, without holes."""
    largest = max(shapely.get_parts(area), key=lambda piece: piece.area)
    return shapely.Polygon(largest.exterior)
