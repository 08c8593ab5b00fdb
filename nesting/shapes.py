"""The part types as an engine sees them: each in each of its poses, and where pairs of them may not lie."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from .nofit import forbidden
from .outline import CHORD_MM, grown
from .pairs import Pair, pair_of
from .pose import Placed, Pose
from .wanted import PartType

Key = tuple[int, Pose]
"""The number of a part type, and how it lies."""


@dataclass(frozen=True, eq=False, slots=True)
class Shape:
    """A part type in one pose: what it takes, half the gap around it included; its origin is the part's own."""

    taken: shapely.Polygon
    metal: shapely.Polygon


class Shapes:
    """Shapes by type and pose, and the shifts by which pairs overlap: each worked out once, when it is asked for."""

    def __init__(self, types: Sequence[PartType], gap_mm: float) -> None:
        self.types, self.gap_mm = tuple(types), gap_mm
        self._drawn = [grown(kind.part, gap_mm / 2) for kind in types]
        self._shapes: dict[Key, Shape] = {}
        self._pairs: dict[tuple[Key, Key], shapely.Geometry] = {}
        self._poses = [tuple(self._different(k)) for k in range(len(self.types))]
        self._pair_of: dict[int, Pair | None] = {}

    def poses(self, kind: int) -> tuple[Pose, ...]:
        """The poses of a type that differ: a disc has one. Those of a pair leave both parts in poses of theirs."""
        if kind < len(self.types):
            return self._poses[kind]
        pair = self.pair(kind - len(self.types))
        return () if pair is None else pair.poses

    def pair(self, kind: int) -> Pair | None:
        """How two of a type lie best together; None where a pair fills its rectangle no better than one part does.

        As a key of shapes it has the number of the type and that of all types, added.
        """
        if kind not in self._pair_of:
            self._pair_of[kind] = pair_of(self.types[kind], self._drawn[kind])
        return self._pair_of[kind]

    def members(self, key: Key, dx_mm: float, dy_mm: float) -> list[Placed]:
        """The parts that lie where one, or a pair, is laid."""
        kind, pose = key
        if kind < len(self.types):
            return [Placed(kind, pose, dx_mm, dy_mm)]
        pair = self.pair(kind - len(self.types))
        assert pair is not None
        dx, dy = pose.moved(np.array([pair.shift]), dx_mm, dy_mm).round(3)[0].tolist()
        other = Pose((pose.turn_deg + pair.turn_deg) % 360.0)
        kind -= len(self.types)
        return [Placed(kind, pose, dx_mm, dy_mm), Placed(kind, other, dx, dy)]

    def shape(self, key: Key) -> Shape:
        """A type in a pose."""
        if key not in self._shapes:
            kind, pose = key
            if kind >= len(self.types):
                pair = self.pair(kind - len(self.types))
                assert pair is not None
                return self._shapes.setdefault(key, Shape(shapely.transform(pair.taken, pose.moved), pair.taken))
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
