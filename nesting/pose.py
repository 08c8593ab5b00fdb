"""How a part is turned, and where it lies: curves and areas moved exactly, arcs as arcs."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.cut import Tab
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Contour, Part

_EXACT = {0.0: (1.0, 0.0), 90.0: (0.0, 1.0), 180.0: (-1.0, 0.0), 270.0: (0.0, -1.0)}


@dataclass(frozen=True, slots=True, order=True)
class Pose:
    """A turn in degrees, counter-clockwise, after a mirroring at the y axis where it is mirrored.

    Examples
    --------
    >>> Pose(90.0).moved(np.array([[2.0, 0.0]])).tolist()
    [[0.0, 2.0]]
    """

    turn_deg: float = 0.0
    mirrored: bool = False

    @property
    def matrix(self) -> Floats:
        """Array (2, 2) that points (n, 2) are multiplied by, from the right."""
        turn = self.turn_deg % 360.0
        c, s = _EXACT.get(turn) or (math.cos(math.radians(turn)), math.sin(math.radians(turn)))
        flip = -1.0 if self.mirrored else 1.0
        return np.array([[flip * c, flip * s], [-s, c]])

    def moved(self, points: Floats, dx_mm: float = 0.0, dy_mm: float = 0.0) -> Floats:
        """Points (n, 2), mm, turned and then shifted; no zero is negative."""
        moved: Floats = points @ self.matrix + np.array([dx_mm, dy_mm]) + 0.0
        return moved


@dataclass(frozen=True, slots=True)
class Placed:
    """A copy of a part type where it lies: `kind` is the number of the type in the list, from 0 on."""

    kind: int
    pose: Pose
    dx_mm: float
    dy_mm: float

    def area(self, polygon: shapely.Geometry) -> shapely.Geometry:
        """An area of the part type where this copy lies."""
        return shapely.transform(polygon, lambda points: self.pose.moved(points, self.dx_mm, self.dy_mm))

    def curve(self, curve: Curve) -> Curve:
        """A curve of the part type where this copy lies, coordinates to a millionth of a millimetre."""
        points = self.pose.moved(curve.vertices[:, :2], self.dx_mm, self.dy_mm).round(6)
        bulges = -curve.vertices[:, 2] if self.pose.mirrored else curve.vertices[:, 2]
        return Curve(np.column_stack([points, bulges]) + 0.0, curve.closed)

    def part(self, part: Part, name: str) -> Part:
        """The part type's part where this copy lies, under another name."""
        return Part(
            name,
            self._contour(part.outer, name, "outer"),
            tuple(self._contour(hole, name, f"hole{k}") for k, hole in enumerate(part.holes, 1)),
            tuple(self._contour(mark, name, f"mark{k}") for k, mark in enumerate(part.marks, 1)),
            {**part.attributes, "turned": self.pose.turn_deg, "mirrored": self.pose.mirrored},
            tabs=tuple(Tab(self._point(tab.at), tab.width_mm) for tab in part.tabs),
        )

    def _point(self, at: tuple[float, float]) -> tuple[float, float]:
        x, y = self.pose.moved(np.array([at]), self.dx_mm, self.dy_mm).round(6)[0].tolist()
        return x, y

    def _contour(self, contour: Contour, name: str, what: str) -> Contour:
        return Contour(f"{name}.{what}", name, contour.kind, self.curve(contour.curve))
