"""The sweep: shortest ways through the ideals of one stretch, layer by layer."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numba import get_num_threads, set_num_threads

from .crossed import Crossed
from .kernels import successors, sweep
from .local import Floats, Ints, Local, Masks
from .prune import Pruner

THREADS = get_num_threads()
SORTING = 100.0
"""Additions that it takes as long as to find and sort one entry of a layer."""
NUMBERS_AN_ENTRY = 8
"""Numbers of 8 bytes that an entry takes while its layer is being made."""
WORTH_SHARING = 3e6
"""Additions below which a layer is done sooner by one thread than by several that must first be woken."""


class TooLarge(Exception):
    """The stretch has more ideals than the budget allows; nothing is proven."""


@dataclass(slots=True)
class Budget:
    """What may still be spent: additions in the inner loop, and states kept in memory (8 bytes each)."""

    additions: float
    states: int
    go: Callable[[], bool]

    def take(self, additions: float, states: int) -> None:
        """Spend, or raise `TooLarge`; also when `go` says to stop."""
        self.additions -= additions
        self.states -= states
        if self.additions < 0 or self.states < 0 or not self.go():
            raise TooLarge

    def expect(self, entries: float) -> None:
        """Pay for sorting the entries that a layer will have, or raise `TooLarge` if they will not fit in memory."""
        self.take(SORTING * entries, 0)
        if NUMBERS_AN_ENTRY * entries > self.states:
            raise TooLarge


@dataclass(frozen=True, eq=False, slots=True)
class Layer:
    """Ideals of one size with their entries (see `kernels`) and the value of every state."""

    ideals: Masks
    ideal_entry: Ints
    contour: Ints
    source: Ints
    state: Ints
    values: Floats


def sweep_layers(
    local: Local,
    travel: Floats,
    crossed: Crossed,
    entrance: Floats,
    limit: float,
    rest: Floats,
    pruner: Pruner | None,
    budget: Budget,
) -> list[Layer]:
    """All layers of a stretch, the first the empty set with the values at its entrance.

    `travel` has a row for every way in and then for every site, a column for every site; `entrance` the cost so far
    of every way in. States that cost more than `limit` less `rest` (a bound on what each contour still adds, the last
    element for all that follows the stretch), or less what `pruner` knows, are dropped: they cannot be part of a better
    plan.
    """
    ways = len(entrance)
    row_of = np.append(ways + local.first[:-1], 0)
    size = np.diff(local.first)
    layers = [
        Layer(
            np.zeros(1, dtype=np.uint64),
            np.array([0, 1]),
            np.array([-1]),
            np.array([-1]),
            np.array([0, ways]),
            entrance,
        )
    ]
    growth = float(len(local.contours))  # new sets of every set, as many as there were in the layer before
    for depth in range(1, len(local.contours) + 1):
        last = layers[-1]
        lowest = _lowest(last)
        alive = np.flatnonzero(lowest + _rest(last.ideals, rest) <= limit)
        budget.expect(len(alive) * growth)
        grown, cut, source = successors(last.ideals, alive, local.needs, local.mates)
        growth = len(cut) / max(1, len(alive))
        order = np.lexsort((cut, grown))
        grown, cut, source = grown[order], cut[order], source[order]
        state = np.concatenate([[0], np.cumsum(size[cut])])
        width = np.diff(last.state[last.ideal_entry])
        additions = float((width[source] * size[cut]).sum())
        budget.take(additions, int(state[-1]) + 4 * len(cut))
        values = np.empty(int(state[-1]))
        set_num_threads(1 if additions < WORTH_SHARING else THREADS)
        sweep(
            cut, source, state, last.ideals, last.ideal_entry, last.contour, last.state, last.values, row_of, travel,
            local.first, local.site_cost, local.cond_of, local.cond_site, local.cond_from, local.cond_member,
            local.cond_weight, local.cond_bound, local.cond_cost, local.soft_mask, local.soft_cost, crossed.mask,
            crossed.price, values,
        )  # fmt: skip
        whole = len(values)
        if pruner is not None:
            pruner.prune(grown, cut, state, local.first, values, depth, limit)
        layers.append(_living(grown, cut, source, state, values))
        budget.states += whole - len(layers[-1].values)
    return layers


def _living(grown: Masks, cut: Ints, source: Ints, state: Ints, values: Floats) -> Layer:
    """A layer of the entries that have a state of finite value."""
    if not len(cut):
        return Layer(grown, np.array([0]), cut, source, state, values)
    alive = np.isfinite(np.minimum.reduceat(values, state[:-1]))
    values = values[np.repeat(alive, np.diff(state))]
    state = np.append(0, np.cumsum(np.diff(state)[alive]))
    ideals, at = np.unique(grown[alive], return_index=True)
    return Layer(
        ideals, np.append(at, len(at) and alive.sum()).astype(np.int64), cut[alive], source[alive], state, values
    )


def _lowest(layer: Layer) -> Floats:
    """Least value of the states of every ideal."""
    starts = layer.state[layer.ideal_entry[:-1]]
    return np.minimum.reduceat(layer.values, starts) if len(starts) else np.zeros(0)


def _rest(ideals: Masks, rest: Floats) -> Floats:
    """For every ideal a lower bound on what is still to come."""
    missing = np.full(len(ideals), rest[-1])
    for i, least in enumerate(rest[:-1]):
        missing += least * ((ideals >> np.uint64(i) & np.uint64(1)) == 0)
    return missing


def walk_back(local: Local, layers: list[Layer], travel: Floats, crossed: Crossed, state: int) -> tuple[list[int], int]:
    """The sites (columns) of a best way to state `state` of the last layer, in order, and the way in it took."""
    ways = len(layers[0].values)
    row_of = np.append(ways + local.first[:-1], 0)
    columns: list[int] = []
    for depth in range(len(layers) - 1, 0, -1):
        here, back = layers[depth], layers[depth - 1]
        entry = int(np.searchsorted(here.state, state, side="right")) - 1
        contour, row = int(here.contour[entry]), int(here.source[entry])
        column = int(local.first[contour]) + state - int(here.state[entry])
        columns.append(column)
        best, at = np.inf, -1
        for s in range(int(back.ideal_entry[row]), int(back.ideal_entry[row + 1])):
            j = int(back.contour[s])
            span = slice(int(back.state[s]), int(back.state[s + 1]))
            rows = int(row_of[j]) + np.arange(span.stop - span.start)
            ideal = int(back.ideals[row])
            costs = back.values[span] + travel[rows, column] + crossed.cost(rows, column, ideal)
            costs += _leaving(local, ideal, j, contour)
            k = int(np.argmin(costs))
            if costs[k] < best:
                best, at = float(costs[k]), span.start + k
        state = at
    return columns[::-1], state


def _leaving(local: Local, ideal: int, j: int, i: int) -> float:
    """What leaving soft groups unfinished costs when i follows j."""
    return sum(
        float(cost)
        for mask, cost in zip(local.soft_mask.tolist(), local.soft_cost.tolist(), strict=True)
        if j >= 0 and mask >> j & 1 and not mask >> i & 1 and mask & ~ideal
    )
