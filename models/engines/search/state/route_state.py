"""The tables of a problem that kernels read, and the state of a search: its route, the trial, room to work in."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Bools, Int32s, Ints, point_tree
from kerfwise.models.engines.tuning import ROUTE_STATE_NEAR as NEAR
from kerfwise.models.problem.precedence import known_immediate_pairs
from kerfwise.models.problem.problem import Problem

from .chains import Chains, make_chains
from .conditions import (
    Demands,
    Groups,
    Lags,
    Literals,
    make_demands,
    make_groups,
    make_lags,
    make_literals,
)
from .jit_tools import compiled
from .travel import ArcCosts, Crossed, Legs, make_arcs, make_crossed, make_legs, nearest_lawful

ROWS_AT_ONCE = 1_000_000  # pairs of contours whose orders are looked at together

# A problem as the flat arrays that compiled kernels read.


class SearchTables(NamedTuple):
    """Everything that stays as it is during a search."""

    legs: Legs
    orders: OrderLists
    demands: Demands
    crossed: Crossed
    groups: Groups
    lags: Lags
    literals: Literals
    chains: Chains
    arcs: ArcCosts


class TablesOf(NamedTuple):
    """A problem with its tables."""

    problem: Problem
    tables: SearchTables


def make_tables(problem: Problem, earlier: TablesOf | None = None) -> SearchTables:
    """The arrays of a problem; lengths of moves and orders are those of an `earlier` one where they are the same."""
    legs = make_legs(problem, None if earlier is None else (earlier.problem, earlier.tables.legs))
    return SearchTables(
        legs,
        _orders_of(earlier, problem, legs) or make_orders(problem, legs),
        make_demands(problem),
        make_crossed(problem, priced=legs.travel.size > 0),
        make_groups(problem),
        make_lags(problem),
        make_literals(problem),
        make_chains(problem),
        make_arcs(problem, legs),
    )


def _orders_of(earlier: TablesOf | None, problem: Problem, legs: Legs) -> OrderLists | None:
    """The orders of an earlier problem, if they and the lengths that neighbours are found by are this one's."""
    if earlier is None or legs.travel is not earlier.tables.legs.travel:
        return None
    other, known = earlier.problem, earlier.tables.legs
    same = np.array_equal(problem.block, other.block) and np.array_equal(legs.first, known.first)
    same = same and np.array_equal(legs.pierce, known.pierce) and np.array_equal(legs.end, known.end)
    same = same and (problem.before is other.before or np.array_equal(problem.before, other.before))
    return earlier.tables.orders if same else None


# Which contour may stand where: precedence in lists, blocks, and who may follow whom.


class OrderLists(NamedTuple):
    """`before` is closed. `covers` lists for every contour those that come before it with no third between
    (transitive reduction), `covered` those after it. The members of block `block[i]` are
    `in_block[block_first[block[i]]:…]`.
    `near` (n, k) are the nearest contours that may directly follow, `near_in` those that may directly precede; padded
    with -1.
    """

    before: Bools
    covers_first: Ints
    covers: Ints
    covered_first: Ints
    covered: Ints
    block: Ints
    block_first: Ints
    in_block: Ints
    near: Ints
    near_in: Ints


def make_orders(problem: Problem, legs: Legs) -> OrderLists:
    """The orders of a problem."""
    n, before = problem.n, problem.before
    sooner, later = known_immediate_pairs(before)
    _, block = np.unique(problem.block, return_inverse=True)
    covers_first, covers = _grouped(later, sooner, n)
    covered_first, covered = _grouped(sooner, later, n)
    block_first, in_block = _grouped(block, np.arange(n), int(block.max(initial=-1)) + 1)
    direct = np.sort(sooner * n + later)

    def may_follow(one: Ints, other: Ints) -> Bools:
        at = np.searchsorted(direct, key := one * n + other)
        near = direct[np.minimum(at, len(direct) - 1)] == key if len(direct) else np.zeros(key.shape, dtype=np.bool_)
        return np.asarray((one != other) & ~before[other, one] & (near | ~before[one, other]))

    return OrderLists(
        before=np.ascontiguousarray(before),
        covers_first=covers_first,
        covers=covers,
        covered_first=covered_first,
        covered=covered,
        block=np.asarray(block, dtype=np.int64),
        block_first=block_first,
        in_block=in_block,
        near=_nearest(legs, may_follow, forward=True),
        near_in=_nearest(legs, lambda one, other: may_follow(other, one), forward=False),
    )


def _grouped(key: Ints, value: Ints, groups: int) -> tuple[Ints, Ints]:
    """The values with key 0, then those with key 1 …, in the order given: `first` and `flat` (see `lists`)."""
    by = np.argsort(key, kind="stable")
    return np.searchsorted(key[by], np.arange(groups + 1)).astype(np.int64), value[by].astype(np.int64)


def _nearest(legs: Legs, allowed: Callable[[Ints, Ints], Bools], forward: bool) -> Ints:
    """The `NEAR` nearest allowed contours of each, nearest first."""
    n, k = legs.n, min(NEAR, max(legs.n - 1, 1))
    found = np.full((n, k), -1, dtype=np.int64)
    if n == 0:
        return found
    if legs.travel.size:
        least = np.minimum.reduceat(legs.leave[:-1], legs.first[:-1], axis=0)
        cost = least if forward else least.T
        for rows in np.array_split(np.arange(n), n * n // ROWS_AT_ONCE + 1):
            one, other = np.repeat(rows, n), np.tile(np.arange(n), len(rows))
            near, count = nearest_lawful(cost[rows], allowed(one, other).reshape(len(rows), n), k)
            found[rows] = np.where(np.arange(k) < count[:, None], near, -1)
        return found
    here, there = (legs.end_circle, legs.pierce_circle) if forward else (legs.pierce_circle, legs.end_circle)
    _, around = point_tree(there[:, :2], leafsize=10).query(here[:, :2], k=min(4 * k, n))
    around = around.reshape(n, -1)
    lawful = allowed(np.repeat(np.arange(n), around.shape[1]), around.ravel()).reshape(around.shape)
    row, column = np.nonzero(lawful)
    rank = np.cumsum(lawful, axis=1)[row, column] - 1
    first = rank < k
    found[row[first], rank[first]] = around[row[first], column[first]]
    return found


# The state of a search: the route it stands on, the trial made from it, the best one, and room to work in.

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
WHOLE = 14  # of its cost what only the whole route tells, µm
WHOLE_BROKEN = 15  # and of the statements that it breaks
NUMBERS = 16


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


# The trial sequence: taking contours out, the window where one may stand, and putting it in.


@compiled
def close_gaps(state: State) -> None:
    """Drop the contours whose position was set to -1 from the order; those beside a gap become stale."""
    kept, gap = 0, False
    for p in range(state.number[LENGTH]):
        c = state.order[p]
        if state.position[c] < 0:
            if not gap and kept > 0:
                state.stale[state.order[kept - 1]] = True
            gap = True
            continue
        if gap:
            state.stale[c] = True
            gap = False
        state.order[kept] = c
        state.position[c] = kept
        kept += 1
    state.number[LENGTH] = kept


@compiled
def window(orders: OrderLists, state: State, contour: int) -> tuple[int, int]:
    """First and last position that a contour which is out may be put in before, by orders and blocks."""
    lo = _earliest(orders, state, contour)
    hi = _latest(orders, state, contour)
    b = orders.block[contour]
    start, stop = orders.block_first[b], orders.block_first[b + 1]
    if stop - start > 1:
        low, high = state.number[LENGTH], -1
        for e in range(start, stop):
            where = state.position[orders.in_block[e]]
            if where >= 0:
                low, high = min(low, where), max(high, where + 1)
        if high >= 0:
            lo, hi = max(lo, low), min(hi, high)
    return lo, hi


@compiled
def _earliest(orders: OrderLists, state: State, contour: int) -> int:
    """The position after the last contour that must come before this one, seen through those that are out."""
    state.number[STAMP] += 1
    limit, height = START, 1
    state.stack[0] = contour
    while height > 0:
        height -= 1
        x = state.stack[height]
        for e in range(orders.covers_first[x], orders.covers_first[x + 1]):
            y = orders.covers[e]
            if state.position[y] >= 0:
                limit = max(limit, state.position[y] + 1)
            elif state.mark[y] != state.number[STAMP]:
                state.mark[y] = state.number[STAMP]
                state.stack[height] = y
                height += 1
    return limit


@compiled
def _latest(orders: OrderLists, state: State, contour: int) -> int:
    """The position of the first contour that must come after this one, seen through those that are out."""
    state.number[STAMP] += 1
    limit, height = state.number[LENGTH], 1
    state.stack[0] = contour
    while height > 0:
        height -= 1
        x = state.stack[height]
        for e in range(orders.covered_first[x], orders.covered_first[x + 1]):
            y = orders.covered[e]
            if state.position[y] >= 0:
                limit = min(limit, state.position[y])
            elif state.mark[y] != state.number[STAMP]:
                state.mark[y] = state.number[STAMP]
                state.stack[height] = y
                height += 1
    return int(limit)


@compiled
def inside_block(orders: OrderLists, state: State, at: int, block: int) -> bool:
    """Whether position `at` would part the contours of a block other than `block`."""
    if at == 0 or at == state.number[LENGTH]:
        return False
    b = orders.block[state.order[at]]
    return bool(b != block and b == orders.block[state.order[at - 1]])


@compiled
def put_in(state: State, start: int, stop: int, at: int) -> None:
    """Put the contours `out[start:stop]` in before position `at`; they and those beside them become stale."""
    size = stop - start
    length = state.number[LENGTH]
    for p in range(length - 1, at - 1, -1):
        c = state.order[p]
        state.order[p + size] = c
        state.position[c] = p + size
    for k in range(size):
        c = state.out[start + k]
        state.order[at + k] = c
        state.position[c] = at + k
        state.stale[c] = True
    if at > 0:
        state.stale[state.order[at - 1]] = True
    if at + size < length + size:
        state.stale[state.order[at + size]] = True
    state.number[LENGTH] = length + size


# A route as a line of contours from home to home, and two ways to change it: swap two stretches, reverse one.


@compiled
def lay_out(state: State) -> None:
    """Write the route we stand on into the line; home is at both ends."""
    n = len(state.order_now)
    state.line[0] = state.line[n + 1] = n
    state.place[n] = 0
    for p in range(n):
        c = state.order_now[p]
        state.line[p + 1] = c
        state.place[c] = p + 1


@compiled
def take_up(state: State) -> None:
    """Stand on the line, and make it the trial as well."""
    for p in range(len(state.order_now)):
        c = int(state.line[p + 1])
        state.order_now[p] = state.order[p] = c
        state.position_now[c] = state.position[c] = p


@compiled
def may_swap(orders: OrderLists, line: Int32s, place: Int32s, i: int, j: int, k: int) -> bool:
    """Whether places i … j - 1 and j … k - 1 may be swapped: nothing in the first must come before one in the second.

    It suffices to look at orders with no third contour between: of a chain, one link leads across.
    """
    before = orders.before
    if before[line[j - 1], line[j]] or before[line[i], line[j]] or before[line[j - 1], line[k - 1]]:
        return False
    if j - i <= k - j:
        for p in range(j - 1, i - 1, -1):
            c = line[p]
            for e in range(orders.covered_first[c], orders.covered_first[c + 1]):
                if j <= place[orders.covered[e]] < k:
                    return False
    else:
        for p in range(j, k):
            c = line[p]
            for e in range(orders.covers_first[c], orders.covers_first[c + 1]):
                if i <= place[orders.covers[e]] < j:
                    return False
    return True


@compiled
def may_reverse(orders: OrderLists, line: Int32s, place: Int32s, i: int, k: int) -> bool:
    """Whether places i … k - 1 may be turned round: no order within them."""
    for p in range(i, k):
        c = line[p]
        for e in range(orders.covered_first[c], orders.covered_first[c + 1]):
            if p < place[orders.covered[e]] < k:
                return False
    return True


@compiled
def swap_places(line: Int32s, place: Int32s, spare: Int32s, i: int, j: int, k: int) -> None:
    """Swap places i … j - 1 and j … k - 1; `spare` is room for the shorter of the two."""
    left, right = j - i, k - j
    if left <= right:
        for t in range(left):
            spare[t] = line[i + t]
        for t in range(i, i + right):
            line[t] = line[t + left]
        for t in range(left):
            line[i + right + t] = spare[t]
    else:
        for t in range(right):
            spare[t] = line[j + t]
        for t in range(k - 1, i + right - 1, -1):
            line[t] = line[t - right]
        for t in range(right):
            line[i + t] = spare[t]
    for t in range(i, k):
        place[line[t]] = t


@compiled
def reverse(line: Int32s, place: Int32s, i: int, k: int) -> None:
    """Turn places i … k - 1 round."""
    a, b = i, k - 1
    while a < b:
        line[a], line[b] = line[b], line[a]
        a, b = a + 1, b - 1
    for t in range(i, k):
        place[line[t]] = t


@compiled
def sum_reversed(arcs: ArcCosts, state: State, start: int) -> None:
    """`turned[p]`: by how much places 0 … p cost more when gone through the other way; right up to `start` already."""
    line = state.line
    for p in range(max(start, 1), len(line)):
        a, b = line[p - 1], line[p]
        state.turned[p] = state.turned[p - 1] + np.int64(arcs.cost[b, a]) - np.int64(arcs.cost[a, b])
