"""A layer of the sweep by whole arrays: number for number what `kernels.sweep` says compiled, where states are few."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Bools, Floats, Int16s, Ints
from kerfwise.encoder.ranges import laid_out
from kerfwise.models.problem.bits import Masks, bits_of

from .kernels import Costs, MoveTable
from .local import HARD, StepTerms
from .rest_bound import RestBound

AT_ONCE = 1 << 18
"""Additions that are done together: what they take fits in a cache."""


def sweep_by_arrays(
    moves: MoveTable,
    terms: StepTerms,
    rest: RestBound,
    first: Ints,
    limit: int,
    never: int,
    masks: Masks,
    ideal_entry: Ints,
    last: Int16s,
    begin: Ints,
    values: Costs,
    alive: Ints,
    entry_from: Ints,
    contour: Int16s,
    place: Ints,
    new_begin: Ints,
    new_values: Costs,
    living: NDArray[np.bool_],
    start: int,
    stop: int,
) -> None:
    """As `kernels.sweep`."""
    chosen = alive[start:stop]
    states = _states_of(moves, first, never, ideal_entry, last, begin, values)
    out = bits_of(masks[chosen], len(first) - 1)
    room = limit - _still_to_come(rest, out)
    entries = np.arange(entry_from[start], entry_from[stop])
    at = np.repeat(np.arange(len(chosen)), np.diff(entry_from[start : stop + 1]))
    order = np.argsort(contour[entries], kind="stable")
    ends = np.flatnonzero(np.diff(contour[entries[order]])) + 1
    for rows in np.split(order, ends) if len(order) else ():
        i = int(contour[entries[rows[0]]])
        columns = slice(int(first[i]), int(first[i + 1]))
        best = _least(moves, terms, masks, states, never, chosen[at[rows]], i, columns)
        total = best.astype(np.int64) + terms.site_cost[columns] + _asked(terms, out[at[rows]], i, columns)
        to_go = rest.to_go[_near_left(rest, out[at[rows]], i), columns]
        fits = total + to_go <= (room[at[rows]] + rest.price[i])[:, None]
        into = place[entries[rows]]
        living[into] = fits.any(axis=1)
        goes = new_begin[into][:, None] + np.arange(columns.stop - columns.start)
        new_values[goes] = np.where(fits, total, never)


class _States:
    """The states of a layer that cost less than `never`: those of set k are `set_from[k]` … `set_from[k + 1] - 1`.

    `have`, `row` and `owner` (s,) are what each costs, its row in the table of moves, and the contour it ends with.
    """

    def __init__(self, have: Costs, row: Ints, owner: Int16s, set_from: Ints) -> None:
        self.have, self.row, self.owner, self.set_from = have, row, owner, set_from


def _states_of(
    moves: MoveTable, first: Ints, never: int, ideal_entry: Ints, last: Int16s, begin: Ints, values: Costs
) -> _States:
    entry = np.repeat(np.arange(len(last)), np.diff(begin))
    row = moves.row_of[last[entry]] + np.arange(len(values)) - begin[entry]
    there = np.flatnonzero(values < never)
    return _States(values[there], row[there], last[entry[there]], np.searchsorted(there, begin[ideal_entry]))


def _least(
    moves: MoveTable, terms: StepTerms, masks: Masks, states: _States, never: int, sets: Ints, i: int, columns: slice
) -> Costs:
    """The least cost of going on from each of some sets to every site of contour i, (len(sets), sites)."""
    size = columns.stop - columns.start
    rows = (len(moves.table) - int(moves.base[-1])) // int(moves.pad[-1])
    whole = moves.table[moves.base[i] : moves.base[i] + rows * moves.pad[i]].reshape(rows, -1)
    block = np.ascontiguousarray(whole[:, :size])
    mask = moves.mask[:, columns] if len(moves.mask) else np.empty((rows, size, 0), dtype=np.uint64)
    crossed = [(w, np.ascontiguousarray(mask[:, :, w])) for w in range(mask.shape[2]) if mask[:, :, w].any()]
    begins, count = states.set_from[sets], states.set_from[sets + 1] - states.set_from[sets]
    best = np.full((len(sets), size), never, dtype=block.dtype)
    cuts = np.searchsorted(np.cumsum(count), np.arange(AT_ONCE // size, int(count.sum()), AT_ONCE // size))
    for some in np.split(np.flatnonzero(count), np.searchsorted(np.flatnonzero(count), cuts)):
        if not len(some):
            continue
        at, of = laid_out(begins[some], count[some]), np.repeat(sets[some], count[some])
        row = states.row[at]
        total = states.have.take(at)[:, None] + block.take(row, axis=0)
        if len(moves.mask) or len(terms.soft_cost):
            total = total.astype(np.int64)
            total += _leaving(terms, masks, of, states.owner[at], i)[:, None]
        for w, met in crossed:
            over = np.bitwise_count(met.take(row, axis=0) & masks[:, w].take(of)[:, None])
            total += over * np.int64(moves.price)
        least = np.minimum.reduceat(total, np.cumsum(count[some]) - count[some], axis=0)
        best[some] = np.minimum(least, never)
    return best


def _leaving(terms: StepTerms, masks: Masks, sets: Ints, owner: Int16s, i: int) -> Ints:
    """What leaving soft groups before they are whole costs, from every state; nothing on the way in."""
    cost = np.zeros(len(sets), dtype=np.int64)
    for g in np.flatnonzero(~terms.soft_has[:, i]):
        leaves = np.flatnonzero(terms.soft_has[g, owner] & (owner >= 0))
        unfinished = (terms.soft_mask[g] & ~masks[sets[leaves]]).any(axis=1)
        cost[leaves[unfinished]] += terms.soft_cost[g]
    return cost


def _still_to_come(rest: RestBound, out: Bools) -> Floats:
    """What contours that are not out still cost by their prices, added up in their order."""
    to_come = np.full(len(out), rest.later)
    for i, price in enumerate(rest.price):
        to_come += np.where(out[:, i], 0.0, price)
    return to_come


def _near_left(rest: RestBound, out: Bools, i: int) -> Ints:
    """Which neighbours of contour i are not out once it is, as bits."""
    free = np.zeros(len(out), dtype=np.int64)
    for b, other in enumerate(rest.near[i].tolist()):
        if other == -2:
            free |= 1 << b
        elif other >= 0 and other != i:
            free |= np.where(out[:, other], 0, 1 << b)
    return free


def _asked(terms: StepTerms, out: Bools, i: int, columns: slice) -> Ints:
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
