"""Where a sheet lies on its machine: from the drawing's coordinates, which plans keep to, to the machine's and back.

The machine's coordinates are those of the drawing less the `corner`: (0, 0) where the machine's zero is the drawing's,
the lower left corner of the sheet's bounding box where that corner is put at the machine's zero.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from kerfwise.encoder.geometry.segment import Box, Point
from kerfwise.encoder.nest import Nest

from .machine_section import Machine

_DIGITS = 4


@dataclass(frozen=True, slots=True)
class Frame:
    """A machine's coordinates: `corner` is the point of the drawing that is its zero.

    Examples
    --------
    >>> frame = Frame((3000.0, 20.0))
    >>> frame.on_machine((3100.0, 50.0)), frame.on_drawing((0.0, 0.0))
    ((100.0, 30.0), (3000.0, 20.0))
    """

    corner: Point = (0.0, 0.0)

    def on_machine(self, point: Point) -> Point:
        """A point of the drawing, as the machine counts."""
        return point[0] - self.corner[0], point[1] - self.corner[1]

    def on_drawing(self, point: Point) -> Point:
        """A point of the machine, as the drawing counts."""
        return point[0] + self.corner[0], point[1] + self.corner[1]


def frame_of(nest: Nest, machine: Machine) -> Frame:
    """The machine's coordinates on this nest."""
    if machine.origin == "drawing":
        return Frame()
    x0, y0, _, _ = nest.sheet.bounds
    return Frame((round(x0, _DIGITS), round(y0, _DIGITS)))


def reach_of(nest: Nest, machine: Machine) -> Box | None:
    """What the torch can go to, in the drawing's coordinates: infinite the way that the profile does not say.

    None where it says nothing.
    """
    if machine.travel_x_mm is None and machine.travel_y_mm is None:
        return None
    (x0, x1), (y0, y1) = (span or (-math.inf, math.inf) for span in (machine.travel_x_mm, machine.travel_y_mm))
    frame = frame_of(nest, machine)
    return *frame.on_drawing((x0, y0)), *frame.on_drawing((x1, y1))
