"""Chains of exchanges for sparse orders: each step breaks an arc that costs too much and makes two near ones."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Ints
from kerfwise.models.engines.search.state.jit_tools import below, compiled, draw_share, entry
from kerfwise.models.engines.search.state.route_state import BEST, COST, WORK, SearchTables, may_swap, swap_places
from kerfwise.models.engines.search.walker import Walker
from kerfwise.models.engines.tuning import BREADTH, KICKS, PER_ARC, PER_CONTOUR, PER_KICK, PER_SWAP, STILL, WIDTH
from kerfwise.models.engines.tuning import CHAIN_BESIDE as BESIDE
from kerfwise.models.engines.tuning import CHAIN_DRAWS as DRAWS
from kerfwise.models.engines.tuning import CHAIN_FALL as FALL
from kerfwise.models.engines.tuning import CHAIN_LONGEST as LONGEST
from kerfwise.models.engines.tuning import CHAIN_NEAR as NEAR
from kerfwise.models.engines.tuning import CHAIN_SHORT as SHORT
from kerfwise.models.kernel_struct import kernel_argument

from .lin_kernighan_tables import (
    DEPTH,
    FRONT,
    HIGH,
    LOW,
    QUEUED,
    UNLAWFUL,
    ChainState,
    ChainTables,
    make_chain_tables,
    nearest_lawful,
    new_chain_state,
    typical_cost,
)

# A walker that goes on by kicks and chains: for problems of arcs and few orders.


class ChainedWalker(Walker):
    """See `Walker`; random numbers come from `seed`. For problems that are `plain` (see `ArcCosts`)."""

    def __init__(self, fields: SearchTables, seed: tuple[int, ...], like: Walker | None = None) -> None:
        self.tables = make_chain_tables(fields)
        self.arrays = new_chain_state(self.tables, seed)
        super().__init__(fields, self.arrays, like)
        self._kernel_tables, self._state = kernel_argument(self.tables), kernel_argument(self.arrays)

    def start(self) -> None:
        if self.arrays.number[BEST] < 0:
            self.stand_on(nearest_lawful(self.tables))

    def descend(self, chunk: int) -> None:
        self.go(chunk, STILL, STILL)

    def measure(self, most: int) -> None:
        line = self.arrays.stood
        taken = float(self.tables.cost[line[:-1], line[1:]].mean(dtype=np.float64))
        self._hot = max(STILL, NEAR * typical_cost(self.tables) + BESIDE * taken)
        self._cold = self._hot / FALL

    def stand_on(self, sites: NDArray[np.int64]) -> None:
        arrays = self.arrays
        arrays.line[1:-1] = arrays.stood[1:-1] = sites
        arrays.place[sites] = np.arange(1, len(sites) + 1)
        arrays.number[COST] = self._fields.arcs.cost[arrays.line[:-1], arrays.line[1:]].sum(dtype=np.int64)
        if arrays.number[BEST] < 0 or arrays.number[COST] < arrays.number[BEST]:
            arrays.number[BEST], arrays.best[:] = arrays.number[COST], sites
        self._ask_for_all()

    def go(self, chunk: int, hot: float, cold: float) -> None:
        walk_by_chains(self._kernel_tables, self._state, self.work + chunk, hot, cold)

    def stands_on(self) -> Ints:
        return self.arrays.stood[1:-1].astype(np.int64)

    def _ask_for_all(self) -> None:
        """Let every arc be looked at."""
        arrays = self.arrays
        arrays.queue[:] = arrays.line[:-1]
        arrays.waits[:] = True
        arrays.number[FRONT], arrays.number[QUEUED] = 0, len(arrays.queue)


# Steps of a chain: an arc is broken, two near ones are made, two more are broken, and one arc closes the line.
#
# Arcs a → a', b → b', c → c', in this order along the line, become a → b', c → a', b → c': two stretches change
# places and none is turned round (Gambardella and Dorigo 2000). Whichever of the three is broken first, x → x' say,
# and y is where the first new arc leads: x → y, then from y's predecessor z → w, then w's predecessor v → x'.


@compiled
def arc(tables: ChainTables, a: int, b: int) -> int:
    """Reduced cost of the arc a → b."""
    return int(np.int64(tables.cost[a, b]))


@compiled
def arrival(tables: ChainTables, state: ChainState, contour: int) -> int:
    """The place where a contour stands; home as the end of the line."""
    return tables.n + 1 if contour == tables.n else int(np.int64(state.place[contour]))


@compiled
def stretches(p: int, q: int, c: int) -> tuple[int, int, int]:
    """The places i, j, k of the swap that makes the arcs p → q, q - 1 → c and c - 1 → p + 1; i = 0 if there is none."""
    if q > p + 1:
        if c > q:
            return p + 1, q, c
        if 1 <= c <= p:
            return c, p + 1, q
    elif 1 <= q < c <= p:
        return q, c, p + 1
    return 0, 0, 0


@compiled
def find_steps(tables: ChainTables, state: ChainState, depth: int, p: int, saved: int) -> int:
    """The best lawful steps that break the arc out of place p; answers how many there are.

    `saved` is what broken arcs cost more than made ones, with the arc at p broken. It stays above zero on the way.
    Steps that may end the chain with a gain come first, then those that save most.
    """
    line, near, near_in = state.line, tables.near, tables.near_in
    x, follows = line[p], line[p + 1]
    found = 0
    for e in range(near.shape[1]):
        y = near[x, e]
        if y < 0 or arc(tables, x, y) >= saved:
            break
        q = arrival(tables, state, y)
        if q == p + 1:
            continue
        z = line[q - 1]
        after = saved - arc(tables, x, y) + arc(tables, z, y)
        for f in range(near.shape[1]):
            w = near[z, f]
            if w < 0 or arc(tables, z, w) >= after:
                break
            found = _consider(tables, state, depth, found, p, q, arrival(tables, state, w), after)
        for f in range(near_in.shape[1]):
            v = near_in[follows, f]
            if v >= 0:
                found = _consider(tables, state, depth, found, p, q, int(np.int64(state.place[v])) + 1, after)
        for size in range(1, SHORT + 1):
            found = _consider(tables, state, depth, found, p, q, q + size, after)
            found = _consider(tables, state, depth, found, p, q, p + 1 - size, after)
    return found


@compiled
def _consider(
    tables: ChainTables, state: ChainState, depth: int, found: int, p: int, q: int, c: int, after: int
) -> int:
    """Note the step that breaks the arc into place c as well, if it is lawful and one of the best; answers how many."""
    state.number[WORK] += PER_ARC
    most = BREADTH[depth]
    i, j, k = stretches(p, q, c)
    if i == 0 or k > tables.n + 1:
        return found
    line = state.line
    v, w = line[c - 1], line[c]
    made, closing = arc(tables, line[q - 1], w), arc(tables, v, line[p + 1])
    freed = after - made + arc(tables, v, w)
    if made >= after or closing >= UNLAWFUL:
        return found
    if found == most and _rank(freed, closing) <= _rank_at(state, depth, most - 1):
        return found
    for at in range(found):
        if state.swap[depth, at, 0] == i and state.swap[depth, at, 1] == j and state.swap[depth, at, 2] == k:
            return found
    state.number[WORK] += min(j - i, k - j)
    if not may_swap(tables.orders, line, state.place, i, j, k):
        return found
    found = min(found + 1, most)
    _note_step(state, depth, found - 1, i, j, k, freed, closing)
    return found


@compiled
def _rank(freed: int, closing: int) -> int:
    return freed + UNLAWFUL * 8 if freed > closing else freed


@compiled
def _rank_at(state: ChainState, depth: int, at: int) -> int:
    return _rank(state.freed[depth, at], state.closing[depth, at])


@compiled
def _note_step(state: ChainState, depth: int, last: int, i: int, j: int, k: int, freed: int, closing: int) -> None:
    """Put a step in its place among the first `last` at this depth."""
    at = last
    while at > 0 and _rank_at(state, depth, at - 1) < _rank(freed, closing):
        for part in range(3):
            state.swap[depth, at, part] = state.swap[depth, at - 1, part]
        state.freed[depth, at] = state.freed[depth, at - 1]
        state.closing[depth, at] = state.closing[depth, at - 1]
        at -= 1
    state.swap[depth, at, 0], state.swap[depth, at, 1], state.swap[depth, at, 2] = i, j, k
    state.freed[depth, at], state.closing[depth, at] = freed, closing


@compiled
def swap(state: ChainState, i: int, j: int, k: int) -> None:
    """Swap two stretches of the trial."""
    swap_places(state.line, state.place, state.spare, i, j, k)
    state.number[LOW] = min(state.number[LOW], i)
    state.number[HIGH] = max(state.number[HIGH], k)
    state.number[WORK] += PER_SWAP + k - i


@compiled
def take_step(state: ChainState, depth: int, at: int) -> None:
    """Take a step, and note after whom it makes arcs."""
    i, j, k = state.swap[depth, at, 0], state.swap[depth, at, 1], state.swap[depth, at, 2]
    state.tail[depth, 0], state.tail[depth, 1], state.tail[depth, 2] = (
        np.int64(state.line[i - 1]),
        np.int64(state.line[j - 1]),
        np.int64(state.line[k - 1]),
    )
    swap(state, i, j, k)


@compiled
def take_back(state: ChainState, depth: int, at: int) -> None:
    """Undo a step."""
    i, j, k = state.swap[depth, at, 0], state.swap[depth, at, 1], state.swap[depth, at, 2]
    swap(state, i, i + k - j, k)


# A chain of steps that makes the line cheaper, found by trying the best few at each place and going back.


@compiled
def enqueue(state: ChainState, contour: int) -> None:
    """Ask for the arc after a contour to be looked at."""
    if not state.waits[contour]:
        state.waits[contour] = True
        size = len(state.waits)
        state.queue[(state.number[FRONT] + state.number[QUEUED]) % size] = contour
        state.number[QUEUED] += 1


@compiled
def improve_all(tables: ChainTables, state: ChainState) -> None:
    """Improve the trial until no chain from a contour in the queue makes it cheaper."""
    size = len(state.waits)
    while state.number[QUEUED] > 0:
        contour = state.queue[state.number[FRONT]]
        state.number[FRONT] = (state.number[FRONT] + 1) % size
        state.number[QUEUED] -= 1
        state.waits[contour] = False
        state.number[WORK] += PER_CONTOUR
        while improve(tables, state, contour):
            pass


@compiled
def improve(tables: ChainTables, state: ChainState, contour: int) -> bool:
    """Make the trial cheaper by a chain that begins with the arc after a contour; False if none was found."""
    p = int(np.int64(state.place[contour]))
    follows = int(np.int64(state.line[p + 1]))
    saved = arc(tables, contour, follows)
    if saved <= 0:
        return False
    at, count = state.trying, state.known
    depth = 0
    at[0], count[0] = -1, find_steps(tables, state, 0, p, saved)
    while depth >= 0:
        if at[depth] >= 0:
            take_back(state, depth, at[depth])
        at[depth] += 1
        if at[depth] == count[depth]:
            depth -= 1
            continue
        take_step(state, depth, at[depth])
        freed, closing = state.freed[depth, at[depth]], state.closing[depth, at[depth]]
        if freed > closing:
            state.number[COST] -= freed - closing
            for taken in range(depth + 1):
                for part in range(3):
                    enqueue(state, state.tail[taken, part])
            return True
        if depth + 1 < DEPTH:
            depth += 1
            p = arrival(tables, state, follows) - 1
            at[depth], count[depth] = -1, find_steps(tables, state, depth, p, freed)
    return False


# The walk by chains: a kick, chains until none is left that gains, and on from there or back, as it gets cooler.


@entry
def walk_by_chains(tables: ChainTables, state: ChainState, until: int, hot: float, cold: float) -> None:
    """Search until `number[WORK]` reaches `until`; the temperature falls from `hot` to `cold` on the way.

    First all arcs of the trial are looked at, if that was not done yet.
    """
    _begin_trial(tables, state)
    improve_all(tables, state)
    _settle(tables, state, state.number[COST])
    start = state.number[WORK]
    while state.number[WORK] < until:
        done = (state.number[WORK] - start) / (until - start)
        temperature = hot * (cold / hot) ** done
        was = state.number[COST]
        limit = was - temperature * np.log(1.0 - draw_share(state.random))
        _begin_trial(tables, state)
        for _ in range(KICKS):
            _kick(tables, state)
        improve_all(tables, state)
        if state.number[COST] <= limit:
            _settle(tables, state, state.number[COST])
        else:
            _go_back(state)
            state.number[COST] = was


@compiled
def _begin_trial(tables: ChainTables, state: ChainState) -> None:
    state.number[LOW], state.number[HIGH] = tables.n + 1, 0
    state.number[WORK] += PER_KICK


@compiled
def _kick(tables: ChainTables, state: ChainState) -> None:
    """A random step that makes a near arc or two, whatever the others cost."""
    line, near = state.line, tables.near
    for _ in range(DRAWS):
        p = below(state.random, tables.n + 1)
        x, follows = line[p], line[p + 1]
        y = near[x, below(state.random, min(WIDTH, near.shape[1]))]
        if y < 0:
            continue
        q = arrival(tables, state, y)
        c = _third(tables, state, p, q)
        i, j, k = stretches(p, q, c)
        if i == 0 or k > tables.n + 1:
            continue
        z, v, w = line[q - 1], line[c - 1], line[c]
        if arc(tables, z, w) >= UNLAWFUL or arc(tables, v, follows) >= UNLAWFUL:
            continue
        if not may_swap(tables.orders, line, state.place, i, j, k):
            continue
        state.number[COST] += (
            arc(tables, x, y)
            + arc(tables, z, w)
            + arc(tables, v, follows)
            - arc(tables, x, follows)
            - arc(tables, z, y)
            - arc(tables, v, w)
        )
        for tail in (x, z, v):
            enqueue(state, int(np.int64(tail)))
        swap(state, i, j, k)
        return


@compiled
def _third(tables: ChainTables, state: ChainState, p: int, q: int) -> int:
    """Where a kick breaks the third arc: such that another arc is a near one, or that a short stretch moves."""
    kind = below(state.random, 4)
    if kind == 0:
        w = tables.near[state.line[q - 1], below(state.random, min(WIDTH, tables.near.shape[1]))]
        return arrival(tables, state, w) if w >= 0 else 0
    if kind == 1:
        v = tables.near_in[state.line[p + 1], below(state.random, min(WIDTH, tables.near_in.shape[1]))]
        return int(np.int64(state.place[v])) + 1 if v >= 0 else 0
    size = 1 + below(state.random, LONGEST)
    return q + size if kind == 2 else p + 1 - size


@compiled
def _settle(tables: ChainTables, state: ChainState, cost: int) -> None:
    """Stand on the trial, and keep it if it is the best."""
    for p in range(state.number[LOW], state.number[HIGH]):
        state.stood[p] = state.line[p]
    if state.number[BEST] < 0 or cost < state.number[BEST]:
        state.number[BEST] = cost
        for p in range(tables.n):
            state.best[p] = state.line[p + 1]


@compiled
def _go_back(state: ChainState) -> None:
    """Make the trial the route we stand on again."""
    for p in range(state.number[LOW], state.number[HIGH]):
        contour = state.stood[p]
        state.line[p] = contour
        state.place[contour] = p
