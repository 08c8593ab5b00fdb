"""The boundaries of all outer contours, divided into short cells of equal length."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.ranges import laid_out

from .outlines import ROUNDING_MM, Outlines
from .sums import summed_by

SPACING_MM = 2.5
CELLS_MIN = 80
"""Where what is faced changes, a cell is off by half its length: too little to matter in a quarter of a contour."""


@dataclass(frozen=True, eq=False, slots=True)
class Cells:
    """k cells, contour after contour, each along its contour as drawn.

    `point` (k, 2) is the middle of a cell and `normal` (k, 2) the unit normal there, out of the part. A cell begins
    `from_mm` along its contour and is `length_mm` long: at most SPACING_MM, and no contour has less than CELLS_MIN.
    """

    contour: Ints
    point: Floats
    normal: Floats
    from_mm: Floats
    length_mm: Floats


def cells_of(outlines: Outlines) -> Cells:
    """The cells of every outer contour."""
    held = outlines.is_outer[outlines.chord_contour]
    start, end, of = outlines.chord_start[held], outlines.chord_end[held], outlines.chord_contour[held]
    step = end - start
    chord_mm = np.hypot(step[:, 0], step[:, 1])
    chord_from = np.cumsum(chord_mm) - chord_mm

    outers = outlines.outers
    length_mm = outlines.length_mm[outers]
    count = np.maximum(CELLS_MIN, np.ceil(length_mm / SPACING_MM)).astype(np.int64)
    number = laid_out(np.zeros_like(count), count)
    per_contour_mm = summed_by(of, chord_mm, outlines.n)[outers]
    contour_from = np.cumsum(per_contour_mm) - per_contour_mm
    middle = np.repeat(contour_from, count) + (number + 0.5) * np.repeat(per_contour_mm / count, count)

    tangent = step / np.where(chord_mm > 0, chord_mm, 1.0)[:, None]
    outwards = np.where(outlines.is_ccw[of], 1.0, -1.0)[:, None]
    normal = outwards * np.column_stack([tangent[:, 1], -tangent[:, 0]])
    # A middle on a corner looks along the normal of the chord that begins there.
    chord = np.searchsorted(chord_from, middle + ROUNDING_MM, side="right") - 1
    share = (middle - chord_from.take(chord)) / chord_mm.take(chord)
    cell_mm = np.repeat(length_mm / count, count)
    return Cells(
        contour=np.repeat(outers, count),
        point=start.take(chord, axis=0) + step.take(chord, axis=0) * share[:, None],
        normal=normal.take(chord, axis=0),
        from_mm=number * cell_mm,
        length_mm=cell_mm,
    )
