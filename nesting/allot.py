"""Which parts go on which sheets: remnants first, then sheet by sheet the one that its parts use best."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import shapely

from .fill import Going, Taste, by_size, fill
from .left_over import largest_rectangle
from .pose import Placed
from .room import Room
from .shapes import Shapes
from .wanted import Spacing, Stock, Wanted


@dataclass(frozen=True, eq=False)
class Sheetful:
    """One sheet, of the stock of that number in the list, and what lies on it."""

    stock: Stock
    number: int
    placed: tuple[Placed, ...]

    def metal_mm2(self, wanted: Wanted) -> float:
        """Metal of the parts on it."""
        return sum(wanted.types[one.kind].area_mm2 for one in self.placed)


def laid_anew(
    sheet: Sheetful, placed: Iterable[Placed], shapes: Shapes, spacing: Spacing, tastes: Iterable[Taste]
) -> Sheetful | None:
    """The sheet with as many parts of each type as in `placed`, laid by the first taste that has room for all; or None.

    How they lay does not matter.
    """
    left = Counter(one.kind for one in placed)
    for taste in tastes:
        room = Room(shapes, sheet.stock.sheet, spacing)
        laid = fill(room, by_size(shapes, sorted(left)), left, taste, every=True)
        if len(laid) == left.total():
            return replace(sheet, placed=tuple(laid))
    return None


@dataclass(frozen=True, eq=False)
class Layout:
    """All sheets, in the order in which they were filled; `by` says what laid them so."""

    wanted: Wanted
    spacing: Spacing
    sheets: tuple[Sheetful, ...]
    by: str = ""

    @cached_property
    def missing(self) -> tuple[int, ...]:
        """How many of each part type are on no sheet."""
        laid = [one.kind for sheet in self.sheets for one in sheet.placed]
        return tuple(kind.quantity - laid.count(k) for k, kind in enumerate(self.wanted.types))

    @cached_property
    def score(self) -> tuple[float, float, float]:
        """The less the better: metal of parts that are missing, worth of the sheets, less what is left of the last."""
        missing_mm2 = sum(
            n * kind.area_mm2 * 2.0 ** (1 - min(kind.priority, 50))
            for n, kind in zip(self.missing, self.wanted.types, strict=True)
        )
        worth = sum(sheet.stock.worth for sheet in self.sheets if not sheet.stock.remnant)
        return round(missing_mm2, 3), round(worth, 3), -round(self.remnant_mm2, 3)

    @property
    def alike(self) -> tuple[object, ...]:
        """What two layouts have in common that are the same."""
        return tuple((sheet.number, frozenset(sheet.placed)) for sheet in self.sheets)

    @cached_property
    def remnant_mm2(self) -> float:
        """The largest rectangle that is left of the last sheet."""
        if not self.sheets:
            return 0.0
        last = self.sheets[-1]
        x0, y0, x1, y1 = largest_rectangle(last.stock.sheet, self.metal_of(last), self.spacing.gap_mm)
        return (x1 - x0) * (y1 - y0)

    def metal_of(self, sheet: Sheetful) -> list[shapely.Geometry]:
        """The parts on a sheet, as areas."""
        return [one.area(self.wanted.types[one.kind].part.polygon) for one in sheet.placed]


def allot(
    wanted: Wanted,
    shapes: Shapes,
    spacing: Spacing,
    order: Sequence[int],
    taste: Taste,
    going: Going = lambda: True,
    left: Mapping[int, int] | None = None,
    gone: Mapping[int, int] | None = None,
    buy: Sequence[int] = (),
    seen: Callable[[Sheetful], None] = lambda sheet: None,
) -> Layout:
    """Fill sheet after sheet until every part lies on one, no stock is left, or what is left fits on none.

    `order` are the part types as they are laid, one after the other; `left` says how many of them are, all where it is
    not given, and `gone` how many sheets of each stock are used already. `buy` are numbers of stock that come
    next after the remnants, in that order; only then sheets are chosen by what they hold. `seen` is told each sheet
    that was filled, whether it is taken or not.
    """
    left = {kind: wanted.types[kind].quantity if left is None else left[kind] for kind in order}
    used = [(gone or {}).get(number, 0) for number in range(len(wanted.stocks))]
    sheets: list[Sheetful] = []
    bought = list(buy)
    while any(left.values()) and going():
        best: Sheetful | None = None
        for number in _next(wanted, used, bought[:1]):
            stock = wanted.stocks[number]
            room = Room(shapes, stock.sheet, spacing)
            placed = fill(room, order, left, taste, going)
            full = Sheetful(stock, number, tuple(placed))
            if placed:
                seen(full)
            if placed and (best is None or _better(full, best, wanted)):
                best = full
            if stock.remnant and placed:
                break
        if bought and (best is None or not best.stock.remnant):
            bought.pop(0)
        elif best is None:
            break
        if best is None:
            continue
        sheets.append(best)
        used[best.number] += 1
        for one in best.placed:
            left[one.kind] -= 1
    return Layout(wanted, spacing, tuple(sheets))


def _next(wanted: Wanted, used: Sequence[int], bought: Sequence[int]) -> list[int]:
    """The stock that may be taken next, by number: remnants first, the smallest first; of the rest, what is bought."""
    there = [
        k
        for k, stock in enumerate(wanted.stocks)
        if (stock.count is None or used[k] < stock.count) and (stock.remnant or not bought or k in bought)
    ]
    return sorted(there, key=lambda k: (not wanted.stocks[k].remnant, wanted.stocks[k].area_mm2, k))


def _better(one: Sheetful, other: Sheetful, wanted: Wanted) -> bool:
    """Whether a sheet gives more metal of parts for what it is worth; all alike, the larger."""
    mine, its = (full.metal_mm2(wanted) / max(full.stock.worth, 1e-9) for full in (one, other))
    return mine > its * (1 + 1e-9) or (mine > its * (1 - 1e-9) and one.stock.area_mm2 > other.stock.area_mm2)
