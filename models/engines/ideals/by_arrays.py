"""A layer of the sweep by whole arrays: number for number what `kernels` says compiled, where states are few."""

from __future__ import annotations

import numpy as np

from kerfwise.arrays import Bools, Floats, Int16s, Int32s, Ints, concat_ranges
from kerfwise.models.engines.tuning import SWEPT_AT_ONCE
from kerfwise.models.problem.bitsets import Masks, bits_of

from .kernels import Arranged, Costs, LayerFrom, LayerTo, Room, Steps
from .stretch import HARD, RestBound, StepTerms


def arrange_by_arrays(
    contour: Int16s, target: Int32s, entry_from: Ints, alive: Ints, size: Ints, made: Arranged
) -> None:
    """Entries sorted by the set that they lead to; see `kernels.arrange`."""
    order = np.argsort(target, kind="stable")
    made.place[order] = np.arange(len(order))
    made.contour[:], made.source[:] = contour[order], np.repeat(alive, np.diff(entry_from))[order]
    made.ideal_entry[1:] = np.cumsum(np.bincount(target, minlength=len(made.ideal_entry) - 1))
    made.begin[1:] = np.cumsum(size[made.contour])


def covers(terms: StepTerms, rest: RestBound) -> bool:
    """Whether no bound minds what lies near, and no group costs something when it is left."""
    return not rest.near.shape[1] and not len(terms.soft_cost)


def sweep_by_arrays(steps: Steps, came: LayerFrom, goes: LayerTo, room: Room, start: int, stop: int) -> None:
    """As `kernels.sweep`, where moves have one cost, and `covers` what is asked."""
    chosen, rest = goes.alive[start:stop], steps.rest
    states = _States(steps, came)
    out = bits_of(came.masks[chosen], len(steps.first) - 1)
    left = steps.limit - _still_to_come(rest, out)
    entries = np.arange(goes.entry_from[start], goes.entry_from[stop])
    at = np.repeat(np.arange(len(chosen)), np.diff(goes.entry_from[start : stop + 1]))
    order = np.argsort(goes.contour[entries], kind="stable")
    ends = np.flatnonzero(np.diff(goes.contour[entries[order]])) + 1
    for rows in np.split(order, ends) if len(order) else ():
        i = int(goes.contour[entries[rows[0]]])
        columns = slice(int(steps.first[i]), int(steps.first[i + 1]))
        total = states.least(chosen[at[rows]], i, columns).astype(np.int64) + steps.terms.site_cost[columns]
        total += _conditions_cost(steps.terms, out[at[rows]], i, columns)
        fits = total + rest.to_go[0, columns] <= (left[at[rows]] + rest.price[i])[:, None]
        into = goes.place[entries[rows]]
        goes.living[into] = fits.any(axis=1)
        there = goes.begin[into][:, None] + np.arange(columns.stop - columns.start)
        goes.values[there] = np.where(fits, total, steps.never)


class _States:
    """The states of a layer that are not dropped: what each costs, and its row in the table of moves."""

    def __init__(self, steps: Steps, came: LayerFrom) -> None:
        self.steps, self.came = steps, came
        entry = np.repeat(np.arange(len(came.contour)), np.diff(came.begin))
        row = steps.moves.row_of[came.contour[entry]] + np.arange(len(came.values)) - came.begin[entry]
        there = np.flatnonzero(came.values < steps.never)
        self.have, self.row = came.values[there], row[there]
        self.set_from = np.searchsorted(there, came.begin[came.ideal_entry])

    def least(self, sets: Ints, i: int, columns: slice) -> Costs:
        """The least cost of going on from each of some sets to every site of contour i, (len(sets), sites)."""
        moves, size = self.steps.moves, columns.stop - columns.start
        rows = len(moves.table) // int(moves.pad.sum())
        whole = moves.table[moves.base[i] : moves.base[i] + rows * moves.pad[i]].reshape(rows, -1)
        block = np.ascontiguousarray(whole[:, :size])
        begins, count = self.set_from[sets], self.set_from[sets + 1] - self.set_from[sets]
        best = np.full((len(sets), size), self.steps.never, dtype=block.dtype)
        crossed = self._crossed(rows, columns)
        some = np.flatnonzero(count)
        ends = np.cumsum(count[some])
        cuts = np.searchsorted(ends, np.arange(SWEPT_AT_ONCE // size, int(count.sum()), SWEPT_AT_ONCE // size))
        for part in np.split(some, cuts):
            if not len(part):
                continue
            at, of = concat_ranges(begins[part], count[part]), np.repeat(sets[part], count[part])
            row = self.row[at]
            total = self.have.take(at)[:, None] + block.take(row, axis=0)
            total = total.astype(np.int64) if crossed else total
            for price, w, met in crossed:
                total += price * np.bitwise_count(met.take(row, axis=0) & self.came.masks[:, w].take(of)[:, None])
            least = np.minimum.reduceat(total, np.cumsum(count[part]) - count[part], axis=0)
            best[part] = np.minimum(least, self.steps.never)
        return best

    def _crossed(self, rows: int, columns: slice) -> list[tuple[np.int64, int, Masks]]:
        """What moves to some columns cross of what costs a price, by words of sets, (rows, columns)."""
        over, width = self.steps.over, self.came.masks.shape[1]
        if not len(over.extra):
            return []
        begin = over.begin[:-1].reshape(rows, -1)[:, columns]
        there = over.begin[1:].reshape(rows, -1)[:, columns] > begin
        found = []
        for p, price in enumerate(over.prices):
            for w in range(width):
                met = np.zeros(begin.shape, dtype=np.uint64)
                met[there] = over.mask[begin[there], p * width + w]
                if met.any():
                    found.append((price, w, met))
        return found


def _still_to_come(rest: RestBound, out: Bools) -> Floats:
    """What contours that are not out still cost by their prices, added up in their order."""
    to_come = np.full(len(out), rest.later)
    for i, price in enumerate(rest.price):
        to_come += np.where(out[:, i], 0.0, price)
    return to_come


def _conditions_cost(terms: StepTerms, out: Bools, i: int, columns: slice) -> Ints:
    """What the conditions make cutting contour i at each of its sites cost."""
    cost = np.zeros((len(out), columns.stop - columns.start), dtype=np.int64)
    hard = np.zeros(cost.shape, dtype=np.bool_)
    for q in range(terms.cond_of[i], terms.cond_of[i + 1]):
        span = slice(terms.cond_from[q], terms.cond_from[q + 1])
        short = out[:, terms.cond_member[span]] @ terms.cond_weight[span] < terms.cond_bound[q]
        site = int(terms.cond_site[q]) - columns.start
        here = slice(None) if terms.cond_site[q] < 0 else slice(site, site + 1)
        if terms.cond_cost[q] == HARD:
            hard[:, here] |= short[:, None]
        else:
            cost[:, here] += np.where(short, terms.cond_cost[q], 0)[:, None]
    return np.where(hard, HARD, cost)
