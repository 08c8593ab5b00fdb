"""Rounds of filling sheets, each in another order and taste, combined to the sheets that cost least."""

from __future__ import annotations

import math
import random
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations_with_replacement
from typing import Literal, get_args

import numpy as np
from scipy.optimize import linprog

from kerfwise.arrays import Floats

from .demand import Demand, Spacing
from .fill import LEFT, PAVLOV, TASTES, Going, Room, Taste, fill, largest_first, usable
from .layout import Layout, Sheetful, allot, refill_sheet, squeeze_last_sheet
from .nofit import Placed
from .shapes import Shapes

Told = Callable[[int, Layout], bool]
"""Called after each round with its number and the best layout so far; whether to go on."""
Method = Literal["own", "pavlov"]
METHODS: tuple[Method, ...] = get_args(Method)
"""own: all tastes. pavlov: the least rectangle around all, and blocks by the defining line."""
_PRICED = 3
"""Every so many rounds, sheets are filled by what the cover of all patterns would pay for each part."""
_LOOK_SHARE = 0.8
"""Share of a limit in seconds that rounds have; the rest is for the cover, and for the last sheet."""


@dataclass(frozen=True, slots=True)
class Effort:
    """How long to look: so many rounds, or so many seconds where they are given; `seed` decides the random orders."""

    rounds: int = 12
    time_s: float | None = None
    seed: int = 1
    method: Method = "own"


def best_layout(wanted: Demand, spacing: Spacing, effort: Effort, told: Told = lambda n, best: True) -> Layout:
    """The best layout of all rounds: the same list, spacing, rounds and seed give the same one.

    A limit in seconds ends the look wherever it is; parts that are not laid then are missing.
    """
    return layouts(wanted, spacing, effort, told)[0]


def layouts(
    wanted: Demand,
    spacing: Spacing,
    effort: Effort,
    told: Told = lambda n, best: True,
    stopped: Callable[[], bool] = lambda: False,
) -> list[Layout]:
    """The layouts of all rounds, the best first, each once: see `best_layout`.

    Once `stopped`, a round breaks off: what lies there after a broken first round is told as it is, parts missing.
    """
    look = _Look(wanted, spacing, effort, stopped)
    for number, (order, taste) in enumerate(_ways(look.shapes, effort), 1):
        look.round(number, order, taste)
        if not told(number, look.best) or stopped() or look.over():
            break
    if not stopped():
        look.finish(effort.rounds)
    return sorted(look.found.values(), key=lambda layout: layout.score)


class _Look:
    """What was found so far."""

    def __init__(self, wanted: Demand, spacing: Spacing, effort: Effort, stopped: Callable[[], bool]) -> None:
        self.shapes = Shapes(wanted.types, spacing.gap_mm, spacing.common)
        self.found: dict[tuple[object, ...], Layout] = {}
        self._wanted, self._spacing, self._effort, self._stopped = wanted, spacing, effort, stopped
        now = time.monotonic()
        self._ends = None if effort.time_s is None else now + effort.time_s * _LOOK_SHARE
        self._last = None if effort.time_s is None else now + effort.time_s
        self._purchase = Purchase(wanted, self.shapes, spacing)
        self._patterns = Patterns(wanted, self.shapes, spacing)
        self._best: Layout | None = None

    @property
    def best(self) -> Layout:
        """The best layout so far; one with nothing laid before the first round."""
        return Layout(self._wanted, self._spacing, ()) if self._best is None else self._best

    def over(self) -> bool:
        """Whether the time is over."""
        return self._ends is not None and time.monotonic() >= self._ends

    def _going(self) -> bool:
        """Whether a round goes on: the first has the whole limit, the others leave some for what comes after them."""
        ends = self._last if self._best is None else self._ends
        return not self._stopped() and (ends is None or time.monotonic() < ends)

    def round(self, number: int, order: list[int], taste: Taste) -> None:
        """Fill sheets once, or fill those that the cover misses most."""
        if number % _PRICED == 0 and self._patterns.worth_pricing(self.best):
            self._patterns.price(taste, self._going)
            self._keep(self._patterns.cover(self.best, self._effort.seed), "patterns")
            return
        buy = self._purchase.next(self._best)
        seen = self._patterns.add
        layout = allot(self._wanted, self.shapes, self._spacing, order, taste, self._going, buy=buy, seen=seen)
        self._keep(layout, f"round {number}")

    def finish(self, tries: int) -> None:
        """Combine what all rounds laid, and lay the last sheet so that the largest rectangle is left."""

        def going() -> bool:
            return not self._stopped() and (self._last is None or time.monotonic() < self._last)

        self._keep(self._patterns.cover(self.best, self._effort.seed), "patterns")
        if self.shapes.common is None:  # blocks with common edges would break up where they are in the way
            self._keep(squeeze_last_sheet(self.best, self.shapes, tries, self._effort.seed, going), "squeezed")

    def _keep(self, layout: Layout, by: str) -> None:
        if layout.alike not in self.found:
            layout = replace(layout, by=by if self._effort.method == "own" else f"{self._effort.method}, {by}")
            self.found[layout.alike] = layout
            if self._best is None or layout.score < self._best.score:
                self._best = layout


def _ways(shapes: Shapes, effort: Effort) -> Iterator[tuple[list[int], Taste]]:
    """Orders and tastes: largest area first, longest first, then such orders shuffled a little."""
    kinds, chance = range(len(shapes.types)), random.Random(effort.seed)
    plain = largest_first(shapes, kinds)
    boxes = [shapes.types[k].part.outer.polygon.bounds for k in kinds]
    longest = [max(x1 - x0, y1 - y0) for x0, y0, x1, y1 in boxes]
    tastes: tuple[Taste, ...] = TASTES if effort.method == "own" else PAVLOV
    if shapes.common is not None:  # edges that can be cut once are to lie a kerf apart
        tastes = tuple(dict.fromkeys(replace(taste, blocks=True) for taste in tastes))
    rounds = effort.rounds if effort.time_s is None else 1_000_000
    for number in range(rounds):
        taste = tastes[number % len(tastes)]
        if number < len(tastes):
            yield plain, taste
        elif number < 2 * len(tastes):
            yield sorted(plain, key=lambda k: (shapes.types[k].priority, -longest[k], k)), taste
        else:
            weight = {k: (shapes.types[k].area_mm2 ** 0.5) * chance.uniform(0.6, 1.4) for k in plain}
            yield sorted(plain, key=lambda k: (shapes.types[k].priority, -weight[k], k)), taste


# Which layouts of sheets together hold all parts, and cost least: CP-SAT over all sheets that rounds have filled.
#
# Gilmore and Gomory 1961: a pattern is a sheet that was filled, a column of a linear program whose rows are the part
# types. Its dual values say what one more copy of each part is worth; sheets filled in that order are new columns.

_MOST = 3000
_WORK = 2.0
"""Deterministic time of CP-SAT for each cover."""
_PER_UNIT = 1000
"""Worth is counted in thousandths."""
_ANEW = (Taste(blocks=True), Taste(0.01, 1.0, blocks=True), LEFT)


class Patterns:
    """Sheets that were filled, each once by what lies on it."""

    def __init__(self, wanted: Demand, shapes: Shapes, spacing: Spacing) -> None:
        self._wanted, self._shapes, self._spacing = wanted, shapes, spacing
        self._found: dict[tuple[int, tuple[int, ...]], Sheetful] = {}
        self._covered = -1

    def add(self, sheet: Sheetful) -> None:
        """Remember a filled sheet."""
        if len(self._found) < _MOST:
            self._found.setdefault((sheet.number, self._counts(sheet)), sheet)

    def _counts(self, sheet: Sheetful) -> tuple[int, ...]:
        counts = Counter(one.kind for one in sheet.placed)
        return tuple(counts[k] for k in range(len(self._wanted.types)))

    def worth_pricing(self, best: Layout) -> bool:
        """Whether another choice of sheets could cost less: more than one is bought, or parts are missing."""
        return len(best.sheets) > 1 or any(best.missing)

    def price(self, taste: Taste, going: Going) -> None:
        """Fill one sheet of each stock with the parts that the linear program pays most for, by their area."""
        pays = self._duals()
        worth = {k: pays[k] / max(kind.area_mm2, 1e-9) for k, kind in enumerate(self._wanted.types)}
        order = sorted(largest_first(self._shapes, range(len(worth))), key=lambda k: -round(worth[k], 12))
        left = {k: kind.quantity for k, kind in enumerate(self._wanted.types)}
        for number, stock in enumerate(self._wanted.stocks):
            if not going():
                return
            placed = fill(Room(self._shapes, stock.sheet, self._spacing), order, left, taste, going)
            if placed:
                self.add(Sheetful(stock, number, tuple(placed)))

    def _duals(self) -> Floats:
        """What the linear program over all patterns pays for one more copy of each part."""
        sheets, wanted = list(self._found.values()), self._wanted
        counts = np.array([counted for _, counted in self._found], dtype=np.float64).T
        most = max(stock.worth for stock in wanted.stocks)
        alone = np.array([most * 2.0 for _ in wanted.types])  # a part that has no place costs more than any sheet
        cost = np.concatenate([[_worth(sheet) for sheet in sheets], alone])
        rows = np.hstack([counts, np.eye(len(wanted.types))])
        limits = [k for k, stock in enumerate(wanted.stocks) if stock.count is not None]
        used = np.array([[float(sheet.number == k) for sheet in sheets] + [0.0] * len(alone) for k in limits])
        needed = np.array([-float(kind.quantity) for kind in wanted.types])
        found = linprog(
            cost,
            A_ub=np.vstack([-rows, used]) if limits else -rows,
            b_ub=np.concatenate([needed, [float(wanted.stocks[k].count or 0) for k in limits]]),
            method="highs",
        )
        if not found.success:
            return np.zeros(len(wanted.types))
        duals: Floats = -np.asarray(found.ineqlin.marginals, dtype=np.float64)[: len(wanted.types)]
        return duals

    def cover(self, best: Layout, seed: int) -> Layout:
        """The cheapest choice of patterns that holds all parts, what is laid too often taken off; or `best`.

        Fewest parts missing first, then the worth of the sheets. Copies that are too many leave the sheet that holds
        least, and what lies there moves up to where they leave room.
        """
        if len(self._found) == self._covered or not self._found:
            return best
        self._covered = len(self._found)
        chosen = self._chosen(seed)
        if not chosen:
            return best
        kept = self._without_surplus(chosen)
        if kept is None:
            return best
        moved = self._moved_up(kept)
        layout = Layout(self._wanted, self._spacing, tuple(moved))
        return layout if layout.score < best.score else best

    def _chosen(self, seed: int) -> list[Sheetful]:
        from ortools.sat.python import cp_model  # loaded by those who have patterns only

        sheets, wanted, model = list(self._found.values()), self._wanted, cp_model.CpModel()
        total = sum(kind.quantity for kind in wanted.types)
        taken = [model.new_int_var(0, wanted.stocks[sheet.number].count or total, "") for sheet in sheets]
        missing = [model.new_int_var(0, kind.quantity, "") for kind in wanted.types]
        counts = [counted for _, counted in self._found]
        for k, kind in enumerate(wanted.types):
            laid = sum(counts[p][k] * taken[p] for p in range(len(sheets)) if counts[p][k])
            model.add(laid + missing[k] >= kind.quantity)
        for number, stock in enumerate(wanted.stocks):
            if stock.count is not None:
                model.add(sum(taken[p] for p, sheet in enumerate(sheets) if sheet.number == number) <= stock.count)
        lost = sum(
            round(kind.area_mm2 * 2.0 ** (1 - kind.priority)) * missing[k] + missing[k]
            for k, kind in enumerate(wanted.types)
        )
        worth = sum(round(_worth(sheet) * _PER_UNIT) * taken[p] for p, sheet in enumerate(sheets))
        solver = cp_model.CpSolver()
        solver.parameters.num_workers, solver.parameters.random_seed = 1, seed % 2**31
        solver.parameters.max_deterministic_time = _WORK
        solver.parameters.catch_sigint_signal = False  # else Ctrl-C is left to the system, which ends the command
        for goal in (lost, worth):
            model.minimize(goal)
            if solver.solve(model) not in (cp_model.OPTIMAL, cp_model.FEASIBLE):
                return []
            model.add(goal <= solver.value(goal))
            model.clear_hints()  # type: ignore[no-untyped-call]
            for variable in (*taken, *missing):
                model.add_hint(variable, solver.value(variable))
        return [sheet for p, sheet in enumerate(sheets) for _ in range(solver.value(taken[p]))]

    def _without_surplus(self, chosen: Sequence[Sheetful]) -> list[Sheetful] | None:
        """Sheets in the order in which they are told, the emptiest last, without copies that nobody wants.

        None where what stays on a sheet cannot be laid there.
        """
        ordered = sorted(
            chosen, key=lambda s: (not s.stock.remnant, -s.metal_mm2(self._wanted) / s.stock.area_mm2, s.number)
        )
        over = Counter(one.kind for sheet in ordered for one in sheet.placed)
        over.subtract({k: kind.quantity for k, kind in enumerate(self._wanted.types)})
        kept = []
        for sheet in reversed(ordered):
            placed = []
            for one in reversed(sheet.placed):
                if over[one.kind] > 0:
                    over[one.kind] -= 1
                else:
                    placed.append(one)
            if placed:
                fewer = self._with_fewer(sheet, placed[::-1])
                if fewer is None:
                    return None
                kept.append(fewer)
        return kept[::-1]

    def _with_fewer(self, sheet: Sheetful, placed: Sequence[Placed]) -> Sheetful | None:
        """A sheet with only these of its parts; laid anew where edges are cut once, or None where that fails.

        A block that lost a copy may hang together no more, and then its parts lie nearer than they may.
        """
        if self._shapes.common is None or len(placed) == len(sheet.placed):
            return replace(sheet, placed=tuple(placed))
        return refill_sheet(sheet, placed, self._shapes, self._spacing, _ANEW)

    def _moved_up(self, sheets: list[Sheetful]) -> list[Sheetful]:
        """Parts of the last sheet moved to those before, where there is room."""
        if len(sheets) < 2:
            return sheets
        *before, last = sheets
        left = Counter(one.kind for one in last.placed)
        for k, sheet in enumerate(before):
            room = Room(self._shapes, sheet.stock.sheet, self._spacing)
            room.take(sheet.placed)
            if moved := fill(room, largest_first(self._shapes, sorted(+left)), left, LEFT):
                before[k] = replace(sheet, placed=tuple(room.placed))
                left.subtract(one.kind for one in moved)
        stay = []
        for one in last.placed:
            if left[one.kind] > 0:
                left[one.kind] -= 1
                stay.append(one)
        if not stay:
            return before
        fewer = self._with_fewer(last, stay)
        return sheets if fewer is None else [*before, fewer]


def _worth(sheet: Sheetful) -> float:
    """What a sheet costs; remnants are there anyway."""
    return 0.0 if sheet.stock.remnant else sheet.stock.worth


# Which sheets to buy: sets of them that cost less than the best layout's, by how full they would have to be.

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

    def __init__(self, wanted: Demand, shapes: Shapes, spacing: Spacing) -> None:
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
