"""The inner loop of a sweep where moves have two costs: what they cost, and what multipliers leave of that.

The least of either to a state may come by different ways. A state is dropped where one of them is too much.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Int16s, Ints
from kerfwise.models.kernels import inner, kept
from kerfwise.models.problem.bits import Masks

from .kernels import TOGETHER, Costs, MoveTable, asked, least_of, most_columns, most_states
from .local import StepTerms
from .over import Over, over_in_set
from .rest_bound import RestBound, near_left, still_to_come


class Lows(NamedTuple):
    """What multipliers leave of the cost of `moves`, and its sums to every state, `values` and `new_values`.

    What moves cost for what is out is in neither of the two: both pay it.
    """

    moves: MoveTable
    over: Over
    values: Costs
    new_values: Costs


@kept(nogil=True)
def sweep_both(  # pragma: no cover - compiled
    moves: MoveTable,
    low: Lows,
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
    """As `kernels.sweep`, with `low` beside the costs, and what is still to come of these."""
    rows, columns = most_states(ideal_entry, begin, alive, start, stop), most_columns(moves)
    have, lows = np.empty(rows, values.dtype), np.empty(rows, values.dtype)
    row = np.empty(rows, np.int64)
    best, lowest = np.empty(columns, values.dtype), np.empty(columns, values.dtype)
    for a in range(start, stop):
        k = alive[a]
        count = 0
        for s in range(ideal_entry[k], ideal_entry[k + 1]):
            j = last[s]
            for q in range(begin[s], begin[s + 1]):
                if values[q] < never:
                    have[count], lows[count], row[count] = values[q], low.values[q], moves.row_of[j] + q - begin[s]
                    count += 1
        while count % TOGETHER:
            have[count], lows[count], row[count] = never, never, row[0]
            count += 1
        to_come = still_to_come(rest, masks[k])
        for e in range(entry_from[a], entry_from[a + 1]):
            i = int(np.int64(contour[e]))
            least_of(low.moves.table, low.moves.base[i], low.moves.pad[i], lows, row, count, never, lowest)
            free = near_left(rest, masks[k], i)
            room = limit - to_come + rest.price[i]
            lives = False
            for d in range(first[i + 1] - first[i]):
                if lowest[d] + rest.to_go[free, first[i] + d] <= room:
                    lives = True
            living[place[e]] = False
            at = new_begin[place[e]]
            if not lives:
                for d in range(first[i + 1] - first[i]):
                    new_values[at + d] = low.new_values[at + d] = never
                continue
            if len(low.over.extra):
                least_of_both(moves, low, masks[k], i, first, have, lows, row, count, never, best, lowest)
            else:
                least_of(moves.table, moves.base[i], moves.pad[i], have, row, count, never, best)
            for d in range(first[i + 1] - first[i]):
                column = first[i] + d
                total = best[d] + terms.site_cost[column] + asked(terms, masks[k], i, np.int64(column))
                if total <= limit and lowest[d] + rest.to_go[free, column] <= room:
                    new_values[at + d], low.new_values[at + d] = total, lowest[d]
                    living[place[e]] = True
                else:
                    new_values[at + d] = low.new_values[at + d] = never


@inner(nogil=True)
def least_of_both(  # pragma: no cover - compiled
    moves: MoveTable,
    low: Lows,
    mask: Masks,
    i: int,
    first: Ints,
    have: Costs,
    lows: Costs,
    row: Ints,
    count: int,
    never: int,
    best: Costs,
    lowest: Costs,
) -> None:
    """The least costs to every site of contour i, and the least of `low`, where moves cost more for what is out."""
    begin = moves.row_of[0]
    for d in range(first[i + 1] - first[i]):
        best[d] = lowest[d] = never
    for x in range(count):
        if have[x] >= never:
            continue
        at, low_at = moves.base[i] + row[x] * moves.pad[i], low.moves.base[i] + row[x] * low.moves.pad[i]
        for d in range(first[i + 1] - first[i]):
            cost = np.int64(have[x]) + moves.table[at + d]
            least = np.int64(lows[x]) + low.moves.table[low_at + d]
            if least < never and cost < never and (cost < best[d] or least < lowest[d]):
                more = over_in_set(low.over, mask, row[x] - begin, first[i] + d)
                best[d] = min(np.int64(best[d]), cost + more)
                lowest[d] = min(np.int64(lowest[d]), least + more)
