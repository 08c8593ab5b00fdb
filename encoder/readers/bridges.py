"""Bridges of a drawing: rectangles, each from one part to another."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from kerfwise.encoder.bridges.bridge import Bridge
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Part
from kerfwise.encoder.validate.metal import metal_of
from kerfwise.encoder.validate.tolerances import TOUCH_MM

from .drawing import DrawnCurve
from .join import join
from .layers import setting
from .options import ReadOptions

SKEW = 0.01
"""How far the sides of a rectangle may be from a right angle, as a share of their length."""


def bridges_of_drawing(pieces: Sequence[DrawnCurve], parts: Sequence[Part], options: ReadOptions) -> tuple[Bridge, ...]:
    """The bridges in the order in which they are drawn.

    Raises
    ------
    InputError
        If something on their layers is no rectangle, or none whose ends lie in two parts.
    """
    joined = join(pieces, options.join_tolerance_mm)
    for piece in (*joined.chains, *joined.specks):
        raise _refused(piece, "does not close")
    if not joined.rings:
        return ()
    metal = metal_of(parts)
    return tuple(_bridge(ring, parts, metal, k) for k, ring in enumerate(joined.rings, 1))


def _bridge(ring: DrawnCurve, parts: Sequence[Part], metal: NDArray[np.object_], number: int) -> Bridge:
    if (corners := _corners(ring)) is None:
        raise _refused(ring, "is no rectangle")
    for k in (0, 1):
        start, end = (_middle(corners[at], corners[(at + 1) % 4]) for at in (k, k + 2))
        one, other = (_part_at(at, parts, metal) for at in (start, end))
        if one is not None and other is not None and one != other:
            return Bridge((one, other), start, end, math.dist(corners[k], corners[k + 1]), number)
    raise _refused(ring, "does not go from one part to another: each end lies in a part, or on its edge")


def _corners(ring: DrawnCurve) -> list[Point] | None:
    """The four corners of a rectangle; None of anything else."""
    segments = ring.curve.segments
    if len(segments) != 4 or any(segment.is_arc for segment in segments):
        return None
    corners = [segment.start for segment in segments]
    (ax, ay), (bx, by), (cx, cy), (dx, dy) = corners
    long_mm = max(segment.length_mm for segment in segments)
    parallel = math.hypot(bx - ax - (cx - dx), by - ay - (cy - dy)) <= SKEW * long_mm
    square = abs(math.dist(corners[0], corners[2]) - math.dist(corners[1], corners[3])) <= SKEW * long_mm
    return corners if parallel and square else None


def _middle(one: Point, other: Point) -> Point:
    return (one[0] + other[0]) / 2, (one[1] + other[1]) / 2


def _part_at(at: Point, parts: Sequence[Part], metal: NDArray[np.object_]) -> str | None:
    point = shapely.Point(at)
    near = [part.id for part, area in zip(parts, metal, strict=True) if shapely.distance(area, point) <= TOUCH_MM]
    return near[0] if near else None


def _refused(piece: DrawnCurve, why: str) -> InputError:
    advice = f"a bridge is drawn as a rectangle from part to part; to cut it as a part: {setting('cut', piece.layer)}"
    return InputError(f"the bridge {piece.place} {why}; {advice}")
