"""A zone's budget of heat: zones that take up more are divided once more, in an order that the rules allow.

Strips already end before their heat passes the budget (see `zone_strips`), but orders may raise parts from one zone
into another. Only what cannot be divided, a part with everything nested in it, may then pass the budget, alone.
"""

from __future__ import annotations

from heapq import heapify, heappop, heappush

import numpy as np

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.components import strong_components

from .zone_blocks import Blocks

_ROUNDING = 1e-9


def fitting(heat_kj: Floats, budget_kj: float) -> int:
    """How many of the first, at least one, stay within the budget together.

    Examples
    --------
    >>> fitting(np.array([2.0, 3.0, 1.0]), 5.0), fitting(np.array([9.0, 1.0]), 5.0)
    (2, 1)
    """
    return max(1, int(np.searchsorted(np.cumsum(heat_kj), budget_kj * (1 + _ROUNDING), side="right")))


def divided(zone: Ints, rank: Ints, blocks: Blocks, budget_kj: float) -> Ints:
    """Zones of blocks, (k,), where none takes up more than the budget but with a single block.

    Those over it are taken apart in the order of `rank`, (k,), as far as `pairs` let it. Blocks that pairs hold
    together, because they go round in a circle, stay together where the budget has room for them.
    """
    heat_kj = np.bincount(zone, blocks.heat_kj)
    share = np.zeros(len(zone), dtype=np.int64)
    for over in np.flatnonzero(heat_kj > budget_kj * (1 + _ROUNDING)).tolist():
        number, spent_kj = -1, np.inf
        for unit in _in_turn(np.flatnonzero(zone == over), rank, blocks, budget_kj):
            more_kj = float(blocks.heat_kj[unit].sum())
            if spent_kj + more_kj > budget_kj * (1 + _ROUNDING):
                number, spent_kj = number + 1, 0.0
            share[unit] = number
            spent_kj += more_kj
    return zone * (int(share.max(initial=0)) + 1) + share


def _in_turn(members: Ints, rank: Ints, blocks: Blocks, budget_kj: float) -> list[Ints]:
    """Blocks of one zone as units that may be cut one after the other: a block, or some that must stay together."""
    number = np.full(len(rank), -1, dtype=np.int64)
    number[members] = np.arange(len(members))
    within = number[blocks.pairs]
    within = np.unique(within[(within >= 0).all(axis=1)], axis=0)
    unit = strong_components(len(members), within)
    too_hot = np.bincount(unit, blocks.heat_kj[members]) > budget_kj * (1 + _ROUNDING)
    alone = np.flatnonzero(too_hot[unit])  # a circle that is too hot is broken: its blocks go one by one
    within = within[~((unit[within[:, 0]] == unit[within[:, 1]]) & too_hot[unit[within[:, 0]]])]
    unit[alone] = len(members) + np.arange(len(alone))
    names, unit = np.unique(unit, return_inverse=True)
    in_rank = np.argsort(rank[members], kind="stable")
    held = [in_rank[unit[in_rank] == k] for k in range(len(names))]
    return [members[held[k]] for k in _topological(unit[within], rank[members][[of[0] for of in held]])]


def _topological(pairs: Ints, rank: Ints) -> list[int]:
    """Units so that no pair (before, after) points backwards, of several that may come next the lowest in rank."""
    pairs = np.unique(pairs[pairs[:, 0] != pairs[:, 1]], axis=0)
    waits = np.bincount(pairs[:, 1], minlength=len(rank))
    following: list[list[int]] = [[] for _ in rank]
    for before, after in pairs.tolist():
        following[before].append(after)
    ready = [(int(rank[k]), k) for k in np.flatnonzero(waits == 0).tolist()]
    heapify(ready)
    order = []
    while ready:
        _, k = heappop(ready)
        order.append(k)
        for after in following[k]:
            waits[after] -= 1
            if waits[after] == 0:
                heappush(ready, (int(rank[after]), after))
    return order
