"""From which side of the sheet cutting starts (Petunin 2009, fig. 2)."""

from __future__ import annotations

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.encoder.cut import Side
from kerfwise.encoder.geometry.segment import Box

from .facts import SIDES, Because, FactOptions
from .outlines import ROUNDING_MM, SAME_SHARE
from .sides import OPPOSITE, narrow_sides


def start_side(
    sheet_mm: Box,
    options: FactOptions,
    is_long: Bools,
    edge_gap_mm: Floats,
    offcut_large: Bools,
    heat_mm: Floats,
    heat_parts: Ints,
) -> tuple[Side, Because]:
    """The start side and what decided it; the first clause that tells the sides apart does.

    The profile may fix the side ("profile"). Else only the two narrow sides are eligible, and of these (b) the one
    with more long parts within `edge_band_mm` of it, so that they are cut before heat has gathered ("long-parts");
    (c) the one opposite a large offcut, which then stiffens the end ("offcut"); (d) the one with more cut length in
    its half, then more small parts ("heat"). If all are even, (a) the left or bottom one ("narrow-side"). Cut lengths
    that differ by less than a millionth are even.
    """
    if options.start_side != "auto":
        return options.start_side, "profile"
    one, other = narrow_sides(sheet_mm)
    a, b = SIDES.index(one), SIDES.index(other)

    near = (edge_gap_mm[is_long] <= options.edge_band_mm + ROUNDING_MM).sum(axis=0)
    if near[a] != near[b]:
        return (one if near[a] > near[b] else other), "long-parts"
    if offcut_large[a] != offcut_large[b]:
        return OPPOSITE[one if offcut_large[a] else other], "offcut"
    if abs(heat_mm[a] - heat_mm[b]) > SAME_SHARE * max(heat_mm[a], heat_mm[b]):
        return (one if heat_mm[a] > heat_mm[b] else other), "heat"
    if heat_parts[a] != heat_parts[b]:
        return (one if heat_parts[a] > heat_parts[b] else other), "heat"
    return one, "narrow-side"
