"""The state of a search: the route it stands on, the route it tries, the best one, and room to work in."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .compiled import compiled
from .tables import Tables

Ints = NDArray[np.int64]

# What `State.number` holds.
LENGTH = 0  # contours in the trial order
COST = 1  # cost of the route we stand on, µm
BROKEN = 2  # how many hard statements it breaks
BEST = 3  # cost of the best lawful route, -1 if none is known
PRICE = 4  # what a broken hard statement counts, µm
WORK = 5  # elementary operations so far
UNITS = 6  # strings taken out of the trial order
TOUCHES = 7  # entries in `touch_at`
CHANGED = 8
NUMBERS = 16


class State(NamedTuple):
    """Arrays that kernels write to. `order` lists contours, `position` is -1 for one that is out, `site` by contour.

    The names ending in `_now` are the route we stand on; `order`, `position`, `site` the trial made from it.
    Strings taken out are `out[unit[u]:unit[u + 1]]`.
    """

    order: Ints
    position: Ints
    site: Ints
    order_now: Ints
    position_now: Ints
    site_now: Ints
    best: Ints
    number: Ints
    random: NDArray[np.uint64]
    out: Ints
    unit: Ints
    unit_key: NDArray[np.float64]
    unit_rank: Ints
    mark: Ints
    stack: Ints
    touch_at: Ints
    touch_by: Ints
    reach: Ints
    back: Ints
    stale: NDArray[np.bool_]


def new_state(tables: Tables, seed: int) -> State:
    """An empty state; equal seeds walk equal ways."""
    n, m = tables.n, tables.m
    touches = int(np.diff(tables.touch_first).max(initial=0)) * 2 + 8
    spread = np.random.SeedSequence(seed).generate_state(1, np.uint64)

    def room(size: int) -> Ints:
        return np.full(size, -1, dtype=np.int64)

    return State(
        order=room(n + 1),
        position=room(n),
        site=room(n),
        order_now=room(n + 1),
        position_now=room(n),
        site_now=room(n),
        best=room(n),
        number=np.zeros(NUMBERS, dtype=np.int64),
        random=spread | np.uint64(1),
        out=room(n + 1),
        unit=room(n + 2),
        unit_key=np.zeros(n + 1),
        unit_rank=room(n + 1),
        mark=np.zeros(n + 1, dtype=np.int64),
        stack=room(n + 1),
        touch_at=room(touches * (n if n < 64 else 64)),
        touch_by=room(touches * (n if n < 64 else 64)),
        reach=room(m + 1),
        back=room(m + 1),
        stale=np.zeros(n + 2, dtype=np.bool_),
    )


@compiled
def draw(random: NDArray[np.uint64]) -> np.uint64:
    """The next 64 random bits (xorshift64*, Vigna 2016)."""
    x = random[0]
    x ^= x >> np.uint64(12)
    x ^= x << np.uint64(25)
    x ^= x >> np.uint64(27)
    random[0] = x
    return x * np.uint64(2685821657736338717)


@compiled
def below(random: NDArray[np.uint64], bound: int) -> int:
    """A random whole number in 0 … bound - 1."""
    return np.int64((draw(random) >> np.uint64(33)) % np.uint64(bound))


@compiled
def share(random: NDArray[np.uint64]) -> float:
    """A random number in [0, 1)."""
    return np.float64(draw(random) >> np.uint64(11)) * (1.0 / 9007199254740992.0)
