"""The inner loops of the sweep over ideals, compiled by numba; they run without the GIL, so that threads share a layer.

An *entry* is an ideal (a set that the orders allow to be cut first) together with the contour that was cut last in it;
its states are that contour's sites. Values are whole µm in the narrowest integers that hold the most that a plan
worth finding costs; `never` stands for all that costs more, and twice as much still fits.

Moves may have two costs: what they cost, and a *low*, what the multipliers of a linear program leave of that. The least
of either to a state may come by different ways. A state is dropped where one of them is too much.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Bools, Floats, Int16s, Int32s, Ints
from kerfwise.models.jit import KERNEL, inner, jit
from kerfwise.models.problem.bitsets import Masks, has, missing

from .stretch import (
    HARD,
    CrossingAlternatives,
    RestBound,
    StepTerms,
    crossing_extra_cost,
    near_left,
    still_to_come,
)

Costs = NDArray[Any]  # int32 or int64
TOGETHER = 4
"""Rows of moves that are added and compared at once."""


class MoveTable(NamedTuple):
    """What moves cost, a block of rows for every contour that they lead to.

    The move from row r to site d of contour i costs `table[base[i] + r * pad[i] + d]`; blocks are padded to `pad[i]`
    columns with `never`. Rows of contour j's sites start at `row_of[j]`, those of the ways in at `row_of[-1]`.
    """

    table: Costs
    base: Ints
    pad: Ints
    row_of: Ints


class Steps(NamedTuple):
    """What steps from one layer to the next cost, and what plans still cost after them (`rest`).

    Sites of contour i are the columns `first[i]` … `first[i + 1] - 1`. `low_moves` are what multipliers leave of
    `moves`, if anything, and `rest` is of that then. `over` is what moves cost more for what is out: both pay it.
    `limit` is the most that a plan worth finding costs.
    """

    moves: MoveTable
    low_moves: MoveTable
    over: CrossingAlternatives
    terms: StepTerms
    rest: RestBound
    first: Ints
    limit: int
    never: int


class LayerFrom(NamedTuple):
    """The layer that steps begin at: its sets, their entries, and the states of these from `begin` on (see `arrange`).

    `lows` are the sums of `low_moves` to every state, empty where moves have one cost.
    """

    masks: Masks
    ideal_entry: Ints
    contour: Int16s
    begin: Ints
    values: Costs
    lows: Costs


class LayerTo(NamedTuple):
    """The layer that steps lead to, from the sets `alive`: `values`, `lows` and `living` are written.

    Entries of `alive[a]` are `entry_from[a]` … `entry_from[a + 1] - 1`, each with its contour and its place among those
    that are sorted by set; `living` says which have a state that is not dropped.
    """

    alive: Ints
    entry_from: Ints
    contour: Int16s
    place: Ints
    begin: Ints
    values: Costs
    lows: Costs
    living: Bools


class Arranged(NamedTuple):
    """Entries sorted by the set that they lead to.

    Where the entries of every set begin, contour and source (a row of the layer before) of the entries, and for every
    entry as it was given its place and where its states begin.
    """

    ideal_entry: Ints
    contour: Int16s
    source: Int32s
    place: Ints
    begin: Ints


def room_to_arrange(entries: int, sets: int) -> Arranged:
    """What `arrange` writes to."""
    contour, source = np.empty(entries, np.int16), np.empty(entries, np.int32)
    return Arranged(
        np.zeros(sets + 1, np.int64), contour, source, np.empty(entries, np.int64), np.zeros(entries + 1, np.int64)
    )


@jit(**KERNEL)
def arrange(  # pragma: no cover - compiled
    contour: Int16s, target: Int32s, entry_from: Ints, alive: Ints, size: Ints, made: Arranged
) -> None:
    """Sort entries by the set that they lead to."""
    first, begin = made.ideal_entry, made.begin
    for e in range(len(made.place)):
        first[target[e]] += 1
    for t in range(1, len(first)):
        first[t] += first[t - 1]
    for a in range(len(alive) - 1, -1, -1):  # from behind, so that each set's entries keep their order
        for e in range(entry_from[a + 1] - 1, entry_from[a] - 1, -1):
            first[target[e]] -= 1
            p = first[target[e]]
            made.place[e], made.contour[p], made.source[p] = p, contour[e], alive[a]
    for p in range(len(made.place)):
        begin[p + 1] = begin[p] + size[made.contour[p]]


class Room(NamedTuple):
    """Room for a set's states: their values, lows, rows of moves and contours; and for the least to each site.

    Of `lows` and `lowest` there is none where moves have one cost.
    """

    have: Costs
    lows: Costs
    row: Ints
    owner: Ints
    best: Costs
    lowest: Costs


def room_for(moves: MoveTable, came: LayerFrom, most_states: int) -> Room:
    """Room for a thread that sweeps sets of so many states at the most."""
    rows, columns, two = most_states + TOGETHER, int(moves.pad.max(initial=0)), len(came.lows) > 0
    have, best = (np.empty(size, came.values.dtype) for size in (rows, columns))
    lows, lowest = (np.empty(size * two, came.values.dtype) for size in (rows, columns))
    return Room(have, lows, np.empty(rows, np.int64), np.empty(rows, np.int64), best, lowest)


@jit(**KERNEL)
def sweep(  # pragma: no cover - compiled
    steps: Steps, came: LayerFrom, goes: LayerTo, room: Room, start: int, stop: int
) -> None:
    """The least cost to every state that grows from the sets `alive[start:stop]`.

    What is dearer than `limit`, less what is still to come, becomes `never`.
    """
    rest, terms, two = steps.rest, steps.terms, len(came.lows) > 0
    slowly = len(steps.over.extra) > 0 or len(terms.soft_cost) > 0
    for a in range(start, stop):
        k = goes.alive[a]
        mask = came.masks[k]
        count = _gather(steps, came, room, k)
        to_come = still_to_come(rest, mask)
        for e in range(goes.entry_from[a], goes.entry_from[a + 1]):
            i = int(np.int64(goes.contour[e]))
            place = goes.place[e]
            to_go = rest.to_go[near_left(rest, mask, i)]
            most = steps.limit - to_come + rest.price[i]
            if two:
                _least_of(steps.low_moves, i, room.lows, room.row, count, steps.never, room.lowest)
                if not _any_fits(steps, i, room.lowest, to_go, most):
                    _drop(steps, i, goes, place)
                    continue
            if slowly:
                _least_of_each(steps, mask, i, room, count)
            else:
                _least_of(steps.moves, i, room.have, room.row, count, steps.never, room.best)
            if two:
                _keep_both(steps, mask, i, room, to_go, most, goes, place)
            else:
                _keep(steps, mask, i, room.best, to_go, most, goes, place)


@inner(**KERNEL)
def _gather(steps: Steps, came: LayerFrom, room: Room, k: int) -> int:  # pragma: no cover - compiled
    """Write the states of set k that are worth it into the room, filled up to a multiple of `TOGETHER`; how many."""
    two, count = len(came.lows) > 0, 0
    for s in range(came.ideal_entry[k], came.ideal_entry[k + 1]):
        j = came.contour[s]
        for q in range(came.begin[s], came.begin[s + 1]):
            if came.values[q] < steps.never:
                room.have[count], room.owner[count] = came.values[q], j
                room.row[count] = steps.moves.row_of[j] + q - came.begin[s]
                if two:
                    room.lows[count] = came.lows[q]
                count += 1
    while count % TOGETHER:
        room.have[count], room.row[count], room.owner[count] = steps.never, room.row[0], room.owner[0]
        if two:
            room.lows[count] = steps.never
        count += 1
    return count


@jit(nogil=True)
def promises(steps: Steps, came: LayerFrom, goes: LayerTo) -> Floats:  # pragma: no cover - compiled
    """What a plan by every state of a layer costs at least; infinite for those that are dropped."""
    rest, first = steps.rest, steps.first
    found = np.full(len(goes.values), np.inf)
    for a in range(len(goes.alive)):
        mask = came.masks[goes.alive[a]]
        to_come = still_to_come(rest, mask)
        for e in range(goes.entry_from[a], goes.entry_from[a + 1]):
            i = int(np.int64(goes.contour[e]))
            at, free = goes.begin[goes.place[e]], near_left(rest, mask, i)
            for d in range(first[i + 1] - first[i]):
                if goes.values[at + d] < steps.never:
                    onward = rest.to_go[free, first[i] + d] + to_come - rest.price[i]
                    found[at + d] = goes.values[at + d] + onward
    return found


# Places are unsigned, and numbers as narrow as their arrays, so that loops over sites are done in vectors.


@inner(**KERNEL)
def _span(steps: Steps, i: int) -> tuple[np.uint64, np.uint64]:  # pragma: no cover - compiled
    """The first column of contour i, and how many it has."""
    return np.uint64(steps.first[i]), np.uint64(steps.first[i + 1] - steps.first[i])


@inner(**KERNEL)
def _any_fits(steps: Steps, i: int, lowest: Costs, to_go: Floats, most: float) -> bool:  # pragma: no cover - compiled
    """Whether any site may be reached without too much by the lows."""
    column, size = _span(steps, i)
    count = 0
    for d in range(size):
        count += lowest[d] + to_go[column + d] <= most
    return count > 0


@inner(**KERNEL)
def _drop(steps: Steps, i: int, goes: LayerTo, place: int) -> None:  # pragma: no cover - compiled
    """No state of an entry is worth keeping."""
    at, (_, size) = np.uint64(goes.begin[place]), _span(steps, i)
    for d in range(size):
        goes.values[at + d] = goes.lows[at + d] = steps.never
    goes.living[place] = False


@inner(**KERNEL)
def _keep_both(  # pragma: no cover - compiled
    steps: Steps, mask: Masks, i: int, room: Room, to_go: Floats, most: float, goes: LayerTo, place: int
) -> None:
    """Store both costs where neither is too much, and whether there is any such site."""
    at, (column, size) = np.uint64(goes.begin[place]), _span(steps, i)
    lives = False
    for d in range(size):
        site = np.int64(column + d)
        total = room.best[d] + steps.terms.site_cost[site] + conditions_cost(steps.terms, mask, i, site)
        if total <= steps.limit and room.lowest[d] + to_go[site] <= most:
            goes.values[at + d], goes.lows[at + d] = total, room.lowest[d]
            lives = True
        else:
            goes.values[at + d] = goes.lows[at + d] = steps.never
    goes.living[place] = lives


@inner(**KERNEL)
def _keep(  # pragma: no cover - compiled
    steps: Steps, mask: Masks, i: int, best: Costs, to_go: Floats, most: float, goes: LayerTo, place: int
) -> None:
    """Store what is not too dear, and whether there is any."""
    at, (column, size) = np.uint64(goes.begin[place]), _span(steps, i)
    terms, never, values, count = steps.terms, steps.never, goes.values, 0
    if terms.cond_of[i] < terms.cond_of[i + 1]:
        for d in range(size):
            total = best[d] + terms.site_cost[column + d] + conditions_cost(terms, mask, i, np.int64(column + d))
            fits = total + to_go[column + d] <= most
            values[at + d] = total if fits else never
            count += fits
    else:
        for d in range(size):
            total = best[d] + terms.site_cost[column + d]
            fits = total + to_go[column + d] <= most
            values[at + d] = total if fits else never
            count += fits
    goes.living[place] = count > 0


@inner(**KERNEL)
def _least_of(  # pragma: no cover - compiled
    moves: MoveTable, i: int, have: Costs, row: Ints, count: int, never: int, best: Costs
) -> None:
    """The least cost to every site of a contour."""
    table, base, pad = moves.table, moves.base[i], moves.pad[i]
    for d in range(pad):
        best[d] = never
    for x in range(0, count, TOGETHER):
        h0, h1, h2, h3 = have[x], have[x + 1], have[x + 2], have[x + 3]
        r0, r1 = np.uint64(base + row[x] * pad), np.uint64(base + row[x + 1] * pad)
        r2, r3 = np.uint64(base + row[x + 2] * pad), np.uint64(base + row[x + 3] * pad)
        for d in range(np.uint64(pad)):
            one = min(best.dtype.type(h0 + table[r0 + d]), best.dtype.type(h1 + table[r1 + d]))
            two = min(best.dtype.type(h2 + table[r2 + d]), best.dtype.type(h3 + table[r3 + d]))
            best[d] = min(best[d], min(one, two))


@inner(**KERNEL)
def _least_of_each(steps: Steps, mask: Masks, i: int, room: Room, count: int) -> None:  # pragma: no cover - compiled
    """The same, of both costs, where moves cost more for what is out, or leave groups."""
    moves, low_moves, over, never = steps.moves, steps.low_moves, steps.over, steps.never
    best, lowest, start = room.best, room.lowest, steps.first[i]
    size, grouped = steps.first[i + 1] - start, len(steps.terms.soft_cost) > 0
    two, crossed = len(room.lows) > 0, len(over.extra) > 0
    best[:] = never
    lowest[:] = never
    for x in range(count):
        if room.have[x] >= never:
            continue
        value, row = np.int64(room.have[x]), room.row[x]
        if grouped and row >= moves.row_of[0]:
            value += leaving(steps.terms, mask, room.owner[x], i)
        at, low_at = moves.base[i] + row * moves.pad[i], low_moves.base[i] + row * low_moves.pad[i]
        for d in range(size):
            cost = value + moves.table[at + d]
            least = np.int64(room.lows[x]) + low_moves.table[low_at + d] if two else np.int64(0)
            if cost >= never or least >= never or (cost >= best[d] and (not two or least >= lowest[d])):
                continue
            more = np.int64(crossing_extra_cost(over, mask, row, start + d)) if crossed else np.int64(0)
            best[d] = min(np.int64(best[d]), cost + more)
            if two:
                lowest[d] = min(np.int64(lowest[d]), least + more)


@inner(**KERNEL)
def leaving(terms: StepTerms, mask: Masks, j: int, i: int) -> int:  # pragma: no cover - compiled
    """What leaving soft groups before they are whole costs when contour i follows j, and `mask` is out."""
    cost = 0
    for g in range(len(terms.soft_cost)):
        if terms.soft_has[g, j] and not terms.soft_has[g, i] and missing(terms.soft_mask[g], mask):
            cost += terms.soft_cost[g]
    return cost


@inner(**KERNEL)
def conditions_cost(terms: StepTerms, mask: Masks, i: int, column: np.int64) -> int:  # pragma: no cover - compiled
    """What the conditions make cutting contour i at a site cost when a set is out."""
    cost = 0
    for q in range(terms.cond_of[i], terms.cond_of[i + 1]):
        if terms.cond_site[q] >= 0 and terms.cond_site[q] != column:
            continue
        total = 0
        for e in range(terms.cond_from[q], terms.cond_from[q + 1]):
            if has(mask, terms.cond_member[e]):
                total += terms.cond_weight[e]
        if total < terms.cond_bound[q]:
            if terms.cond_cost[q] == HARD:
                return HARD
            cost += terms.cond_cost[q]
    return cost
