"""What is to be nested, and on what: part types with quantities, sheets and remnants."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal, get_args

from kerfwise.encoder.nest import Part, Sheet

from .nofit import Pose

QUARTERS = (0.0, 90.0, 180.0, 270.0)
Grain = Literal["along", "across"]
GRAINS: tuple[Grain, ...] = get_args(Grain)


@dataclass(frozen=True, eq=False)
class PartType:
    """A part, and how often it is wanted.

    Parameters
    ----------
    name
        What its copies are called: `name-1`, `name-2`…
    part
        Its geometry, mm, as it is drawn.
    quantity
        Copies that are wanted, at least 1.
    priority
        Those of lower numbers are placed first.
    order
        The order that it is for.
    turns_deg
        How it may be turned, degrees.
    free
        Whether any other turn will do, too: then `turns_deg` are those that are tried.
    mirror
        Whether it may be turned over.
    file
        The file that it was read from.
    held
        Whether tabs of the plant hold it, so that its edges are not cut once.
    material, thickness_mm
        The sheet that it is cut from, where the order says it.
    due
        The day on which it has to be ready, ISO 8601, where the order says it.
    """

    name: str
    part: Part
    quantity: int
    priority: int = 1
    order: str = ""
    turns_deg: tuple[float, ...] = QUARTERS
    mirror: bool = False
    file: str = ""
    free: bool = False
    held: bool = False
    material: str = ""
    thickness_mm: float | None = None
    due: str = ""

    @property
    def area_mm2(self) -> float:
        """Metal of one copy."""
        return float(self.part.polygon.area)

    @property
    def poses(self) -> tuple[Pose, ...]:
        """Every way it may lie, the drawn one first."""
        return tuple(
            Pose(turn, flip) for flip in ((False, True) if self.mirror else (False,)) for turn in self.turns_deg
        )


def turns_along(grain: Grain, turns_deg: Sequence[float]) -> tuple[float, ...]:
    """Those turns that keep the grain: along the sheet's x axis where it is drawn along it, or across it.

    Examples
    --------
    >>> turns_along("along", QUARTERS), turns_along("across", QUARTERS)
    ((0.0, 180.0), (90.0, 270.0))
    """
    off = 0.0 if grain == "along" else 90.0
    return tuple(turn for turn in turns_deg if (turn - off) % 180.0 == 0.0)


@dataclass(frozen=True, eq=False)
class Stock:
    """A sheet or a remnant that parts can be cut from: `count` of them, None where there is no end of them."""

    name: str
    sheet: Sheet
    count: int | None = None
    price: float | None = None
    remnant: bool = False
    material: str = ""
    thickness_mm: float | None = None

    @property
    def area_mm2(self) -> float:
        """Metal of one of them."""
        return float(self.sheet.polygon.area)

    @property
    def worth(self) -> float:
        """Its price where it has one, else its area: what sheets are compared by."""
        return self.area_mm2 if self.price is None else self.price


@dataclass(frozen=True, slots=True)
class Common:
    """How far straight edges lie apart that are cut once, mm, within a tolerance, and how long one is at least."""

    apart_mm: float
    shortest_mm: float
    tolerance_mm: float = 0.05


@dataclass(frozen=True, slots=True)
class Spacing:
    """How far parts lie from each other, and from the edge of the sheet, mm: outline to outline, at least.

    Parts with a common edge are nearer, where `common` says how near.
    """

    gap_mm: float
    edge_mm: float
    common: Common | None = None


@dataclass(frozen=True, eq=False)
class Demand:
    """The whole order: part types, and stock in the order of the list."""

    types: tuple[PartType, ...]
    stocks: tuple[Stock, ...] = field(default=())

    @property
    def area_mm2(self) -> float:
        """Metal of all parts."""
        return sum(kind.area_mm2 * kind.quantity for kind in self.types)
