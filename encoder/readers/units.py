"""Units of length that drawings come in."""

from __future__ import annotations

MM_PER = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4, "ft": 304.8}

DRAWN_MM = {**MM_PER, "px": 25.4 / 96}
"""What a drawing may have been read in: SVG without a unit counts pixels, 96 an inch."""

DXF_UNITS = {1: "in", 2: "ft", 4: "mm", 5: "cm", 6: "m"}
"""The values of the DXF header's $INSUNITS that a nest can be drawn in."""

SMALLEST_SHEET_MM, LARGEST_SHEET_MM = 20.0, 50_000.0
"""The longer side of any sheet one would cut lies between these."""


def doubt(width_mm: float, height_mm: float, units: str) -> str | None:
    """A sentence about a sheet size no plant would cut, or None where it is plausible.

    Parameters
    ----------
    width_mm, height_mm
        The sheet's extent as read.
    units
        The unit the file was read in.

    Examples
    --------
    >>> doubt(6000, 1500, "mm") is None
    True
    >>> doubt(6, 1.5, "mm")
    'the sheet is 6 × 1.5 mm, too small to be one: the file was read in mm; if that is wrong, pass units=m, in or ft'
    """
    extent = max(width_mm, height_mm)
    if SMALLEST_SHEET_MM <= extent <= LARGEST_SHEET_MM:
        return None
    drawn = extent / DRAWN_MM[units]
    fits = [u for u, mm in MM_PER.items() if u != units and SMALLEST_SHEET_MM <= drawn * mm <= LARGEST_SHEET_MM]
    named = " or ".join(filter(None, [", ".join(fits[:-1]), fits[-1]])) if fits else "the right one"
    size = "too small" if extent < SMALLEST_SHEET_MM else "too large"
    return (
        f"the sheet is {width_mm:g} × {height_mm:g} mm, {size} to be one: the file was read in {units}; "
        f"if that is wrong, pass units={named}"
    )
