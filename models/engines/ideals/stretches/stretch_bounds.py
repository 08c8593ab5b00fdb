"""Bounds on what is ahead of a state, stretch after stretch, from the last to the first."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from math import inf, log
from typing import TYPE_CHECKING

import numpy as np

from kerfwise.arrays import Floats, Ints
from kerfwise.models.engines import bounds
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.ideals.lattice import SweptStretch, TooLarge, sweep_layers
from kerfwise.models.engines.ideals.stretch import ConditionsByContour, Local, RestBound, chain_orders, localise, series
from kerfwise.models.engines.tuning import (
    BYTES_A_NUMBER,
    ENDS,
    FAR_OVER,
    LEAST_STEP,
    ONE_GO,
    PIECE,
    SHARES,
    SOON,
    TWICE,
)
from kerfwise.models.engines.tuning import STRETCH_DEARER as DEARER
from kerfwise.models.engines.tuning import STRETCH_FIRST as FIRST
from kerfwise.models.engines.tuning import STRETCH_LITTLE as LITTLE
from kerfwise.models.engines.tuning import STRETCH_MOST_NEIGHBOURS as MOST_NEIGHBOURS
from kerfwise.models.engines.tuning import STRETCH_NEAR as NEAR
from kerfwise.models.engines.tuning import STRETCH_SHARE as SHARE
from kerfwise.models.engines.tuning import STRETCH_WIDER as WIDER
from kerfwise.models.problem.precedence import Followers
from kerfwise.models.problem.problem import Problem

from .stretch_tables import FAR, HOME, ends_of, entrance_of, make_moves, never, stretch_problem, travel_between

if TYPE_CHECKING:
    from kerfwise.models.engines.bounds import Completion


# Bounds by walks for every stretch apart, from the last to the first: what is ahead of a stretch is settled before
# it.
#
# A stretch is a problem of its own, between a home that stands for whatever comes before it and one for whatever
# comes after. It ends at what the next stretch still costs at least from there on, so that the bounds of all
# stretches add up, and each is found in tables of its own sites and places alone.


@dataclass(frozen=True, eq=False, slots=True)
class Ahead:
    """A stretch and what is ahead in it: `sites` of its contours, those it may begin (`into`) and end with (`out_of`).

    `bound` is what a plan costs from a state on to its end at least; `onward` (len(out_of),) from the end of the
    stretch on.
    """

    group: tuple[int, ...]
    sites: Ints
    into: Ints
    out_of: Ints
    onward: Ints
    bound: Completion

    def rests(self, local: Local, missed: int) -> Callable[[int], RestBound]:
        """The same for the sweep of this stretch; later ones cost `missed` more than their bounds say."""
        near = np.where(self.bound.near < 0, -1, self.bound.near)

        def after(depth: int) -> RestBound:
            return RestBound(np.ascontiguousarray(self.bound.to_go[depth]), near, self.bound.price, float(missed))

        return after


def look_ahead(
    problem: Problem,
    route: Sequence[int],
    deadline: Deadline,
    most: float = inf,
) -> list[Ahead]:
    """What is ahead in every stretch of a problem, in their order.

    Each has its share of the work. `route` is a lawful one: what it costs is what a bound may rise to. Raises TooMuch
    if all stretches take `most` deterministic seconds or more, one round of each being the least.
    """
    groups = series(problem)
    sites = [problem.sites_of(group) for group in groups]
    ends = [ends_of(problem, group) for group in groups]
    weight = np.array([float(len(of)) ** 2 * len(group) for of, group in zip(sites, groups, strict=True)])
    numbers = sum((len(group) + 1) * len(of) for of, group in zip(sites, groups, strict=True))
    remembered = int(np.log2(max(1.0, SHARE * deadline.most_bytes / BYTES_A_NUMBER / max(1, numbers))))
    until = np.cumsum([len(group) for group in groups]).tolist()
    spent = 0.0
    found: list[Ahead] = []
    parts, shelf = ConditionsByContour(problem), Arena()
    for k in reversed(range(len(groups))):
        before = ends[k - 1][1] if k else np.array([HOME])
        query = parts.of(groups[k])
        onward = _onward(query, ends[k][1], found[-1] if found else None)
        enter = travel_between(query, before, sites[k]).min(axis=0)
        apart = stretch_problem(query, groups[k], sites[k], enter, ends[k][1], onward)
        own = list(route[until[k] - len(groups[k]) : until[k]])
        known = int(problem.legs(own[:-1], own[1:]).sum() + problem.site_cost[own].sum() + enter[sites[k] == own[0]][0])
        known += int(onward[ends[k][1] == own[-1]][0])
        share = deadline.counting(deadline.work * float(weight[k] / weight.sum()))
        try:
            bound = bounds.complete(apart, known, share, min(MOST_NEIGHBOURS, remembered), most - spent)
        except bounds.TooMuch:
            raise bounds.TooMuch(spent) from None
        spent += bound.work
        kept = replace(bound, to_go=shelf.put(bound.to_go))
        found.append(Ahead(groups[k], sites[k], *ends[k], onward, kept))
    return found[::-1]


def _onward(problem: Problem, leave: Ints, following: Ahead | None) -> Ints:
    """What plans cost from the end of a stretch at least, by the site that they leave it from."""
    if following is None:
        return np.minimum(travel_between(problem, leave, np.array([HOME]))[:, 0], FAR)
    size = np.diff(problem.first)[list(following.group)]
    rest = following.bound.after_first(np.repeat(np.arange(len(size)), size))
    whole = np.floor(np.minimum(rest + problem.site_cost[following.sites], FAR)).astype(np.int64)
    first = np.isin(following.sites, following.into)
    least: Ints = (travel_between(problem, leave, following.into) + whole[first]).min(axis=1)
    return np.minimum(least, FAR)


# By how much the bounds of stretches apart are too low at least, so that a sweep of all of them drops more.
#
# In a stretch a plan may cost more than the bound before it promised, less what the bound behind it promises. The
# least of that over all ways through the stretch is found by a sweep of it alone, from wherever it may be entered.
# What is missed so in all stretches adds up (the bounds are potentials, as in the shortest paths of Johnson 1977),
# and a sweep of one stretch has room for its own share alone.


def missed_in(
    problem: Problem, ahead: Sequence[Ahead], route: Sequence[int], known: int, deadline: Deadline, threads: Executor
) -> list[int]:
    """What every stretch costs more than its bound says, at least, µm: 0 for the first, which nothing comes before.

    `route` is a lawful one, which costs `known`; what it misses in a stretch is the most that is looked for. Where it
    costs as much as bounds are cut off at, nothing is said to be missed. Raises TooLarge if there is no work left.
    """
    if known >= FAR:
        return [0] * len(ahead)
    parts, earlier, at = ConditionsByContour(problem), frozenset[int](), 0
    missed = [0]
    for before, here in pairwise(ahead):
        at, earlier = at + len(before.group), earlier | frozenset(before.group)
        inside, order = parts.of(here.group), problem.site_contour[list(route[at : at + len(here.group)])]
        stays = localise(inside, tuple(order.tolist()), earlier)
        stays = replace(stays, orders=chain_orders(stays.orders))
        promised = int(before.onward[before.onward < FAR].max())
        through = _Through(inside, before, here, earlier, promised, deadline, threads)
        most = through.least(stays, _nothing(stays), promised + known)
        local = localise(inside, here.group, earlier)
        missed.append(max(0, through.rising(local, here.rests(local, 0), most) - promised))
    return missed


class _Through:
    """Ways through one stretch, priced by what the bound before it `promised` and the bound behind it."""

    def __init__(
        self, problem: Problem, before: Ahead, here: Ahead, earlier: frozenset[int], promised: int,
        deadline: Deadline, threads: Executor,
    ) -> None:  # fmt: skip
        passable = before.onward < FAR
        self._ways, self._entrance = before.out_of[passable], (promised - before.onward[passable]).tolist()
        self._promised = promised
        self._problem, self._here, self._earlier = problem, here, earlier
        self._deadline, self._threads = deadline, threads

    def rising(self, local: Local, rests: Callable[[int], RestBound], most: int) -> int:
        """What the cheapest of them costs at least, `most` at the most: little more than promised is tried first.

        Raises TooLarge if there is no work left.
        """
        above = self._promised
        try:
            for share in SHARES:
                limit = self._promised + int(share * (most - self._promised))
                if (found := self.least(local, rests, limit)) <= limit:
                    return found
                above = limit + 1
        except TooLarge:
            if self._deadline.left < 0 or not self._deadline.go():
                raise
        return above

    def least(self, local: Local, rests: Callable[[int], RestBound], limit: int) -> int:
        """What the cheapest of them costs, of those up to `limit`; more than that where there is none."""
        moves, over = make_moves(self._problem, local, self._earlier, self._ways, limit)
        stretch = SweptStretch(local, moves, over, rests, limit, never(limit))
        end = sweep_layers(stretch, entrance_of(self._entrance, limit), self._deadline, self._threads)[-1]
        at = np.searchsorted(self._here.out_of, local.sites_of(end.contour))
        whole = end.values + self._here.onward[at]
        return int(whole.min(initial=stretch.never))


def _nothing(local: Local) -> Callable[[int], RestBound]:
    """A bound that says nothing."""
    count = len(local.contours)
    rest = RestBound(np.zeros((1, len(local.sites))), np.zeros((count, 0), dtype=np.int64), np.zeros(count), 0.0)
    return lambda _: rest


# What plans still cost after a state, as the sweep of a stretch needs it to drop what is too dear.

NOWHERE = 1e12
"""Travel to a contour that nothing may come right before: more than any plan costs, but finite."""


def least_rest(local: Local, earlier: frozenset[int], least: LeastIn) -> Callable[[int], RestBound]:
    """Every contour that is left must be travelled to, which costs `least`, whatever is cut last."""
    n = len(least)
    inside = set(local.contours)
    rest = RestBound(
        np.zeros((1, len(local.sites))),
        np.zeros((len(local.contours), 0), dtype=np.int64),
        np.array([least[c] for c in local.contours]),
        float(sum(least[c] for c in range(n) if c not in earlier and c not in inside)),
    )
    return lambda _: rest


def walked_rest(local: Local, earlier: frozenset[int], bound: Completion) -> Callable[[int], RestBound]:
    """The bound by walks."""
    number = np.full(len(bound.price) + 1, -2, dtype=np.int64)
    number[[*earlier, -1]] = -1
    number[list(local.contours)] = np.arange(len(local.contours))
    chosen = list(local.contours)
    near, price = number[bound.near[chosen]], bound.price[chosen]
    later = float(bound.price[number[:-1] == -2].sum())

    def after(depth: int) -> RestBound:
        return RestBound(np.ascontiguousarray(bound.to_go[len(earlier) + depth][:, local.sites]), near, price, later)

    return after


class LeastIn:
    """For every contour a lower bound on the travel that leads to it from what may come right before.

    Each is worked out when it is first asked for: it takes a look at all sites, and a window asks for few.
    """

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self._sites = np.append(np.diff(problem.first), 1)
        self._known: dict[int, float] = {}

    def __len__(self) -> int:
        return self._problem.n

    def __getitem__(self, contour: int) -> float:
        if contour not in self._known:
            self._known[contour] = self._least(contour)
        return self._known[contour]

    @cached_property
    def _followers(self) -> Followers:
        return self._problem.followers()

    def _least(self, contour: int) -> float:
        problem = self._problem
        before = np.flatnonzero(np.repeat(self._followers.ahead_of(contour), self._sites))
        ways = problem.travel(before, np.array(problem.sites(contour)))
        if len(problem.links):  # which save a pierce that the site is paid for with
            ways += problem.site_cost[problem.first[contour] : problem.first[contour + 1]]
        return float(ways.min(initial=NOWHERE))


# What plans that are looked for may cost: little at first, as the less it is the fewer states are gone through.


def rising_limits(
    least: float, known: int | None, left: Callable[[], float], wider: float = WIDER
) -> Iterator[int | None]:
    """Limits from little more than the `least` on; at last as much as a plan that is `known`, None where none is.

    `left` is the work that is left when it is called: what a sweep takes rises about as a power of its limit, so that
    the last two say how far the next may reach. Where limits drop next to nothing, it is to the known plan.

    Examples
    --------
    >>> plenty = lambda: 1e9
    >>> (
    ...     list(rising_limits(1000.0, 1020, plenty)),
    ...     list(rising_limits(1000.0, 1002, plenty)),
    ...     list(rising_limits(1000.0, None, plenty)),
    ... )
    ([1005, 1008, 1012, 1020], [1002], [None])
    """
    over, step, before = NEAR * least, NEAR * least, 0.0
    while known is not None and over >= 1 and least + over < known:
        had = left()
        yield int(least + over)
        taken = had - left()
        near = over < FAR_OVER * least / wider
        if near or before <= 0.0 or taken < LITTLE * had:
            step = (wider - 1.0) * over
        else:
            times = log(max(1.0, taken / before)) / step  # of the work, a unit of the limit more
            if times * (known - least - over) <= log(DEARER):
                break
            step = log(DEARER) / times
        step = max(step, 1.0)  # limits are whole numbers: none comes twice
        over, before = over + step, taken
    yield known


def limits_within_work(least: float, known: int, left: Callable[[], float]) -> Iterator[int]:
    """Limits as `rising_limits` gives them, but such that the sweep to each will end with the work that is left.

    The first is next to the `least` itself, as plans may cost no more. What a sweep takes rises about as a power of its
    limit. Raises TooLarge where no sweep that says more would end.
    """
    over, step, before = FIRST * least, FIRST * least, 0.0
    if least + over < known:
        yield int(least + SOON * least)
    while least + over < known:
        had = left()
        yield int(least + over)
        taken = max(had - left(), LITTLE * had)
        times = log(max(1.01, taken / before)) / step if before > 0.0 else log(DEARER) / over
        room = log(max(1e-9, ENDS * left() / taken)) / times
        step = min(log(DEARER) / times, TWICE * over, room)
        to_known = known - least - over
        if to_known <= min(room, ONE_GO * step):
            break
        if step < LEAST_STEP * over:
            raise TooLarge
        over, before = over + step, taken
    yield known


# Many small tables kept in few large pieces of memory: the system gets these back as soon as they are not needed.


class Arena:
    """Where tables are put one behind the other; a piece goes when no table in it is needed any more.

    Examples
    --------
    >>> shelf = Arena()
    >>> one, two = (shelf.put(np.full((2, 2), value)) for value in (1.0, 2.0))
    >>> two.tolist(), one.base is two.base
    ([[2.0, 2.0], [2.0, 2.0]], True)
    """

    def __init__(self) -> None:
        self._piece: Floats = np.empty(0)
        self._used = 0

    def put(self, table: Floats) -> Floats:
        """A copy of a table, on the shelf."""
        if self._used + table.size > len(self._piece):
            self._piece, self._used = np.empty(max(PIECE, table.size)), 0
        place = self._piece[self._used : self._used + table.size].reshape(table.shape)
        place[...] = table
        self._used += table.size
        return place
