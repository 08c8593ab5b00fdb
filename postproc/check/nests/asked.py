"""What a set of nests is held against: parts as they were drawn, sheets as they lie in the store, distances."""

from __future__ import annotations

from dataclasses import dataclass

from kerfwise.encoder.nest import Part, Sheet


@dataclass(frozen=True, eq=False, slots=True)
class AskedPart:
    """A part as it is drawn, how many may be cut at most, and how it may lie; `count` is how many were promised.

    `turns_deg` is None where any turn will do.
    """

    name: str
    part: Part
    quantity: int
    turns_deg: tuple[float, ...] | None
    mirror: bool = False
    count: int | None = None


@dataclass(frozen=True, eq=False, slots=True)
class AskedSheet:
    """A sheet or remnant, and how many there are; None where there is no end of them."""

    name: str
    sheet: Sheet
    count: int | None = None


@dataclass(frozen=True, slots=True)
class AskedCommon:
    """Edges that are cut once: so far apart, within a tolerance, and so long at least, mm."""

    apart_mm: float
    shortest_mm: float
    tolerance_mm: float


@dataclass(frozen=True, slots=True)
class AskedSpacing:
    """Least distances in mm: part to part, and part to the edge of the sheet; nearer are parts with a common edge."""

    gap_mm: float
    edge_mm: float
    common: AskedCommon | None = None
