"""Units of length that drawings come in."""

from __future__ import annotations

import numpy as np

from kerfwise.encoder.nest import Note, Sheet

MM_PER = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4, "ft": 304.8}

DRAWN_MM = {**MM_PER, "px": 25.4 / 96}
"""What a drawing may have been read in: SVG without a unit counts pixels, 96 an inch."""

DXF_UNITS = {1: "in", 2: "ft", 4: "mm", 5: "cm", 6: "m"}
"""The values of the DXF header's $INSUNITS that a nest can be drawn in."""

SMALLEST_SHEET_MM, LARGEST_SHEET_MM = 20.0, 50_000.0
"""The longer side of any sheet one would cut lies between these."""


def doubts(sheet: Sheet, units: str) -> list[Note]:
    """A note on a sheet of a size that no plant would cut; nothing where it is plausible.

    Parameters
    ----------
    sheet
        The sheet as read.
    units
        What the file was read in.

    Examples
    --------
    >>> doubts(Sheet.rectangle(6000, 1500), "mm")
    []
    >>> doubts(Sheet.rectangle(60_000, 15_000), "mm")[0].text
    'the sheet is 60000 × 15000 mm, too large to be one: if mm is the wrong unit, pass the right units'
    """
    width, height = np.ptp(sheet.outline.flatten(), axis=0).tolist()
    extent = max(width, height)
    if SMALLEST_SHEET_MM <= extent <= LARGEST_SHEET_MM:
        return []
    drawn = extent / DRAWN_MM[units]
    fits = [u for u, mm in MM_PER.items() if u != units and SMALLEST_SHEET_MM <= drawn * mm <= LARGEST_SHEET_MM]
    named = (
        f"--units (in Python: units=) {' or '.join(filter(None, [', '.join(fits[:-1]), fits[-1]]))}"
        if fits
        else "the right units"
    )
    size = "too small" if extent < SMALLEST_SHEET_MM else "too large"
    text = f"the sheet is {width:g} × {height:g} mm, {size} to be one: if {units} is the wrong unit, pass {named}"
    return [Note("warning", text)]
