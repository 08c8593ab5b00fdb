"""The inner loops of the sweep over ideals, compiled by numba; they run without the GIL, so that threads share a layer.

An *entry* is an ideal (a set that the orders allow to be cut first) together with the contour that was cut last in it;
its states are that contour's sites. Values are whole µm in the narrowest integers that hold the most that a plan
worth finding costs; `never` stands for all that costs more, and twice as much still fits.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Floats, Int16s, Int32s, Ints
from kerfwise.models.kernels import inner, kept
from kerfwise.models.problem.bits import Masks, has, missing

from .local import HARD, StepTerms
from .rest_bound import RestBound, near_left, still_to_come

Costs = NDArray[Any]  # int32 or int64
TOGETHER = 4
"""Rows of moves that are added and compared at once."""


class MoveTable(NamedTuple):
    """What moves cost, a block of rows for every contour that they lead to.

    The move from row r to site d of contour i costs `table[base[i] + r * pad[i] + d]`; blocks are padded to `pad[i]`
    columns with `never`. Rows of contour j's sites start at `row_of[j]`, those of the ways in at `row_of[-1]`.
    `mask[r, c]` (with w words) are the contours of the stretch that the move from row r to column c crosses; each that
    is out costs `price`. It is (0, 0, w) where nothing is crossed.
    """

    table: Costs
    base: Ints
    pad: Ints
    row_of: Ints
    mask: Masks
    price: int


@kept(nogil=True)
def arrange(  # pragma: no cover - compiled
    contour: Int16s, target: Int32s, entry_from: Ints, alive: Ints, sets: int, size: Ints
) -> tuple[Ints, Int16s, Int32s, Ints, Ints]:
    """Sort entries by the set that they lead to.

    Returns where the entries of every set begin, contour and source (a row of the layer before) of the entries, and
    for every entry as it was given its place and where its states begin.
    """
    ideal_entry = np.zeros(sets + 1, np.int64)
    for e in range(entry_from[-1]):
        ideal_entry[target[e] + 1] += 1
    for t in range(sets):
        ideal_entry[t + 1] += ideal_entry[t]
    free = ideal_entry[:-1].copy()
    place = np.empty(entry_from[-1], np.int64)
    sorted_contour = np.empty(entry_from[-1], np.int16)
    source = np.empty(entry_from[-1], np.int32)
    for a in range(len(alive)):
        for e in range(entry_from[a], entry_from[a + 1]):
            p = free[target[e]]
            free[target[e]] += 1
            place[e], sorted_contour[p], source[p] = p, contour[e], alive[a]
    begin = np.empty(len(place) + 1, np.int64)
    begin[0] = 0
    for p in range(len(place)):
        begin[p + 1] = begin[p] + size[sorted_contour[p]]
    return ideal_entry, sorted_contour, source, place, begin


@inner(nogil=True)
def most_states(  # pragma: no cover - compiled
    ideal_entry: Ints, begin: Ints, alive: Ints, start: int, stop: int
) -> int:
    """The most states of a set of `alive[start:stop]`, and room to fill them up to a multiple of `TOGETHER`."""
    most = 0
    for a in range(start, stop):
        most = max(most, begin[ideal_entry[alive[a] + 1]] - begin[ideal_entry[alive[a]]])
    return most + TOGETHER


@inner(nogil=True)
def most_columns(moves: MoveTable) -> int:  # pragma: no cover - compiled
    """The most columns of the table that a contour has."""
    most = 0
    for pad in moves.pad:
        most = max(most, pad)
    return most


@kept(nogil=True)
def sweep(  # pragma: no cover - compiled
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
    """The least cost to every state that grows from the sets `alive[start:stop]`, into `new_values`.

    What is dearer than `limit`, less what is still to come, becomes `never`; `living` says which entries have any
    other. Entries and states of a set are as `arrange` and `sets.grow` left them.
    """
    rows = most_states(ideal_entry, begin, alive, start, stop)
    have = np.empty(rows, values.dtype)
    row = np.empty(rows, np.int64)
    owner = np.empty(rows, np.int64)
    best = np.empty(most_columns(moves), values.dtype)
    crossed, grouped = len(moves.mask) > 0, len(terms.soft_cost) > 0
    for a in range(start, stop):
        k = alive[a]
        count = 0
        for s in range(ideal_entry[k], ideal_entry[k + 1]):
            j = last[s]
            for q in range(begin[s], begin[s + 1]):
                if values[q] < never:
                    have[count], row[count], owner[count] = values[q], moves.row_of[j] + q - begin[s], j
                    count += 1
        while count % TOGETHER:
            have[count], row[count], owner[count] = never, row[0], owner[0]
            count += 1
        to_come = still_to_come(rest, masks[k])
        for e in range(entry_from[a], entry_from[a + 1]):
            i = int(np.int64(contour[e]))
            if crossed or grouped:
                _least_of_each(moves, terms, masks[k], i, first, have, row, owner, count, never, best)
            else:
                least_of(moves.table, moves.base[i], moves.pad[i], have, row, count, never, best)
            free = near_left(rest, masks[k], i)
            room = limit - to_come + rest.price[i]
            span = np.uint64(new_begin[place[e]]), np.uint64(first[i]), np.uint64(first[i + 1] - first[i])
            if terms.cond_of[i] < terms.cond_of[i + 1]:
                lives = _keep_asked(terms, masks[k], i, span, best, rest.to_go[free], room, never, new_values)
            else:
                lives = _keep(terms.site_cost, span, best, rest.to_go[free], room, never, new_values)
            living[place[e]] = lives


@inner(nogil=True)
def _keep(  # pragma: no cover - compiled
    site_cost: Ints,
    span: tuple[np.uint64, np.uint64, np.uint64],
    best: Costs,
    to_go: Floats,
    room: float,
    never: int,
    new_values: Costs,
) -> bool:
    """Store what is not too dear; whether there is any. Places are unsigned for the sake of vectors."""
    at, column, size = span
    count = 0
    for d in range(size):
        total = best[d] + site_cost[column + d]
        fits = total + to_go[column + d] <= room
        new_values[at + d] = total if fits else never
        count += fits
    return count > 0


@inner(nogil=True)
def _keep_asked(  # pragma: no cover - compiled
    terms: StepTerms,
    mask: Masks,
    i: int,
    span: tuple[np.uint64, np.uint64, np.uint64],
    best: Costs,
    to_go: Floats,
    room: float,
    never: int,
    new_values: Costs,
) -> bool:
    """The same for a contour with conditions."""
    at, column, size = span
    lives = False
    for d in range(size):
        total = best[d] + terms.site_cost[column + d] + asked(terms, mask, i, np.int64(column + d))
        fits = total + to_go[column + d] <= room
        new_values[at + d] = total if fits else never
        lives = lives or fits
    return lives


@inner(nogil=True)
def least_of(  # pragma: no cover - compiled
    table: Costs, base: int, pad: int, have: Costs, row: Ints, count: int, never: int, best: Costs
) -> None:
    """The least cost to every site of a contour. Unsigned places and narrow sums let it be done in vectors."""
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


@inner(nogil=True)
def _least_of_each(  # pragma: no cover - compiled
    moves: MoveTable,
    terms: StepTerms,
    mask: Masks,
    i: int,
    first: Ints,
    have: Costs,
    row: Ints,
    owner: Ints,
    count: int,
    never: int,
    best: Costs,
) -> None:
    """The same where moves cross what is out, or leave groups."""
    best[:] = never
    for x in range(count):
        if have[x] >= never:
            continue
        value = np.int64(have[x])
        if row[x] >= moves.row_of[0]:
            value += leaving(terms, mask, owner[x], i)
        for d in range(first[i + 1] - first[i]):
            total = value + moves.table[moves.base[i] + row[x] * moves.pad[i] + d]
            if len(moves.mask):
                total += crossing_in_set(moves, mask, row[x], first[i] + d)
            if total < best[d]:
                best[d] = total


@kept(nogil=True)
def leaving(terms: StepTerms, mask: Masks, j: int, i: int) -> int:  # pragma: no cover - compiled
    """What leaving soft groups before they are whole costs when contour i follows j, and `mask` is out."""
    cost = 0
    for g in range(len(terms.soft_cost)):
        if terms.soft_has[g, j] and not terms.soft_has[g, i] and missing(terms.soft_mask[g], mask):
            cost += terms.soft_cost[g]
    return cost


@kept(nogil=True)
def crossing_in_set(moves: MoveTable, mask: Masks, row: int, column: int) -> int:  # pragma: no cover - compiled
    """What a move costs for the contours that it crosses and that are out."""
    over = 0
    for w in range(len(mask)):
        bits = moves.mask[row, column, w] & mask[w]
        while bits:
            bits &= bits - np.uint64(1)
            over += 1
    return over * moves.price


@inner(nogil=True)
def asked(terms: StepTerms, mask: Masks, i: int, column: np.int64) -> int:  # pragma: no cover - compiled
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
