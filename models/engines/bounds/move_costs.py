"""What every move costs at least, whatever is out, with blocks gone through worked out beforehand."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from scipy.sparse import csr_matrix

from kerfwise.arrays import Bools, Floats, Int32s, Ints
from kerfwise.encoder.geometry.tolerances import UM_PER_MM
from kerfwise.models.engines.tuning import MOST_INNER
from kerfwise.models.engines.tuning import MOVE_ROWS as ROWS
from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.crossings import FORBIDDEN
from kerfwise.models.problem.moves import LAWFUL_MOST
from kerfwise.models.problem.problem import Problem

# What every move of a network costs: a table that is worked out some rows at a time.


def costs_of(
    problem: Problem, sites: Ints, split: Problem, sooner: Bools, later: Bools, inside: Inside, go: Callable[[], bool]
) -> Floats:  # fmt: skip
    """What every move costs, as `Network` says.

    `sites` are those of the problem that the sites of the `split` one stand for. Where these are of the last contour of
    a block with ways `inside`, a move leads to some site of it. `go` is asked now and then. Raises Stopped if `go` says
    no before the end.
    """
    m, moves = split.m, Moves(problem)
    cost = np.empty((m + 1, m + 1))
    ends, charged = np.append(sites, problem.m), np.append(split.site_cost, 0)
    lawful, kind = _lawful(split.site_contour, sooner, later)
    for start in range(0, m + 1, ROWS):
        if not go():
            raise Stopped
        rows = np.arange(start, min(start + ROWS, m + 1))
        part = moves.between(ends[rows], ends) + charged
        inside.come_through(moves.between(ends[rows], inside.inner), part)
        part[~lawful[kind[rows]][:, kind]] = np.inf
        cost[rows] = part
    return cost


class Inside:
    """Ways through the blocks that their last contours stand for, to the sites of these.

    `inner` (k,) are the sites of all the contours before the last ones. `ways` are of every such block: where its own
    are in `inner`, which sites its last contour has, and what it costs from the cut at the ones to that at the others.
    """

    def __init__(self, problem: Problem, sites: Ints, charged: Ints, passages: Sequence[Passage]) -> None:
        moves, owner = Moves(problem), problem.site_contour[sites]
        self.inner: Ints = np.zeros(0, dtype=np.int64)
        if passages:
            self.inner = problem.sites_of(np.concatenate([passage.inner for passage in passages]))
        self.ways: list[tuple[slice, Ints, Floats]] = []
        began = 0
        for passage in passages:
            here = np.flatnonzero(owner == passage.last)
            way = passage_costs(problem, passage, moves, sites[here], charged[here].astype(np.float64))
            self.ways.append((slice(began, began + len(way)), here, way))
            began += len(way)

    def come_through(self, entered: Floats, part: Floats) -> None:
        """Put into `part` (rows, sites) what it costs to come to last contours; `entered` (rows, k) to those inside."""
        for some, here, way in self.ways:
            part[:, here] = cheapest(entered[:, some], way)


class Stopped(Exception):
    """There is no time left for what was begun."""


def _lawful(contours: Ints, sooner: Bools, later: Bools) -> tuple[Bools, Ints]:
    """Which site may follow some: none that is to be out before, or after something that is to be between them.

    Most sites of a contour want the same: the table is that of the kinds of sites, and the kind of each, home last.
    """
    n = sooner.shape[1]
    owner = np.append(contours, n)
    keys = np.concatenate([owner[:, None].view(np.uint8), np.packbits(np.hstack([sooner, later]), axis=1)], axis=1)
    _, of_kind, kind = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    owner, sooner, later = owner[of_kind], sooner[of_kind], later[of_kind]
    home, inside = np.flatnonzero(owner == n), np.flatnonzero(owner < n)
    never: Bools = np.asarray(later.astype(np.float32) @ sooner.astype(np.float32).T > 0.5)
    never[home] = np.asarray(sooner.any(axis=1))
    never[:, home] = np.asarray(later.any(axis=1)).reshape(-1, 1)
    never[:, inside] |= sooner[:, owner[inside]]
    never[inside] |= later[:, owner[inside]].T
    return ~never, kind.reshape(-1)


# What moves cost at least, whatever is out.


class Moves:
    """What it costs at least to go from the end of one site to the pierce of another, from site to site.

    Infinite for moves that no lawful order has. What soft lags of several cuts charge for following each other at once
    is in it, and what is crossed that is out in every order that has the move. What depends on the order is not: it can
    only add.
    """

    def __init__(self, problem: Problem) -> None:
        self._problem, n = problem, problem.n
        self._owner = np.append(problem.site_contour, n)
        self._extra: Floats = np.where(problem.successors(), 0.0, np.inf)
        for lag in problem.lags:
            if lag.weight is not None and lag.cuts > 0:
                cost = round(lag.weight * UM_PER_MM) * lag.cuts
                self._extra[lag.first, lag.second] += cost
                self._extra[lag.second, lag.first] += cost
        self._charged = sure_crossings(problem) if len(problem.crossings) else None

    def between(self, leave: Ints, reach: Ints) -> Floats:
        """From each site in `leave` (k,) to each in `reach` (l,), (k, l); home is site m."""
        travel = self._problem.travel(leave, reach)
        move: Floats = travel + self._extra[np.ix_(self._owner[leave], self._owner[reach])]
        move[travel > LAWFUL_MOST] = np.inf
        if self._charged is not None:
            move += self._charged[leave][:, reach].toarray()
        return move


def least_moves(problem: Problem) -> Floats:
    """All `Moves`, (m + 1, m + 1), home last."""
    everywhere = np.arange(problem.m + 1)
    return Moves(problem).between(everywhere, everywhere)


def sure_crossings(problem: Problem) -> csr_matrix:
    """What every move, (m + 1, m + 1), costs for what it crosses that is out in every order that has the move."""
    rows, owner = problem.crossings, np.append(problem.site_contour, problem.n)
    sure = _surely_out(problem, rows.over, owner[rows.leave], owner[rows.reach])
    charged = np.where(rows.cost == FORBIDDEN, np.inf, rows.cost)[sure]
    return csr_matrix((charged, (rows.leave[sure], rows.reach[sure])), shape=(problem.m + 1, problem.m + 1))


def open_crossings(problem: Problem) -> Bools:
    """Which rows of its crossings depend on the order: what is crossed may be out already, or still in."""
    rows, owner = problem.crossings, np.append(problem.site_contour, problem.n)
    leave, reach = owner[rows.leave], owner[rows.reach]
    inside = np.minimum(reach, problem.n - 1)
    still = (leave == problem.n) | ((reach < problem.n) & ((rows.over == reach) | problem.before[inside, rows.over]))
    return np.asarray(~still & ~_surely_out(problem, rows.over, leave, reach))


def _surely_out(problem: Problem, over: Ints | Int32s, leave: Ints, reach: Ints) -> Bools:
    """Whether contour `over[k]` is out whenever the torch goes from contour `leave[k]` to `reach[k]`; home is n."""
    n = problem.n
    at_leave = (leave < n) & ((over == leave) | problem.before[over, np.minimum(leave, n - 1)])
    at_reach = (reach == n) | problem.before[over, np.minimum(reach, n - 1)]  # before the way home all is out
    return np.asarray(at_leave | at_reach)


# Blocks whose last contour stands for them: how the others are gone through is worked out beforehand.
#
# A contiguous block is entered once, and left from its last contour where it has one. Where nothing asks anything of
# the contours before that one, the cheapest way through them depends on two sites alone: that by which the block is
# entered and that by which it is left. It is found by dynamic programming over sets (Held and Karp 1962), and a
# program over moves has neither their sites nor cuts for them.


@dataclass(frozen=True, eq=False, slots=True)
class Passage:
    """Contour `last` ends a block; all of `inner` (k,) come before it, and nothing else is asked of them."""

    last: int
    inner: Ints


def passages_of(problem: Problem) -> tuple[Passage, ...]:
    """The blocks of a problem that their last contour can stand for."""
    watched = np.zeros(problem.n, dtype=np.bool_)
    watched[[condition.contour for condition in problem.conditions]] = True
    watched |= _crossing_inside(problem)
    names, size = np.unique(problem.block, return_counts=True)
    found = []
    for block in names[(size > 1) & (size <= MOST_INNER + 1)].tolist():
        inside = problem.block == block
        members = np.flatnonzero(inside)
        ends = members[problem.before[np.ix_(members, members)].sum(axis=0) == len(members) - 1]
        if not len(ends):
            continue
        last, inner = int(ends[0]), members[members != ends[0]]
        alike = (problem.before[members][:, ~inside] == problem.before[last, ~inside]).all()
        alike &= (problem.before[:, members][~inside] == problem.before[~inside, last][:, None]).all()
        if alike and not watched[inner].any():
            found.append(Passage(last, inner))
    return tuple(found)


def _crossing_inside(problem: Problem) -> Bools:
    """Contours, (n,), that some move crosses, or that are left for another of their block by a move that crosses some.

    Of moves whose cost depends on what is out: of several contours of a block that are crossed each is paid for.
    """
    found = np.zeros(problem.n, dtype=np.bool_)
    if len(problem.crossings):
        rows = problem.crossings.only(open_crossings(problem))
        found[rows.over] = True
        owner, block = np.append(problem.site_contour, problem.n), np.append(problem.block, -1)
        leave = owner[rows.leave]
        found[leave[block[leave] == block[owner[rows.reach]]]] = True
    return found


def stand_for(problem: Problem, passages: Sequence[Passage]) -> tuple[Ints, Ints, Ints]:
    """The contours that are left (k,), the number of each contour among them (n,), and which one stands for it (n,).

    An inner contour has no number: -1.
    """
    last_of = np.arange(problem.n)
    for passage in passages:
        last_of[passage.inner] = passage.last
    kept = np.flatnonzero(last_of == np.arange(problem.n))
    number = np.full(problem.n, -1, dtype=np.int64)
    number[kept] = np.arange(len(kept))
    return kept, number, last_of


def size_without_inner(problem: Problem) -> tuple[int, int]:
    """How many contours and sites are left where last contours stand for their blocks."""
    kept, _, _ = stand_for(problem, passages_of(problem))
    return len(kept), int((problem.first[kept + 1] - problem.first[kept]).sum())


def passage_costs(problem: Problem, passage: Passage, moves: Moves, sites: Ints, charged: Floats) -> Floats:
    """What it costs at least to cut the contours of a block before its last, and then that one, (k, l).

    From the cut at each of the k sites of `passage.inner`, in their order, to that at each of `sites` (l,), which are
    of the last contour and cost `charged` (l,). Infinite where no order has it.
    """
    inner = problem.sites_of(passage.inner)
    owner, own = problem.site_contour[inner], problem.site_cost[inner].astype(np.float64)
    step = moves.between(inner, inner) + own
    none = frozenset[int]()
    to_go = {none: moves.between(inner, sites) + charged}
    contours = passage.inner.tolist()
    for size in range(1, len(contours)):
        for some in combinations(contours, size):
            rest = frozenset(some)
            cost = np.full(to_go[none].shape, np.inf)
            for contour in some:
                next_ = owner == contour
                cost = np.minimum(cost, cheapest(step[:, next_], to_go[rest - {contour}][next_]))
            to_go[rest] = cost
    whole = np.empty(to_go[none].shape)
    for contour in contours:
        first = owner == contour
        whole[first] = to_go[frozenset(contours) - {contour}][first]
    return whole + own[:, None]


def best_way(problem: Problem, passage: Passage, moves: Moves, entered: Floats, last: int) -> list[int]:
    """The sites of a cheapest way through the contours of a block before its last, which is cut at site `last`.

    `entered` (k,) is what it costs to come to each of the k sites of `passage.inner`, in their order.
    """
    route: list[int] = []
    sites, end = problem.sites_of(passage.inner), np.array([last])
    while True:
        rest = passage_costs(problem, passage, moves, end, np.zeros(1))[:, 0]
        route.append(int(sites[np.argmin(entered + rest)]))
        inner = passage.inner[passage.inner != problem.site_contour[route[-1]]]
        if not len(inner):
            return route
        passage, sites = Passage(passage.last, inner), problem.sites_of(inner)
        entered = moves.between(np.array(route[-1:]), sites)[0]


def cheapest(one: Floats, then: Floats) -> Floats:
    """The cheapest of all ways in two steps, (j, l): `one` (j, k) and `then` (k, l)."""
    cost: Floats = (one[:, :, None] + then[None]).min(axis=1)
    return cost


def contract_condition(condition: Condition, last_of: Ints) -> Condition:
    """The same condition on the last contours of blocks alone; `last_of` (n,) is that which stands for each contour.

    What lies in another block is out when its last contour is; what comes before the contour in its own block is out.
    """
    weights: dict[int, int] = {}
    bound = condition.bound
    for member, weight in zip(condition.members, condition.weights, strict=True):
        last = int(last_of[member])
        if last == condition.contour != member:
            bound -= weight
        else:
            weights[last] = weights.get(last, 0) + weight
    return replace(condition, members=tuple(weights), weights=tuple(weights.values()), bound=bound)


def renumber_condition(condition: Condition, number: Ints) -> Condition:
    """The same condition where contours have other numbers."""
    members = tuple(int(number[member]) for member in condition.members)
    return replace(condition, contour=int(number[condition.contour]), members=members)
