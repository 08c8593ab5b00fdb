"""Three torches in one block: an upright one that goes along the contour, and on each side of it one that leans.

The block turns about the upright torch with the contour, so that one way round cuts a bevel of any kind. Before the
program its tilted torches are set by hand: to the bevel's angle, and so far out that each cuts at its root. They stand
apart along the contour, so that the block goes past each corner as far, and turns in a loop in the waste.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Contour

from .bevel import Face
from .tilted_path import Lean, TiltedPath

_STRAIGHT_RAD = 1e-3


@dataclass(frozen=True, slots=True)
class Block:
    """How far the tilted torches stand from the upright one along the contour, mm, and which of them on the left.

    Left is as one looks from the part to the waste: on a contour that is cut counter-clockwise that torch leads, and
    clockwise it is the last.
    """

    apart_mm: float
    left: Face

    def left_mm(self, lean: Lean) -> float:
        """How far on the left of the upright torch that with a lean stands."""
        if not lean.tilt_deg:
            return 0.0
        return self.apart_mm if (lean.tilt_deg > 0) == (self.left == "top") else -self.apart_mm

    def torches(self, path: TiltedPath, leans: tuple[Lean, ...], upright: Lean) -> tuple[TiltedPath, ...]:
        """The ways of the torches that burn, where the block goes along the path of its upright one."""
        found = []
        for lean in leans:
            out_mm = lean.half_mm - lean.slope * lean.root_mm - upright.half_mm
            steps = tuple(
                replace(step, tilt_deg=lean.tilt_deg, end_tilt_deg=lean.tilt_deg, half_mm=lean.half_mm)
                for step in path.steps
            )
            found.append(TiltedPath(steps, path.thickness_mm, (self.left_mm(lean), out_mm)))
        return tuple(found)

    def expect_fit(self, drawn: Contour) -> None:
        """Refuse a contour that a block cannot go round: its torches stand apart along straight edges.

        Raises InputError with the place, and what to do.
        """
        if drawn.edge_bevels:
            raise InputError("a block of torches cuts whole contours: take a head that tilts for single edges")
        segments, out = drawn.curve.segments, 1.0 if drawn.curve.is_ccw == (drawn.kind == "outer") else -1.0
        for before, after in zip((segments[-1], *segments), segments, strict=False):
            (ax, ay), (bx, by) = before.tangent_at(1.0), after.tangent_at(0.0)
            x, y = after.start
            if after.is_arc:
                raise InputError(
                    f"an arc begins at ({x:.1f}, {y:.1f}), and the torches of the block stand {self.apart_mm:g} mm "
                    "apart along it: they cut straight edges; take a head that tilts"
                )
            if out * math.atan2(ax * by - ay * bx, ax * bx + ay * by) < -_STRAIGHT_RAD:
                raise InputError(
                    f"at ({x:.1f}, {y:.1f}) it bends into the part, where the torches of the block that go ahead would "
                    "burn: take a head that tilts"
                )
