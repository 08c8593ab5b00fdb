"""The state of a search: the route it stands on, the trial made from it, the best one, and room to work in."""

from __future__ import annotations

from typing import NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Int32s, Ints

from .tables import SearchTables

# Typed, because numba compiles a function anew for each literal that it is called with.
START = cast(int, np.int64(0))
NOWHERE = cast(int, np.int64(-1))
ONE = cast(int, np.int64(1))
YES, NO = cast(bool, np.bool_(True)), cast(bool, np.bool_(False))

# What `State.number` holds.
LENGTH = 0  # contours in the trial
COST = 1  # cost of the route we stand on, µm
BROKEN = 2  # how many hard statements it breaks
BEST = 3  # cost of the best lawful route, -1 if none is known
PRICE = 4  # what a broken hard statement counts, µm
WORK = 5  # elementary operations so far
TAKEN = 6  # contours taken out of the trial
UNITS = 7  # strings that they were taken out as
STAMP = 8  # the mark of the present walk through the orders
TRIES = 9  # trials so far
LAWLESS = 10  # of the last trials, those after which we stood on a route that breaks something
CLIMBS = 11  # entries made in `climb`
TRADES = 12  # exchanges tried on plain problems
TRADED = 13  # of these, those taken that changed the cost
NUMBERS = 14


class State(NamedTuple):
    """Arrays that kernels write to. `order` lists contours, `position` is -1 for one that is out, `site` by contour.

    `order`, `position`, `site` are the trial; names ending in `_now` the route we stand on. `best` lists sites in
    order. Strings taken out are `out[unit[u]:unit[u + 1]]`. `forced` is the site that a contour must take in this
    trial, or -1; `lean` what a site costs for the general statements' sake. `stale` marks contours whose site may not
    be the best any more. `line` lists contours between home and home, `place` says where in it each stands.
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
    queue: Ints
    forced: Ints
    lean: Ints
    stale: NDArray[np.bool_]
    mark: Ints
    stack: Ints
    later: Ints
    time_ms: Ints
    climb: Ints
    reach: Ints
    back: Ints
    line: Int32s
    place: Int32s
    spare: Int32s
    turned: Ints


def new_state(tables: SearchTables, seed: tuple[int, ...]) -> State:
    """An empty state; equal seeds walk equal ways."""
    n, m = tables.legs.n, tables.legs.m

    def room(size: int) -> Ints:
        return np.full(size, -1, dtype=np.int64)

    number = np.zeros(NUMBERS, dtype=np.int64)
    number[BEST] = -1
    return State(
        order=room(n),
        position=room(n),
        site=room(n),
        order_now=room(n),
        position_now=room(n),
        site_now=room(n),
        best=room(n),
        number=number,
        random=np.random.SeedSequence(seed).generate_state(1, np.uint64) | np.uint64(1),
        out=room(n),
        unit=room(n + 1),
        unit_key=np.zeros(n),
        queue=room(n),
        forced=room(n),
        lean=np.zeros(m, dtype=np.int64),
        stale=np.zeros(n, dtype=np.bool_),
        mark=np.zeros(n, dtype=np.int64),
        stack=room(n),
        later=room(n + 1),
        time_ms=room(n),
        climb=np.zeros(512, dtype=np.int64),
        reach=room(m),
        back=room(m),
        line=room(n + 2).astype(np.int32),
        place=room(n + 1).astype(np.int32),
        spare=room(n + 2).astype(np.int32),
        turned=np.zeros(n + 2, dtype=np.int64),
    )
