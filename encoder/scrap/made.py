"""A nest with the lines that a profile asks for in its skeleton."""

from __future__ import annotations

from dataclasses import dataclass, replace

import shapely

from kerfwise.encoder.cut import Side
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Box, Point
from kerfwise.encoder.kept import kept_with_nest
from kerfwise.encoder.nest import Nest, as_scrap

from .grid import grid_lines
from .rectangle import saved
from .whole import carrying, largest, pieces_of, skeleton, taken_apart

LEAST_MM = 50.0
"""A remnant with a shorter side is not worth keeping."""
_CLEAR_MM = 0.01
"""Lines keep so much more than a kerf from parts, whose outlines are chords here."""


@dataclass(frozen=True, slots=True)
class Remnant:
    """The rectangle of unused sheet that is saved, mm in the nest's coordinates, and the line that cuts it off."""

    bounds: Box
    line: tuple[Point, ...]

    @property
    def size_mm(self) -> tuple[float, float]:
        """Width and height."""
        x0, y0, x1, y1 = self.bounds
        return x1 - x0, y1 - y0


@kept_with_nest(most=8)
def with_scrap(nest: Nest, kerf_mm: float, grid_mm: float | None, remnant: Side | None) -> Nest:
    """The nest with the lines of a grid, and of a remnant, in its skeleton; it keeps the nest as drawn.

    Examples
    --------
    >>> from kerfwise.encoder.by_hand import nest, part, rect
    >>> plate = nest(1000, 400, part("A", rect(50, 50, 300, 300)))
    >>> [c.curve.as_rows() for c in with_scrap(plate, 1.5, None, "right").scrap]
    [[[351.51, 400.0], [351.51, 0.0]]]

    Raises
    ------
    InputError
        If the nest has scrap lines of its own, the sheet is no rectangle where a remnant is asked for, or nothing of it
        is left there.
    """
    if grid_mm is None and remnant is None:
        return nest
    if nest.scrap:
        raise InputError(
            "the nest has scrap lines of its own, and the profile asks for others (cuts.scrap): leave one of them out",
            file=nest.file or None,
        )
    whole = skeleton(nest.sheet.polygon, [part.outer.polygon for part in nest.parts], kerf_mm + _CLEAR_MM)
    wide = carrying(whole, kerf_mm)
    metal = shapely.intersection(_largest(wide, kerf_mm).buffer(kerf_mm), whole)
    rows: list[list[Point]] = []
    if remnant is not None:
        kept = remnant_of(nest, kerf_mm, remnant)
        rows.append(list(kept.line))
        x0, y0, x1, y1 = kept.bounds
        half = kerf_mm / 2
        metal = metal.difference(shapely.box(x0 - half, y0 - half, x1 + half, y1 + half))
    if grid_mm is not None:
        rows += grid_lines(metal, grid_mm)
        rows = taken_apart(rows, wide, kerf_mm)
    lines = as_scrap(Curve.of(row, closed=False) for row in rows)
    return replace(nest, scrap=lines, drawn=nest.drawn or nest) if lines else nest


@kept_with_nest(most=8)
def remnant_of(nest: Nest, kerf_mm: float, side: Side) -> Remnant:
    """The largest rectangle of unused sheet along a side.

    Raises
    ------
    InputError
        If the sheet is no rectangle, or the rectangle would have a side under 50 mm.
    """
    x0, y0, x1, y1 = nest.sheet.bounds
    if abs(nest.sheet.polygon.area - (x1 - x0) * (y1 - y0)) > kerf_mm:
        raise InputError(
            f"cuts.scrap.remnant: {side} saves a rectangle of a rectangular sheet, and this sheet is none",
            file=nest.file or None,
        )
    apart_mm = kerf_mm + _CLEAR_MM
    outlines = [part.outer.polygon for part in nest.parts]
    pieces = pieces_of(carrying(skeleton(nest.sheet.polygon, outlines, apart_mm), kerf_mm), kerf_mm)
    gone = [outline.bounds for outline in outlines]
    blocks = [(a - apart_mm, b - apart_mm, c + apart_mm, d + apart_mm) for a, b, c, d in gone]
    blocks += [piece.bounds for k, piece in enumerate(pieces.tolist()) if k != largest(pieces)]
    found = saved((x0, y0, x1, y1), blocks, side, kerf_mm / 2)
    remnant = Remnant(*found)
    width, height = remnant.size_mm
    if min(width, height) < LEAST_MM:
        raise InputError(
            f"cuts.scrap.remnant: {side} leaves nothing to save: the largest unused rectangle there is "
            f"{max(width, 0.0):.0f} × {max(height, 0.0):.0f} mm, and one with a side under {LEAST_MM:g} mm is not kept",
            file=nest.file or None,
        )
    return remnant


def _largest(metal: shapely.Geometry, kerf_mm: float) -> shapely.Geometry:
    """The largest piece of a skeleton: others come loose with the parts."""
    pieces = pieces_of(metal, kerf_mm)
    return pieces[largest(pieces)] if len(pieces) else shapely.Polygon()
