"""Annealing: ruin and recreate or exchange, choose sites, go on from there or back, while the temperature falls."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Ints
from kerfwise.models.engines.search.moves.exchanges import swap_towards, three_opt
from kerfwise.models.engines.search.moves.insertion import choose_sites, nearest_first, refresh_sites
from kerfwise.models.engines.search.moves.ruin_recreate import recreate, ruin
from kerfwise.models.engines.search.state.chains import chains_made
from kerfwise.models.engines.search.state.conditions import (
    lean_on_sites,
    literals_unmet,
    pieces_begun,
    too_close_within,
    too_soon,
    unmet,
)
from kerfwise.models.engines.search.state.jit_tools import below, compiled, draw_share, entry
from kerfwise.models.engines.search.state.route_state import (
    BEST,
    BROKEN,
    CLIMBS,
    COST,
    LAWLESS,
    LENGTH,
    PRICE,
    START,
    TAKEN,
    TRADED,
    TRADES,
    TRIES,
    WHOLE,
    WHOLE_BROKEN,
    WORK,
    YES,
    SearchTables,
    State,
    new_state,
)
from kerfwise.models.engines.search.state.travel import cell_of, crossing, leg
from kerfwise.models.engines.tuning import ANNEAL_COLD as COLD
from kerfwise.models.engines.tuning import ANNEAL_FALL as FALL
from kerfwise.models.engines.tuning import ANNEAL_LONG as LONG
from kerfwise.models.engines.tuning import ANNEAL_LOOKS as LOOKS
from kerfwise.models.engines.tuning import ANNEAL_MOST as MOST
from kerfwise.models.engines.tuning import ANNEAL_MUCH as MUCH
from kerfwise.models.engines.tuning import ANNEAL_STEP as STEP
from kerfwise.models.engines.tuning import EXCHANGES, FEW_RUINS, FORCED, HOT, JUDGE, LIVELY, LOOK, PER_TRIAL, RUINS
from kerfwise.models.kernel_struct import kernel_argument
from kerfwise.models.problem.moves import LAWFUL_MOST, UNLAWFUL

from .walker import Walker

# A walker that anneals by ruins and exchanges: for every problem.


class AnnealingWalker(Walker):
    """See `Walker`; `tables` is the problem as kernels take it, random numbers come from `seed`."""

    def __init__(
        self, tables: SearchTables, fields: SearchTables, seed: tuple[int, ...], like: Walker | None = None
    ) -> None:
        self.arrays = new_state(fields, seed)
        super().__init__(fields, self.arrays, like)
        self._tables = tables
        self._state = kernel_argument(self.arrays)
        self.arrays.number[PRICE] = 1

    def stands_on(self) -> Ints:
        return self.arrays.site_now[self.arrays.order_now]

    def start(self) -> None:
        number = self.arrays.number
        if number[LENGTH] == 0:
            self._walk(FROM_NOTHING)
        number[PRICE] = 1 + 10 * int(number[COST]) // self._fields.legs.n

    def descend(self, chunk: int) -> None:
        self.go(chunk, 1.0, 1.0)

    def measure(self, most: int) -> None:
        if self._fields.arcs.plain:
            self._hot = self._lively(max(1, min(LOOK, most // LOOKS)))
            self._cold = self._hot / FALL
            return
        rises = self.arrays.climb[: self.arrays.number[CLIMBS]]
        rise = max(1.0, float(np.median(rises))) if len(rises) else 1.0
        self._hot, self._cold = HOT * rise, COLD * rise

    def stand_on(self, sites: NDArray[np.int64]) -> None:
        self.arrays.order[:] = self._fields.legs.contour[sites]
        self.arrays.position[self.arrays.order] = np.arange(len(sites))
        self.arrays.site[self.arrays.order] = sites
        self._walk(FROM_TRIAL)

    def go(self, chunk: int, hot: float, cold: float) -> None:
        self._walk(ON, self.work + chunk, hot, cold)

    def _walk(self, begins: int, until: int = 0, hot: float = 1.0, cold: float = 1.0) -> None:
        """See `walk`."""
        on = walk_plain if self._fields.arcs.plain else walk
        on(self._tables, self._state, begins, until, hot, cold)

    def _lively(self, look: int) -> float:
        """The temperature at which `LIVELY` of the exchanges are taken and change the cost, by looks of that length."""
        number, arcs = self.arrays.number, self._fields.arcs
        near = np.take_along_axis(arcs.cost, arcs.near, axis=1)
        temperature = 1.0 + 4.0 * float(np.median(near))
        for _ in range(LOOKS):
            tried, taken = int(number[TRADES]), int(number[TRADED])
            self.go(look, temperature, temperature)
            if number[TRADED] - taken < LIVELY * (number[TRADES] - tried):
                break
            temperature /= STEP
        return temperature


# What a stretch of a full sequence costs, to the µm as `evaluate.route_cost` has it.


@compiled
def span_price(tables: SearchTables, order: Ints, position: Ints, site: Ints, lo: int, hi: int) -> tuple[int, int]:
    """Cost, and number of hard statements broken, of all that positions `lo` … `hi - 1` have a part in.

    Two sequences that differ in this span alone differ in cost by what this and `whole_price` differ.
    """
    legs, demands, crossed, groups, lags = tables.legs, tables.demands, tables.crossed, tables.groups, tables.lags
    conditional, crossable = len(demands.contour) > 0, len(crossed.over) > 0
    cost, broken = 0, 0
    last = legs.m if lo == 0 else site[order[lo - 1]]
    for p in range(lo, hi + 1):
        s = legs.m if p == legs.n else site[order[p]]
        move = leg(legs, last, s)
        if move > LAWFUL_MOST:
            move, broken = move - UNLAWFUL, broken + 1
        cost += move
        if crossable:
            cell = cell_of(crossed, last * (legs.n + 1) + legs.contour[s])
            if cell >= 0:
                more, worse = crossing(crossed, cell + s - legs.first[legs.contour[s]], position, p)
                cost, broken = cost + more, broken + worse
        last = s
        if p == hi:
            break
        cost += legs.site_cost[s]
        if conditional:
            c = order[p]
            more, worse = unmet(demands, demands.of_contour[c], demands.of_contour[c + 1], position, p)
            cost, broken = cost + more, broken + worse
            more, worse = unmet(demands, demands.of_site[s], demands.of_site[s + 1], position, p)
            cost, broken = cost + more, broken + worse
    if len(groups.of) > 0:
        for p in range(lo, min(hi + 1, legs.n)):
            cost += pieces_begun(groups, order[p], order[p - 1] if p > 0 else -1)
    if len(lags.other) > 0:
        for p in range(lo, hi):
            more, worse = too_close_within(lags, order[p], position, hi)
            cost, broken = cost + more, broken + worse
    return cost, broken


@compiled
def whole_price(tables: SearchTables, order: Ints, position: Ints, site: Ints, room: Ints) -> tuple[int, int]:
    """The same of what only the whole sequence tells; `room` is for a number a contour."""
    legs, lags = tables.legs, tables.lags
    cost, broken = chains_made(tables.chains, order, position)
    if len(lags.a) > 0:
        more, worse = too_soon(lags, legs, order, position, site, room)
        cost, broken = cost + more, broken + worse
    if len(tables.literals.bound) > 0:
        more, worse = literals_unmet(tables.literals, legs.contour, position, site)
        cost, broken = cost + more, broken + worse
    return cost, broken


DEAREST = 1 << 40  # the most that a broken statement counts, µm


ON, FROM_TRIAL, FROM_NOTHING = range(3)


@compiled
def _begin(tables: SearchTables, state: State, begins: int) -> None:
    """Make a first route to stand on, or stand on the route that is the trial."""
    if begins == FROM_NOTHING:
        nearest_first(tables, state)
    if begins != ON:
        _stand(tables, state, begins == FROM_NOTHING)


@entry
def walk(tables: SearchTables, state: State, begins: int, until: int, hot: float, cold: float) -> None:
    """Search until `number[WORK]` reaches `until`; the temperature, µm, falls from `hot` to `cold` on the way.

    It goes `ON`, or begins from the trial or from nothing first: one kernel, as two would share most of their code.
    """
    _begin(tables, state, begins)
    swaps = 1.0 - max(FEW_RUINS, RUINS * min(1.0, LONG / tables.legs.n))
    start = state.number[WORK]
    while state.number[WORK] < until:
        temperature = _temperature(state, start, until, hot, cold)
        limit = -temperature * np.log(1.0 - draw_share(state.random))
        if draw_share(state.random) < swaps:
            state.number[WORK] += 60
            if swap_towards(tables, state, limit):
                _settle(tables, state, YES, limit)
        else:
            change = _settle(tables, state, _shuffle(tables, state), limit)
            if change > 0:
                state.climb[state.number[CLIMBS] % len(state.climb)] = change
                state.number[CLIMBS] += 1
        _judge(state, temperature)


@entry
def walk_plain(tables: SearchTables, state: State, begins: int, until: int, hot: float, cold: float) -> None:
    """The same for plain problems, with exchanges of arcs; a kernel apart, as either takes seconds to compile."""
    _begin(tables, state, begins)
    start = state.number[WORK]
    while state.number[WORK] < until:
        temperature = _temperature(state, start, until, hot, cold)
        limit = -temperature * np.log(1.0 - draw_share(state.random))
        before = state.number[WORK]
        _settle(tables, state, _shuffle(tables, state), limit)
        three_opt(tables, state, temperature, EXCHANGES * (state.number[WORK] - before) // PER_TRIAL)
        _judge(state, temperature)


@compiled
def _temperature(state: State, start: int, until: int, hot: float, cold: float) -> float:
    """The temperature, µm, at the work done so far."""
    done = (state.number[WORK] - start) / (until - start)
    return float(hot * (cold / hot) ** done)


@compiled
def _shuffle(tables: SearchTables, state: State) -> bool:
    """Ruin and recreate the trial; False if its sites are to stay as they came out."""
    state.number[WORK] += 200
    kind = below(state.random, 8)
    kind = 0 if kind < 3 else 1 if kind < 5 else kind - 3
    ruin(tables.orders, state, kind, min(MOST, tables.legs.n))
    free = True
    if len(tables.literals.bound) > 0 or len(tables.lags.a) > 0:
        free = draw_share(state.random) > FORCED
        _force_a_site(tables, state, not free)
    chance = draw_share(state.random)
    apart = not free and len(tables.lags.a) > 0
    recreate(tables, state, MUCH if apart or chance >= 0.95 else 0.1 if chance >= 0.8 else 0.01)
    return free


@compiled
def _force_a_site(tables: SearchTables, state: State, force: bool) -> None:
    """Make a contour that is out take a random site, or none of them.

    Sites have a part in general statements, and in seconds between cuts, that choosing them by travel does not see.
    Those may need a detour by the sites of several contours.
    """
    state.forced[:] = -1
    if force:
        one, taken = below(state.random, state.number[TAKEN]), state.number[TAKEN]
        for k in range(taken):
            if k == one or (len(tables.lags.a) > 0 and below(state.random, taken) == 0):
                contour = state.out[k]
                start, stop = tables.legs.first[contour], tables.legs.first[contour + 1]
                state.forced[contour] = start + below(state.random, stop - start)
                state.site[contour] = state.forced[contour]


@compiled
def _settle(tables: SearchTables, state: State, choose: bool, limit: float) -> int:
    """Choose the sites of what has changed if asked to, and go on from the trial if it costs at most `limit` more.

    Answers by how much it changes the cost.
    """
    n = tables.legs.n
    lo, hi = START, n
    while lo < n and state.order[lo] == state.order_now[lo] and not state.stale[state.order[lo]]:
        lo += 1
    while hi > lo and state.order[hi - 1] == state.order_now[hi - 1] and not state.stale[state.order[hi - 1]]:
        hi -= 1
    if lo >= hi:
        return 0
    refresh_sites(tables, state, lo, hi, choose)
    state.number[WORK] += 200 + tables.legs.n + 10 * (hi - lo)
    cost, broken = span_price(tables, state.order, state.position, state.site, lo, hi)
    was, was_broken = span_price(tables, state.order_now, state.position_now, state.site_now, lo, hi)
    whole, whole_broken = whole_price(tables, state.order, state.position, state.site, state.time_ms)
    more = cost - was + whole - state.number[WHOLE]
    worse = broken - was_broken + whole_broken - state.number[WHOLE_BROKEN]
    change = more + worse * state.number[PRICE]
    if change > limit:
        _go_back(state, lo, hi)
        return int(change)
    _go_on(state, lo, hi)
    state.number[COST] += more
    state.number[BROKEN] += worse
    state.number[WHOLE], state.number[WHOLE_BROKEN] = whole, whole_broken
    _note(tables, state)
    return int(change)


@compiled
def _note(tables: SearchTables, state: State) -> None:
    """Keep the route we now stand on if it is the best lawful one, and see where general statements lean."""
    if state.number[BROKEN] == 0 and (state.number[BEST] < 0 or state.number[COST] < state.number[BEST]):
        state.number[BEST] = state.number[COST]
        for p in range(tables.legs.n):
            state.best[p] = state.site_now[state.order_now[p]]
    if len(tables.literals.bound) > 0:
        contour, price = tables.legs.contour, state.number[PRICE]
        lean_on_sites(tables.literals, contour, state.position_now, state.site_now, price, state.lean)


@compiled
def _judge(state: State, temperature: float) -> None:
    """Raise the price of unlawful routes if most of the last ones were unlawful, lower it if few were."""
    state.number[TRIES] += 1
    if state.number[BROKEN] > 0:
        state.number[LAWLESS] += 1
    if state.number[TRIES] % JUDGE == 0:
        price = state.number[PRICE]
        if 2 * state.number[LAWLESS] > JUDGE:
            state.number[PRICE] = min(price + price // 4 + 1, DEAREST)
        elif 8 * state.number[LAWLESS] < JUDGE:
            state.number[PRICE] = max(price - price // 8, np.int64(temperature) + 1)
        state.number[LAWLESS] = 0


@compiled
def _go_on(state: State, lo: int, hi: int) -> None:
    """Stand on the trial, which differs in positions `lo` … `hi - 1`."""
    for p in range(lo, hi):
        c = state.order[p]
        state.order_now[p] = c
        state.position_now[c] = p
        state.site_now[c] = state.site[c]


@compiled
def _go_back(state: State, lo: int, hi: int) -> None:
    """Make the trial the route we stand on again."""
    for p in range(lo, hi):
        c = state.order_now[p]
        state.order[p] = c
        state.position[c] = p
        state.site[c] = state.site_now[c]


@compiled
def _stand(tables: SearchTables, state: State, choose: bool) -> None:
    """Stand on the trial, a full sequence, after choosing the best sites for it if asked to."""
    n = tables.legs.n
    state.number[LENGTH] = n
    state.forced[:] = -1
    state.stale[:] = False
    if choose:
        choose_sites(tables, state, START, n)
    _go_on(state, START, n)
    cost, broken = span_price(tables, state.order, state.position, state.site, START, n)
    whole, whole_broken = whole_price(tables, state.order, state.position, state.site, state.time_ms)
    state.number[WHOLE], state.number[WHOLE_BROKEN] = whole, whole_broken
    for g in range(len(tables.groups.cost)):
        cost -= tables.groups.cost[g]
    state.number[COST], state.number[BROKEN] = cost + whole, broken + whole_broken
    _note(tables, state)
