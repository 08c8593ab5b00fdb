"""Drops states that cannot be part of a plan better than the incumbent."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

from ..bounds import Completion
from .local import Floats, Ints, Local, Masks


@dataclass(frozen=True, eq=False, slots=True)
class Pruner:
    """A completion bound as a stretch needs it, after `cut` contours of earlier stretches.

    `bit[i, j]` is the local number of neighbour j of local contour i: -1 for one out by now or none, -2 for one that
    comes after the stretch. `price` (k,) is that of the stretch's contours, `later` the sum of those after it.
    """

    to_go: Floats
    sites: Ints
    bit: Ints
    price: Floats
    later: float
    cut: int

    @staticmethod
    def of(bound: Completion, local: Local, earlier: frozenset[int]) -> Pruner:
        """`earlier` are the contours cut before the stretch."""
        number = np.full(len(bound.price) + 1, -2, dtype=np.int64)
        number[[*earlier, -1]] = -1
        number[list(local.contours)] = np.arange(len(local.contours))
        return Pruner(
            bound.to_go,
            local.sites,
            number[bound.near[list(local.contours)]],
            bound.price[list(local.contours)],
            float(bound.price[number[:-1] == -2].sum()),
            len(earlier),
        )

    def prune(
        self, grown: Masks, cut: Ints, state: Ints, first: Ints, values: Floats, depth: int, limit: float
    ) -> None:
        """Make infinite what would lead to plans dearer than `limit`; `grown` is the ideal of every entry."""
        to_go = self.to_go[self.cut + depth]
        _prune(grown, cut, state, first, values, to_go, self.sites, self.bit, self.price, self.later, limit)


@njit(cache=True)
def _prune(  # pragma: no cover - compiled
    grown: Masks, cut: Ints, state: Ints, first: Ints, values: Floats, to_go: Floats, sites: Ints, bit: Ints,
    price: Floats, later: float, limit: float
) -> None:  # fmt: skip
    for e in range(len(cut)):
        ideal, i = grown[e], cut[e]
        rest = later
        for c in range(len(price)):
            if not ideal >> np.uint64(c) & np.uint64(1):
                rest += price[c]
        free = 0
        for j in range(bit.shape[1]):
            if bit[i, j] == -2 or (bit[i, j] >= 0 and not ideal >> np.uint64(bit[i, j]) & np.uint64(1)):
                free |= 1 << j
        for k in range(state[e], state[e + 1]):
            if values[k] + to_go[free, sites[first[i] + k - state[e]]] + rest > limit:
                values[k] = np.inf
