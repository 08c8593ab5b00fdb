"""The inner loop of a sweep where moves have two costs: what they cost, and what multipliers leave of that.

The least of either to a state may come by different ways. A state is dropped where one of them is too much.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Int16s, Ints
from kerfwise.models.kernels import kept
from kerfwise.models.problem.bits import Masks

from .kernels import TOGETHER, Costs, MoveTable, asked, least_of, most_columns, most_states
from .local import StepTerms
from .rest_bound import RestBound, near_left, still_to_come


class Lows(NamedTuple):
    """What multipliers leave of the cost of `moves`, and its sums to every state, `values` and `new_values`."""

    moves: MoveTable
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
    """As `kernels.sweep`, with `low` beside the costs, and what is still to come of these; nothing is crossed."""
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
            least_of(moves.table, moves.base[i], moves.pad[i], have, row, count, never, best)
            for d in range(first[i + 1] - first[i]):
                column = first[i] + d
                total = best[d] + terms.site_cost[column] + asked(terms, masks[k], i, np.int64(column))
                if total <= limit and lowest[d] + rest.to_go[free, column] <= room:
                    new_values[at + d], low.new_values[at + d] = total, lowest[d]
                    living[place[e]] = True
                else:
                    new_values[at + d] = low.new_values[at + d] = never
