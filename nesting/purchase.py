"""Which sheets to buy: sets of them that cost less than the best layout's, by how full they would have to be."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from itertools import combinations_with_replacement

from .allot import Layout, Sheetful
from .room import usable
from .shapes import Shapes
from .wanted import Spacing, Wanted

_LAST = 4
"""So many of the last sheets that were bought are chosen anew; those before stay."""
_MOST_SHEETS, _MOST_SETS = 6, 20_000
_USUAL = 0.8
"""How full a sheet becomes, where no full one was seen."""
_TRIED = 0.06
"""A set that was tried in vain is as if it had to be fuller by so much."""


class Purchase:
    """Chooses, round by round, what is bought: a set that costs less, or once more what the best layout is on.

    Sheets are filled one after the other, and what looks best for one may leave a few parts for another sheet. So sets
    of sheets are tried as a whole: first those that would be about as full as the best layout's full sheets are.
    Counted is what parts take with half the gap around them, and what of a sheet they may take.
    """

    def __init__(self, wanted: Wanted, shapes: Shapes, spacing: Spacing) -> None:
        self._wanted = wanted
        self._taken_mm2 = [
            float(shapes.shape((kind, shapes.poses(kind)[0])).taken.area) for kind in range(len(wanted.types))
        ]
        self._ground_mm2 = [float(usable(stock.sheet, spacing).area) for stock in wanted.stocks]
        self._tries: Counter[tuple[int, ...]] = Counter()

    def next(self, best: Layout | None) -> tuple[int, ...]:
        """Numbers of stock to buy, in that order; none where each sheet is to be chosen by what it holds."""
        if best is None or any(best.missing):
            return ()
        bought = [sheet for sheet in best.sheets if not sheet.stock.remnant]
        before, last = [sheet.number for sheet in bought[:-_LAST]], bought[-_LAST:]
        if not last:
            return ()
        full = self._usual(bought)
        same = tuple(sheet.number for sheet in last)
        sets = {one: abs(fill - full) for one, fill in self._cheaper(before, last)} | {same: _TRIED}
        taken = min(sets, key=lambda one: (sets[one] + _TRIED * self._tries[one], one == same, one))
        self._tries[taken] += 1
        backwards = taken != same and self._tries[taken] % 2 == 0
        return (*before, *(reversed(taken) if backwards else taken))

    def _on(self, sheet: Sheetful) -> float:
        return sum(self._taken_mm2[one.kind] for one in sheet.placed)

    def _usual(self, bought: list[Sheetful]) -> float:
        """How full sheets become: all but the last one, which is as full as it happens to be."""
        shares = [self._on(sheet) / self._ground_mm2[sheet.number] for sheet in bought]
        full = shares[:-1] or [_USUAL]
        return max(sum(full) / len(full), shares[-1])

    def _cheaper(self, before: list[int], last: list[Sheetful]) -> Iterator[tuple[tuple[int, ...], float]]:
        """Sets that cost less than the last sheets, the largest sheets first, and how full they would be."""
        needed_mm2, worth = sum(map(self._on, last)), sum(sheet.stock.worth for sheet in last)
        stocks = self._wanted.stocks
        numbers = sorted(
            (k for k, stock in enumerate(stocks) if not stock.remnant), key=lambda k: (-self._ground_mm2[k], k)
        )
        used = Counter(before)
        for size in range(1, _MOST_SHEETS + 1):
            if math.comb(len(numbers) + size - 1, size) > _MOST_SETS:
                return
            for one in combinations_with_replacement(numbers, size):
                ground_mm2 = sum(self._ground_mm2[k] for k in one)
                if sum(stocks[k].worth for k in one) >= worth - 1e-6 or ground_mm2 < needed_mm2:
                    continue
                if all((limit := stocks[k].count) is None or used[k] + n <= limit for k, n in Counter(one).items()):
                    yield one, needed_mm2 / ground_mm2
