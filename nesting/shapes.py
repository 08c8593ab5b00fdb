"""The part types as an engine sees them: each in each of its poses, and where pairs of them may not lie."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import shapely

from .nofit import forbidden
from .outline import CHORD_MM, grown
from .pose import Pose
from .wanted import PartType

Key = tuple[int, Pose]
"""The number of a part type, and how it lies."""


@dataclass(frozen=True, eq=False, slots=True)
class Shape:
    """A part type in one pose: what it takes, half the gap around it included; its origin is the part's own."""

    taken: shapely.Polygon
    metal: shapely.Polygon

    @property
    def size_mm(self) -> tuple[float, float]:
        """Width and height of what it takes."""
        x0, y0, x1, y1 = self.taken.bounds
        return x1 - x0, y1 - y0


class Shapes:
    """Shapes by type and pose, and the shifts by which pairs overlap: each worked out once, when it is asked for."""

    def __init__(self, types: Sequence[PartType], gap_mm: float) -> None:
        self.types, self.gap_mm = tuple(types), gap_mm
        self._drawn = [grown(kind.part, gap_mm / 2) for kind in types]
        self._shapes: dict[Key, Shape] = {}
        self._pairs: dict[tuple[Key, Key], shapely.Geometry] = {}
        self._poses = [tuple(self._different(k)) for k in range(len(self.types))]

    def poses(self, kind: int) -> tuple[Pose, ...]:
        """The poses of a type that differ: a disc has one."""
        return self._poses[kind]

    def shape(self, key: Key) -> Shape:
        """A type in a pose."""
        if key not in self._shapes:
            kind, pose = key
            taken = shapely.transform(self._drawn[kind], pose.moved)
            metal = shapely.transform(self.types[kind].part.polygon, pose.moved)
            self._shapes[key] = Shape(taken, metal)
        return self._shapes[key]

    def forbidden(self, lying: Key, coming: Key) -> shapely.Geometry:
        """Every shift of the one that comes, from that of the one that lies, by which they overlap."""
        pair = (lying, coming)
        if pair not in self._pairs:
            self._pairs[pair] = forbidden(self.shape(lying).taken, self.shape(coming).taken)
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
