"""Which layouts of sheets together hold all parts, and cost least: CP-SAT over all sheets that rounds have filled.

Gilmore and Gomory 1961: a pattern is a sheet that was filled, a column of a linear program whose rows are the part
types. Its dual values say what one more copy of each part is worth; sheets filled in that order are new columns.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import linprog

from kerfwise.arrays import Floats

from .allot import Layout, Sheetful, laid_anew
from .fill import LEFT, Going, Taste, by_size, fill
from .pose import Placed
from .room import Room
from .shapes import Shapes
from .wanted import Spacing, Wanted

_MOST = 3000
_WORK = 2.0
"""Deterministic time of CP-SAT for each cover."""
_PER_UNIT = 1000
"""Worth is counted in thousandths."""
_ANEW = (Taste(blocks=True), Taste(0.01, 1.0, blocks=True), LEFT)


class Patterns:
    """Sheets that were filled, each once by what lies on it."""

    def __init__(self, wanted: Wanted, shapes: Shapes, spacing: Spacing) -> None:
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
        order = sorted(by_size(self._shapes, range(len(worth))), key=lambda k: -round(worth[k], 12))
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
        made = self._moved_up(kept)
        layout = Layout(self._wanted, self._spacing, tuple(made))
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
        return laid_anew(sheet, placed, self._shapes, self._spacing, _ANEW)

    def _moved_up(self, sheets: list[Sheetful]) -> list[Sheetful]:
        """Parts of the last sheet moved to those before, where there is room."""
        if len(sheets) < 2:
            return sheets
        *before, last = sheets
        left = Counter(one.kind for one in last.placed)
        for k, sheet in enumerate(before):
            room = Room(self._shapes, sheet.stock.sheet, self._spacing)
            room.take(sheet.placed)
            if moved := fill(room, by_size(self._shapes, sorted(+left)), left, LEFT):
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
