"""Stretches under the multipliers of linear programs, swept for plans of no more than a limit, or one after the other.

A stretch alone tells what plans cost from each way into it on, see `priced`. A sweep through all of them knows what is
out, and charges what moves cost for that.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.sparse import csr_matrix

from kerfwise.arrays import Bools, Ints
from kerfwise.models.engines import bounds
from kerfwise.models.engines.bounds.move_costs import Moves, best_way, open_crossings, passages_of
from kerfwise.models.engines.bounds.reduced_costs import Proving, ReducedCosts
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.ideals.kernels import Costs
from kerfwise.models.engines.ideals.lattice import (
    THREADS,
    SweptLayer,
    SweptStretch,
    TooLarge,
    bytes_of,
    sweep_layers,
    walk_back,
)
from kerfwise.models.engines.ideals.stretch import CrossingAlternatives, Local, RestBound, localise, nothing_over
from kerfwise.models.engines.solution import Incumbent
from kerfwise.models.engines.tuning import BACKWARD_DEARER as DEARER
from kerfwise.models.engines.tuning import BACKWARD_FIRST as FIRST
from kerfwise.models.engines.tuning import BACKWARD_LITTLE as LITTLE
from kerfwise.models.engines.tuning import BACKWARD_MOST_NEIGHBOURS as MOST_NEIGHBOURS
from kerfwise.models.engines.tuning import BACKWARD_WIDER as WIDER
from kerfwise.models.engines.tuning import ROOM, SPREAD, UNSURE
from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.models.problem.problem import Problem

from .stretch_tables import FAR, HOME, crossing_price, entrance_of, home_from, never, table_of

if TYPE_CHECKING:
    from kerfwise.models.engines.bounds import Completion


class StretchPrices(NamedTuple):
    """What was found out of a stretch: multipliers, and what plans cost from its ways in on, come to at `entry`."""

    by: Proving
    entry: Ints
    settled: Settled


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
    relaxed: ReducedCosts
    posed: Problem
    sites: Ints
    ways: Ints
    travel: Ints
    entry: Ints
    lows: Ints
    settled: Settled
    rest: Completion
    over: CrossingAlternatives

    @property
    def onward(self) -> Ints:
        """What plans cost from every way in to their end at least, (ways,)."""
        return self.settled.onward

    @property
    def nbytes(self) -> int:
        """What its tables take."""
        apart, posed, relaxed, network = self.apart, self.posed, self.relaxed, self.relaxed.network
        problems = [(some.before, some.matrix, some.site_cost) for some in (apart, posed)]
        programs = relaxed.dear, network.cost, network.sooner, network.later, relaxed.by.multipliers
        return nbytes((problems, programs, self.travel, self.entry, self.lows, self.onward, self.rest, self.over))

    def rests(self, depth: int) -> RestBound:
        """What is still to come after so many contours of the network."""
        return RestBound(np.ascontiguousarray(self.rest.to_go[depth]), self.rest.near, self.rest.price, 0.0)

    def swept(
        self, ways: Ints, costs: Costs, limit: int, deadline: Deadline, threads: Executor, held: float = 0.0
    ) -> SweptPart:
        """It swept from some of its ways in, which it costs so much to come to, for plans of no more than `limit`.

        Stretches before it have `held` bytes of the deadline's. Raises TooLarge over the deadline.
        """
        local = localise(self.posed, tuple(range(self.posed.n)), frozenset())
        stretch = _stretch(self, local, np.searchsorted(self.ways, ways), limit)
        lows = np.minimum(costs + np.int64(self.relaxed.bound), stretch.never).astype(costs.dtype)
        costs = np.where(lows > limit, stretch.never, costs).astype(costs.dtype)
        layers = sweep_layers(stretch, costs, deadline, threads, lows, held=held)
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
    def found(self) -> tuple[StretchPrices, ...]:
        """All that a later proof takes over of every stretch."""
        return tuple(StretchPrices(stretch.relaxed.by, stretch.entry, stretch.settled) for stretch in self.stretches)

    @property
    def nbytes(self) -> int:
        """What the tables take."""
        return sum(stretch.nbytes for stretch in self.stretches)

    def sweep(self, limit: int | None, deadline: Deadline, threads: Executor) -> Incumbent | None:
        """The best route of all that cost no more than `limit`; None where there is none.

        Raises TooLarge over the deadline.
        """
        assert limit is not None  # a plan is known
        swept: list[SweptPart] = []
        ways, costs, held = np.array([HOME]), entrance_of([0], limit), 0.0
        for here in self.stretches:
            swept.append(here.swept(ways, costs, limit, deadline, threads, held))
            held += bytes_of(swept[-1].layers)
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

    def descend(self, known: int, deadline: Deadline, threads: Executor) -> Incumbent | None:
        """A route through one stretch after the other, each the best from where the last one ended by what is to come.

        None where it would cost more than a plan that is `known`. Raises TooLarge over the deadline.
        """
        route: list[int] = []
        way, cost = HOME, 0
        for number, here in enumerate(self.stretches):
            room, found = 0, False
            while not found:
                limit = cost + int(here.onward[np.searchsorted(here.ways, way)]) + room
                if limit > known:
                    return None
                part = here.swept(np.array([way]), entrance_of([cost], limit), limit, deadline, threads)
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


def _stretch(here: Priced, local: Local, row: Ints, limit: int) -> SweptStretch:
    """A stretch to be swept, entered from these rows of its ways."""
    inside = here.posed.matrix
    assert inside is not None
    moves = table_of(local, np.concatenate([here.entry[row], inside[:-1, :-1]]), limit)
    dear = table_of(local, np.concatenate([here.lows[row], here.relaxed.dear[:-1, :-1]]), limit)
    begin = np.append(np.zeros(len(row) * here.over.columns, dtype=np.int64), here.over.begin)  # ways in cross nothing
    return SweptStretch(local, moves, here.over._replace(begin=begin), here.rests, limit, never(limit), dear)


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


# Bytes of the arrays that something holds.


def nbytes(thing: object) -> int:
    """Bytes of all arrays that a thing of named fields holds, each counted once.

    Examples
    --------
    >>> some = np.zeros(10)
    >>> nbytes((some, [some[2:], np.zeros(2, np.int8)]))
    82
    """
    seen: dict[int, int] = {}
    for array in _arrays(thing, set()):
        whole = array
        while isinstance(whole.base, np.ndarray):
            whole = whole.base
        seen[id(whole)] = whole.nbytes
    return sum(seen.values())


def _arrays(thing: object, known: set[int]) -> Iterator[np.ndarray]:
    if isinstance(thing, np.ndarray):
        yield thing
    elif isinstance(thing, csr_matrix):
        yield from (thing.data, thing.indices, thing.indptr)
    elif id(thing) not in known:
        known.add(id(thing))
        inner: list[object] = []
        if is_dataclass(thing):
            inner = [getattr(thing, field.name) for field in fields(thing)]
        elif isinstance(thing, list | tuple):
            inner = list(thing)
        elif hasattr(thing, "__dict__"):
            inner = list(vars(thing).values())
        for one in inner:
            yield from _arrays(one, known)


if TYPE_CHECKING:
    from kerfwise.models.engines.bounds import Completion


def reverse_problem(problem: Problem) -> Problem:
    """A problem whose plans are those of another from their end to their beginning, at the same cost.

    Its moves are in a table, and its conditions ask of sets and last sites.
    """
    assert problem.matrix is not None
    return replace(
        problem,
        before=np.ascontiguousarray(problem.before.T),
        matrix=np.ascontiguousarray(problem.matrix.T),
        conditions=tuple(map(_turned, problem.conditions)),
        orders=b"",
    )


def _turned(condition: Condition) -> Condition:
    """What is out then was not out before, but for the contour that is asked about."""
    pairs = [(c, w) for c, w in zip(condition.members, condition.weights, strict=True) if c != condition.contour]
    weights = tuple(-w for _, w in pairs)
    return replace(condition, members=tuple(c for c, _ in pairs), weights=weights, bound=condition.bound + sum(weights))


@dataclass(frozen=True, eq=False, slots=True)
class Settled:
    """What plans cost from every way into a stretch on at least, `onward` (ways,): exact where that is up to `limit`.

    What moves cost for what is out in some orders alone is not in it.

    `work` is what it took to find that out, in deterministic seconds.
    """

    onward: Ints
    limit: int
    work: float = 0.0


def settle(
    posed: Problem, relaxed: ReducedCosts, entry: Ints, begun: Settled, known: int, deadline: Deadline
) -> Settled:
    """Find out what plans cost from every way into a stretch on, as far as the deadline lets it, from what is known on.

    `posed` is its network, with no cost of sites, `entry` (ways, sites) what it costs to come to each of its sites; a
    plan with all stretches before it is `known`.
    """
    onward, limit, whole = begun.onward, begun.limit, deadline.left
    least, enough, room = relaxed.bound, int(SPREAD * known), max(1, int(FIRST * known))
    try:
        rest = _rest(posed, relaxed, deadline.left)
    except bounds.TooMuch:
        return replace(begun, work=0.0)
    deadline.spend(rest.work * deadline.per_s)
    with ThreadPoolExecutor(THREADS) as threads, suppress(TooLarge):
        backward = Backward(posed, relaxed, entry, rest)
        while limit < min(int(onward.max()), known):
            had = deadline.left
            if least + room > limit:
                wanted = min(least + room, known)
                onward = np.maximum(onward, backward.onward(wanted, deadline, threads))
                limit = wanted
            spread, last = limit - int(onward.min()), room
            room = WIDER * room if spread >= enough or spread < 0 else min(WIDER * room, room + enough - spread)
            ahead = DEARER ** (room / last - 1.0) * (had - deadline.left)
            if ahead > (1.0 if spread < enough else LITTLE) * deadline.left:
                break
    return Settled(onward, limit, whole - max(0.0, deadline.left))


def _rest(posed: Problem, relaxed: ReducedCosts, most: float) -> Completion:
    """What is still to come of what multipliers leave, from the end to the beginning: one round, of less than `most`.

    Raises bounds.TooMuch if it takes as much.
    """
    walked = reverse_problem(replace(posed, matrix=relaxed.dear, conditions=()))
    return bounds.complete(walked, None, Deadline(0.0), MOST_NEIGHBOURS, most)


class Backward:
    """A stretch under its multipliers from its end to its beginning."""

    def __init__(self, posed: Problem, relaxed: ReducedCosts, entry: Ints, rest: Completion) -> None:
        problem = reverse_problem(posed)
        assert problem.matrix is not None
        self._entry, self._rest, self._bound = entry, rest, relaxed.bound
        self._local = localise(problem, tuple(range(problem.n)), frozenset())
        self._moves, self._lows = (np.roll(table, 1, axis=0)[:, :-1] for table in (problem.matrix, relaxed.dear.T))

    def onward(self, limit: int, deadline: Deadline, threads: Executor) -> Ints:
        """What plans cost at least from every way in on, (ways,): exact, but for what is crossed, or more than `limit`.

        Raises TooLarge over the deadline.
        """
        local, nothing = self._local, entrance_of([0], limit)
        tables = (table_of(local, table, limit) for table in (self._moves, self._lows))
        moves, lows = tables
        over = nothing_over(local.orders.needs.shape[1])
        stretch = SweptStretch(local, moves, over, self._rests, limit, never(limit), lows)
        end = sweep_layers(stretch, nothing, deadline, threads, nothing + self._bound)[-1]
        of_site = np.full(len(local.sites), FAR)
        np.minimum.at(of_site, np.searchsorted(local.sites, local.sites_of(end.contour)), end.values)
        found: Ints = np.minimum((self._entry + of_site).min(axis=1), limit + 1)
        return found

    def _rests(self, depth: int) -> RestBound:
        rest = self._rest
        return RestBound(np.ascontiguousarray(rest.to_go[depth]), rest.near, rest.price, 0.0)
