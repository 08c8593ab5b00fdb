"""Tabs of a drawing: short lines on the outer contour of a part, or across it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely

from kerfwise.encoder.cut import Tab
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Part

from .drawing import DrawnCurve
from .layers import setting
from .options import ReadOptions

ALONG = 0.9
"""A line lies along a contour if so much of it is on it: then it is as long as the tab is wide."""


def with_tabs(parts: Sequence[Part], pieces: Sequence[DrawnCurve], options: ReadOptions) -> tuple[Part, ...]:
    """The parts with the tabs that are drawn, in the order in which they are drawn.

    The middle of a line says where its tab is. A line along the contour is as long as its tab is wide; of one across
    it, and of anything that closes, the profile says how wide the tab is.

    Raises
    ------
    InputError
        If something on their layers touches no outer contour, or those of two parts.
    """
    if not pieces:
        return tuple(parts)
    tabs: dict[int, list[Tab]] = {}
    outlines = np.array([part.outer.line for part in parts], dtype=object)
    tree = shapely.STRtree(outlines)
    for piece in pieces:
        line = piece.curve.line()
        near = sorted(tree.query(line, "dwithin", distance=options.join_tolerance_mm).tolist())
        if not near:
            raise _refused(piece, "lies on no outer contour of a part")
        if len(near) > 1:
            names = " and ".join(parts[k].outer.id for k in near[:2])
            raise _refused(piece, f"lies on two outer contours, {names}")
        (k,) = near
        tabs.setdefault(k, []).append(_tab(line, outlines[k], options.join_tolerance_mm))
    return tuple(replace(part, tabs=tuple(tabs[k])) if k in tabs else part for k, part in enumerate(parts))


def _tab(line: shapely.LineString, outline: shapely.LineString, within_mm: float) -> Tab:
    on = shapely.intersection(line, shapely.buffer(outline, within_mm))
    along = not line.is_ring and on.length > ALONG * line.length
    middle = shapely.line_interpolate_point(line, 0.5, normalized=True) if along else shapely.centroid(on)
    at = shapely.line_interpolate_point(outline, shapely.line_locate_point(outline, middle))
    return Tab((float(at.x), float(at.y)), float(line.length) if along else 0.0)


def _refused(piece: DrawnCurve, why: str) -> InputError:
    advice = f"a tab is a short line on one, or across it; to cut the line: {setting('cut', piece.layer)}"
    return InputError(f"the tab {piece.place} {why}; {advice}")
