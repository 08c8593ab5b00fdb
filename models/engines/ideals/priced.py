"""Stretches under the multipliers of linear programs: few states are left that a plan near the best can have.

Each stretch is a network (`bounds.network`): last contours of blocks stand for the others, and sites are split by what
their conditions ask. What the multipliers of its linear program leave of the cost of moves, a *low*, adds up along a
plan, on top of the bound: so it says of every state, by how it was come to, what the whole plan costs at least. What is
still to come of it is bounded by walks. From the last stretch to the first each program ends at what the next one
still costs by the site that it is begun with, as a sweep of that one backwards has found it.

What moves cost for what they cross, the programs have where it is out in every order with the move. For what depends on
the order a plan pays more than they say: sweeps to the end, which know what is out, charge it.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from kerfwise.arrays import Bools, Ints
from kerfwise.models.engines import bounds
from kerfwise.models.engines.bounds.moves import Moves, open_crossings
from kerfwise.models.engines.bounds.passages import best_way, passages_of
from kerfwise.models.engines.bounds.reduced import Proving, Reduced, entering, reduced
from kerfwise.models.engines.solution import Incumbent, Progress
from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.statements import About

from .alone import FAR, alone, conditions_within, ends_of
from .backward import Settled, settle
from .budget import SweepBudget, TooLarge
from .by_contour import ByContour
from .crossed import HOME, add_settled, crossing_price
from .held import held
from .kernels import Costs
from .lattice import SweptLayer, SweptStretch, sweep_layers, walk_back
from .local import Local, localise
from .over import Over
from .rest_bound import RestBound
from .series import series
from .stretches import entrance_of, home_from, never, table_of, travel_between
from .ways_over import crossing_within, ways_over

if TYPE_CHECKING:
    from kerfwise.models.engines.bounds import Completion

ABOUT = About("network", (), "what a site asks that is split by its conditions")
WALKS = 0.05
"""Share of the work that bounds by walks may take."""
MOST_NEIGHBOURS = 3
"""What a walk remembers at the most."""
ROOM = 0.0005
"""By what share of a plan the next limit is higher where a stretch has no way up to what it promised."""
UNSURE = 0.01
"""By what share of a plan an end must be better from which plans may cost more than is known."""
SEVERAL = 3.0
"""A sweep backwards may take as many times its even share of what is left, as most need little."""


@dataclass(frozen=True, eq=False, slots=True)
class Priced:
    """A stretch as a network, `posed`, whose sites are `sites` of the whole problem.

    `apart` is the stretch as a problem, with sites `own` of the whole problem. It may be come to from the sites `ways`,
    at `entry` (ways, sites), `lows` (ways, sites) of it beyond what the bound says. `settled` is what plans cost from
    there to their end at least, and how far that is exact. `rest` is what is still to come of `lows`, `over` what moves
    cost for what is out.
    """

    apart: Problem
    own: Ints
    relaxed: Reduced
    posed: Problem
    sites: Ints
    ways: Ints
    travel: Ints
    entry: Ints
    lows: Ints
    settled: Settled
    rest: Completion
    over: Over

    @property
    def onward(self) -> Ints:
        """What plans cost from every way in to their end at least, (ways,)."""
        return self.settled.onward

    @property
    def nbytes(self) -> int:
        """What its tables take."""
        apart, posed, relaxed, network = self.apart, self.posed, self.relaxed, self.relaxed.network
        problems = [(some.before, some.matrix, some.site_cost) for some in (apart, posed)]
        programs = relaxed.dear, network.cost, network.sooner, network.later, relaxed.by.multipliers, relaxed.by.beside
        return held((problems, programs, self.travel, self.entry, self.lows, self.onward, self.rest, self.over))

    def rests(self, depth: int) -> RestBound:
        """What is still to come after so many contours of the network."""
        return RestBound(np.ascontiguousarray(self.rest.to_go[depth]), self.rest.near, self.rest.price, 0.0)

    def swept(self, ways: Ints, costs: Costs, limit: int, budget: SweepBudget, threads: Executor) -> SweptPart:
        """It swept from some of its ways in, which it costs so much to come to, for plans of no more than `limit`.

        Raises
        ------
        TooLarge
            Over the budget.
        """
        local = localise(self.posed, tuple(range(self.posed.n)), frozenset())
        stretch = _stretch(self, local, np.searchsorted(self.ways, ways), limit)
        lows = np.minimum(costs + np.int64(self.relaxed.bound), stretch.never).astype(costs.dtype)
        costs = np.where(lows > limit, stretch.never, costs).astype(costs.dtype)
        layers = sweep_layers(stretch, costs, budget, threads, lows)
        return SweptPart(self, stretch, layers, ways, self.sites[local.sites_of(layers[-1].contour)])


@dataclass(frozen=True, eq=False, slots=True)
class PricedStretches:
    """All stretches of a problem, `root` being what every plan costs at least."""

    problem: Problem
    stretches: list[Priced]
    work: float

    @property
    def root(self) -> float:
        """What every plan costs at least."""
        return float(self.stretches[0].onward.min())

    @property
    def found(self) -> tuple[Found, ...]:
        """All that a later proof takes over of every stretch."""
        return tuple(Found(stretch.relaxed.by, stretch.entry, stretch.settled) for stretch in self.stretches)

    @property
    def nbytes(self) -> int:
        """What the tables take."""
        return sum(stretch.nbytes for stretch in self.stretches)

    def sweep(self, limit: int | None, budget: SweepBudget, threads: Executor) -> Incumbent | None:
        """The best route of all that cost no more than `limit`; None where there is none.

        Raises
        ------
        TooLarge
            Over the budget.
        """
        assert limit is not None  # a plan is known
        swept: list[SweptPart] = []
        ways, costs = np.array([HOME]), entrance_of([0], limit)
        for here in self.stretches:
            swept.append(here.swept(ways, costs, limit, budget, threads))
            ways, costs = swept[-1].ends, swept[-1].costs
            if not (costs < never(limit)).any():
                return None
        total = costs + self._home(ways)
        best = int(np.argmin(total))
        if total[best] > limit:
            return None
        route: list[int] = []
        state = best
        for part in reversed(swept):
            piece, state = part.back(state)
            route = [*piece, *route]
        cost = route_cost(self.problem, tuple(route))
        if cost != total[best]:
            raise TooLarge  # the tables do not say what plans cost: nothing is proven by them
        return Incumbent(tuple(route), cost)

    def descend(self, known: int, budget: SweepBudget, threads: Executor) -> Incumbent | None:
        """A route through one stretch after the other, each the best from where the last one ended by what is to come.

        None where it would cost more than a plan that is `known`.

        Raises
        ------
        TooLarge
            Over the budget.
        """
        route: list[int] = []
        way, cost = HOME, 0
        for number, here in enumerate(self.stretches):
            room, found = 0, False
            while not found:
                limit = cost + int(here.onward[np.searchsorted(here.ways, way)]) + room
                if limit > known:
                    return None
                once = replace(budget)  # nothing is kept of the layers
                part = here.swept(np.array([way]), entrance_of([cost], limit), limit, once, threads)
                total = part.costs + self._onward(number, part.ends)
                found = bool(total.min(initial=never(limit)) <= limit)
                room = max(2 * room, int(ROOM * known), 1)
            unsure = int(UNSURE * known) * self._unsure(number, part.ends)
            best = int(np.argmin(np.where(part.costs >= never(limit), FAR, total + unsure)))
            cost, way = int(part.costs[best]), int(part.ends[best])
            route += part.back(best)[0]
        return Incumbent(tuple(route), route_cost(self.problem, tuple(route)))

    def _home(self, ends: Ints) -> Ints:
        """What the way home costs from such ends; a site is there once for each of its splits."""
        leave, of_site = np.unique(ends, return_inverse=True)
        home: Ints = home_from(self.problem, leave)[of_site]
        return home

    def _unsure(self, number: int, ends: Ints) -> Bools:
        """Whether plans may cost more from such ends of a stretch on than is known."""
        if number + 1 == len(self.stretches):
            return np.zeros(len(ends), dtype=np.bool_)
        return self._onward(number, ends) > self.stretches[number + 1].settled.limit

    def _onward(self, number: int, ends: Ints) -> Ints:
        """What plans cost at least from such ends of a stretch on."""
        if number + 1 == len(self.stretches):
            return self._home(ends)
        following = self.stretches[number + 1]
        least: Ints = following.onward[np.searchsorted(following.ways, ends)]
        return least


@dataclass(frozen=True, eq=False, slots=True)
class SweptPart:
    """A stretch that was come to from the sites `ways`, and left at `ends`, in the order of its last layer."""

    here: Priced
    stretch: SweptStretch
    layers: list[SweptLayer]
    ways: Ints
    ends: Ints

    @property
    def costs(self) -> Costs:
        """What it costs to come to every end."""
        return self.layers[-1].values

    def back(self, state: int) -> tuple[list[int], int]:
        """The sites of a best way to an end, with those inside of blocks, and the number of the way in it took."""
        columns, row = walk_back(self.stretch, self.layers, state)
        return _with_inner(self.here, columns, int(self.ways[row])), row


class Found(NamedTuple):
    """What was found out of a stretch: multipliers, and what plans cost from its ways in on, come to at `entry`."""

    by: Proving
    entry: Ints
    settled: Settled


def price(
    problem: Problem, incumbent: Incumbent, work: float, progress: Progress | None, most_bytes: float,
    earlier: Sequence[Found] = (), swept: float = 0.0,
) -> PricedStretches | None:  # fmt: skip
    """Solve the linear program of every stretch, the last first, and sweep it backwards.

    Parameters
    ----------
    incumbent
        A lawful plan.
    work, swept
        Limits in deterministic seconds, of all programs and of all sweeps backwards.
    earlier
        What was found of the same problem with fewer statements: it stays where a stretch is as it was.

    Returns
    -------
    None where that cannot be had within the work or the memory.
    """
    groups = series(problem)
    weight = np.array([float(np.diff(problem.first)[list(group)].sum()) ** 2 for group in groups])
    until = np.cumsum([len(group) for group in groups]).tolist()
    parts = ByContour(problem)

    def in_time() -> bool:
        return progress is None or progress("ideals", incumbent.cost, None)

    found: list[Priced] = []
    spent, swept_left, left_bytes = 0.0, swept, most_bytes
    for k in reversed(range(len(groups))):
        share = (work - spent) * float(weight[k] / weight[: k + 1].sum())
        before = ends_of(problem, groups[k - 1])[1] if k else np.array([HOME])
        out = frozenset(c for group in groups[:k] for c in group)
        route = incumbent.route[until[k] - len(groups[k]) : until[k]]
        known = earlier[k] if len(earlier) == len(groups) else None
        onward = found[-1].onward if found else home_from(problem, ends_of(problem, groups[k])[1])
        asked = _Asked(parts.of(groups[k]), groups[k], before, out, onward, known)
        here, took = asked.priced(route, incumbent.cost, share, progress, left_bytes)
        spent += took
        if here is None:
            return None
        left_bytes -= here.nbytes
        if left_bytes < 0.0:
            return None
        if swept > 0.0:
            most = SweepBudget.of(swept_left * (SEVERAL / (k + SEVERAL)), in_time, left_bytes)
            settled = settle(here.posed, here.relaxed, here.entry, here.settled, incumbent.cost, most)
            swept_left -= settled.work
            here = replace(here, settled=settled)
        found.append(here)
    return PricedStretches(problem, found[::-1], spent + swept - swept_left)


@dataclass(frozen=True, eq=False, slots=True)
class _Asked:
    """A stretch that is to be priced, come to from the sites `before` once all of `earlier` is out.

    Plans cost `onward` from each site that it may end with, at least.
    """

    problem: Problem
    group: tuple[int, ...]
    before: Ints
    earlier: frozenset[int]
    onward: Ints
    known: Found | None

    def priced(
        self, route: Sequence[int], known: int, work: float, progress: Progress | None, most_bytes: float
    ) -> tuple[Priced | None, float]:
        """It under its multipliers, and the deterministic seconds that took; a lawful plan has `route` there."""
        problem, own = self.problem, self.problem.sites_of(self.group)
        leave = ends_of(problem, self.group)[1]
        travel = travel_between(problem, self.before, own)
        add_settled(problem, self.earlier, self.before, own, travel)
        travel = np.minimum(travel, FAR)
        apart = alone(problem, self.group, own, travel.min(axis=0), leave, np.minimum(self.onward, FAR))
        apart = replace(apart, conditions=tuple(conditions_within(problem, self.group, own, self.earlier)))
        apart = crossing_within(problem, self.group, own, self.earlier, apart)
        plan = tuple(np.searchsorted(own, route).tolist())
        of_plan = Incumbent(plan, route_cost(apart, plan))
        relaxed = reduced(apart, of_plan, known, (1.0 - WALKS) * work, progress, self.known and self.known.by)
        if relaxed is None:
            return None, work
        posed = _posed(relaxed)
        target = float(max(1, of_plan.cost - relaxed.bound))
        walked = replace(posed, matrix=relaxed.dear, conditions=())
        rest = bounds.complete(walked, target, WALKS * work, progress, MOST_NEIGHBOURS, most_bytes)
        entry = entering(relaxed.network, travel)
        enter = np.minimum(relaxed.network.cost[-1, :-1], FAR).astype(np.int64)
        lows = np.minimum(relaxed.dear[-1, :-1] + entry - enter, FAR)
        to_come = np.floor(np.minimum(rest.after_first(posed.site_contour), FAR)).astype(np.int64)
        least = relaxed.bound + (lows + to_come).min(axis=1)
        sites = own[relaxed.network.sites]
        settled = Settled(least, 0)
        if self.known is not None and self._as_it_was(self.known, relaxed, entry):
            settled = replace(self.known.settled, onward=np.maximum(least, self.known.settled.onward))
        over = ways_over(apart, relaxed.network, relaxed.dear[:-1, :-1] <= known - relaxed.bound)
        here = Priced(apart, own, relaxed, posed, sites, self.before, travel, entry, lows, settled, rest, over)
        return here, relaxed.work + rest.work

    def _as_it_was(self, known: Found, relaxed: Reduced, entry: Ints) -> bool:
        """Whether all costs are what they were, those of coming to the stretch and leaving it included."""
        return (
            relaxed.by.multipliers is known.by.multipliers
            and np.array_equal(entry, known.entry)
            and np.array_equal(relaxed.network.cost, known.by.network.cost)
        )


def _posed(relaxed: Reduced) -> Problem:
    """A network as a problem: a split of a site holds where what it asks is so."""
    network, problem = relaxed.network, relaxed.network.problem
    hard = []
    for site in range(problem.m):
        i = int(problem.site_contour[site])
        out = np.flatnonzero(network.sooner[site] & ~problem.before[:, i]).tolist()
        still = np.flatnonzero(network.later[site] & ~problem.before[i]).tolist()
        if out or still:
            weights = (1,) * len(out) + (-1,) * len(still)
            hard.append(Condition(i, (*out, *still), weights, len(out), ABOUT, site))
    matrix = np.minimum(network.cost, FAR).astype(np.int64)
    none = np.zeros_like(problem.site_cost)
    return replace(problem, site_cost=none, matrix=matrix, conditions=(*problem.conditions, *hard))


def _stretch(here: Priced, local: Local, row: Ints, limit: int) -> SweptStretch:
    """A stretch to be swept, entered from these rows of its ways."""
    inside = here.posed.matrix
    assert inside is not None
    moves = table_of(local, np.concatenate([here.entry[row], inside[:-1, :-1]]), limit)
    dear = table_of(local, np.concatenate([here.lows[row], here.relaxed.dear[:-1, :-1]]), limit)
    return SweptStretch(local, moves, here.rests, limit, never(limit), dear, here.over)


def _with_inner(here: Priced, columns: Sequence[int], way: int) -> list[int]:
    """The sites of the whole problem on a way through a network from site `way`, with those inside of blocks."""
    apart, moves = here.apart, Moves(here.apart)
    of_last = {passage.last: passage for passage in passages_of(apart)}
    route: list[int] = []
    price = crossing_price(apart)
    for site in here.relaxed.network.sites[list(columns)].tolist():
        passage = of_last.get(int(apart.site_contour[site]))
        if passage is not None:
            inner = apart.sites_of(passage.inner)
            if route:
                entered = moves.between(np.array(route[-1:]), inner)[0]
                entered += price * _crossed(apart, route, inner)
            else:
                entered = here.travel[int(np.searchsorted(here.ways, way)), inner].astype(np.float64)
            route += best_way(apart, passage, moves, entered, site)
        route.append(site)
    return [int(here.own[site]) for site in route]


def _crossed(apart: Problem, route: Sequence[int], inner: Ints) -> Ints:
    """How many contours of a route the moves from its last site to each of some others cross, if the order decides."""
    rows = apart.crossings
    is_out = np.zeros(apart.n, dtype=np.bool_)
    is_out[apart.site_contour[list(route)]] = True
    rows = rows.only((rows.leave == route[-1]) & is_out[rows.over])
    rows = rows.only(open_crossings(replace(apart, crossings=rows)))
    return np.bincount(rows.reach, minlength=apart.m)[inner]
