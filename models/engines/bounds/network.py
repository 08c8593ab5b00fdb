"""What a flow goes over, and what every move is worth by the multipliers of a linear program."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.models.engines.tuning import DEAR_UM as ENOUGH
from kerfwise.models.engines.tuning import ENOUGH_OF_PLAN, MORE, MORE_EACH, MOST_SPLIT
from kerfwise.models.engines.tuning import MOVE_ROWS as ROWS
from kerfwise.models.engines.tuning import NETWORK_NEAREST as NEAREST
from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.crossings import Crossings
from kerfwise.models.problem.moves import MovePrices
from kerfwise.models.problem.problem import Links, Problem

from .move_costs import Inside, contract_condition, costs_of, passages_of, renumber_condition, stand_for

# What a flow goes over: sites, split by what their conditions ask, each with what must be out before and after it.
#
# Many conditions ask of a site one thing: that some neighbour is still in, or already out. Then whatever leads to
# that site must keep clear of what comes after the neighbour, and the site follows nothing that another site forbids.
# Where a condition can be paid for, its site is there twice: once as it asks, once paid. Blocks that their last
# contour can stand for are there by that alone.


@dataclass(frozen=True, eq=False, slots=True)
class Network:
    """A problem of m sites that no plan undercuts, and what holds wherever a site of it is used.

    `contours` are those of the whole problem that its contours are: of some blocks the last one alone.
    `cost` (m + 1, m + 1) is that of every move with the site it leads to, and with the way through such a block to its
    last contour, home last, infinite where no plan has it.
    `sites` (m,) are those of the whole problem that its sites stand for, `inside` the ways through such blocks to them.
    `sooner[s, c]` says that contour c is out before site s is cut, `later[s, c]` that it is not; both (m + 1, n), all
    false for home. `plan` is the known plan on these sites.
    """

    problem: Problem
    contours: Ints
    sites: Ints
    inside: Inside
    cost: Floats
    sooner: Bools
    later: Bools
    plan: tuple[int, ...]


@dataclass(slots=True)
class _Split:
    """A site with some of its conditions met and others paid for."""

    site: int
    paid: tuple[Condition, ...]
    sooner: Bools
    later: Bools
    left: tuple[Condition, ...]
    """Conditions that its orders do not decide."""


def network_of(
    problem: Problem, route: Sequence[int], most: int, most_sites: int, go: Callable[[], bool] = lambda: True
) -> Network:
    """The network of a problem; no plan of it that costs more than `most`, µm, is wanted.

    `route` is a lawful route. No site is split where there would be more than `most_sites`. `go` is asked now and then.
    """
    passages = passages_of(problem)
    kept, number, last_of = stand_for(problem, passages)
    conditions_of: list[list[Condition]] = [[] for _ in range(problem.m)]
    wide = []
    for condition in problem.conditions:
        if condition.cost is not None and condition.cost > most:
            condition = replace(condition, cost=None)
        if condition.when is not None:
            conditions_of[condition.when].append(condition)
        elif _decides(problem, condition.contour, condition):
            for site in problem.sites(condition.contour):
                conditions_of[site].append(replace(condition, when=site))
        else:
            wide.append(condition)
    splits = _splits(problem, kept, conditions_of, MOST_SPLIT, most)
    if len(splits) > most_sites:
        splits = _splits(problem, kept, conditions_of, 0, most)
    sites = np.array([split.site for split in splits], dtype=np.int64)
    contours = number[problem.site_contour[sites]]
    paid = np.array([sum(c.cost or 0 for c in split.paid) for split in splits], dtype=np.int64)
    left = (*wide, *(replace(c, when=k) for k, split in enumerate(splits) for c in split.left))
    split_problem = replace(
        problem,
        n=len(kept),
        ids=tuple(problem.ids[i] for i in kept.tolist()),
        first=np.searchsorted(contours, np.arange(len(kept) + 1)).astype(np.int64),
        site_contour=contours,
        site_candidate=problem.site_candidate[sites],
        pierce_um=problem.pierce_um[sites],
        end_um=problem.end_um[sites],
        site_cost=problem.site_cost[sites] + paid,
        before=np.ascontiguousarray(problem.before[np.ix_(kept, kept)]),
        block=problem.block[kept],
        conditions=tuple(renumber_condition(contract_condition(c, last_of), number) for c in left),
        soft_groups=(),
        lags=(),
        general=(),
        crossings=Crossings(),
        links=Links(),
        moves=MovePrices(),
        matrix=None,
    )
    none = np.zeros((1, len(kept)), dtype=np.bool_)
    sooner = np.vstack([*(split.sooner[None, kept] for split in splits), none])
    later = np.vstack([*(split.later[None, kept] for split in splits), none])
    inside = Inside(problem, sites, split_problem.site_cost, passages)
    cost = costs_of(problem, sites, split_problem, sooner, later, inside, go)
    return Network(split_problem, kept, sites, inside, cost, sooner, later, tuple(_on(splits, route, problem)))


def _splits(problem: Problem, kept: Ints, groups: list[list[Condition]], most: int, most_um: int) -> list[_Split]:
    """All sites of the contours kept, as often as so many of their conditions can be met or paid for.

    None that costs more than a plan.
    """
    dear = np.inf if len(problem.links) or problem.matrix is not None else most_um
    splits: list[_Split] = []
    for i in kept.tolist():
        near = [s for s in problem.sites(i) if problem.site_cost[s] <= dear]
        of_contour = [split for s in near for split in _splits_of(problem, s, groups[s], most)]
        of_contour = [s for s in of_contour if problem.site_cost[s.site] + sum(c.cost or 0 for c in s.paid) <= dear]
        if not of_contour:  # no lawful plan: not for this to find out
            plain = (_Split(s, (), problem.before[:, i], problem.before[i], ()) for s in problem.sites(i))
            of_contour.extend(plain)
        splits += of_contour
    return splits


def _splits_of(problem: Problem, site: int, conditions: list[Condition], most: int) -> Iterator[_Split]:
    i = int(problem.site_contour[site])
    hard = [c for c in conditions if c.cost is None]
    soft = sorted((c for c in conditions if c.cost is not None), key=lambda c: -(c.cost or 0))
    chosen = [c for c in soft if _decides(problem, i, c)][:most]
    beside = [c for c in soft if c not in chosen]
    for met in product((True, False), repeat=len(chosen)):
        bound = [c for c, is_met in zip(chosen, met, strict=True) if is_met]
        paid = tuple(c for c, is_met in zip(chosen, met, strict=True) if not is_met)
        found = _ordered(problem, i, hard + [replace(c, cost=None) for c in bound])
        if found is not None:
            sooner, later, left = found
            yield _Split(site, paid, sooner, later, (*left, *beside))


def _decides(problem: Problem, i: int, condition: Condition) -> bool:
    """Whether a condition that is met says of some contour whether it is out, or cannot be met at all."""
    found = _ordered(problem, i, [condition])
    return found is None or bool((found[0] > problem.before[:, i]).any() or (found[1] > problem.before[i]).any())


def _ordered(problem: Problem, i: int, met: list[Condition]) -> tuple[Bools, Bools, list[Condition]] | None:
    """What is out, and what is not, wherever all these conditions of contour i are met, and those not decided by that.

    None where they cannot all be met.
    """
    sooner, later = problem.before[:, i].copy(), problem.before[i].copy()
    while True:
        known = int(sooner.sum() + later.sum())
        left = []
        for condition in met:
            pairs = [(k, w) for k, w in zip(condition.members, condition.weights, strict=True) if k != i]
            at_least = condition.bound - sum(w for k, w in pairs if sooner[k])
            open_ = [(k, w) for k, w in pairs if not sooner[k] and not later[k]]
            most = sum(max(w, 0) for _, w in open_)
            if most < at_least:
                return None
            for k, weight in open_:
                if most - abs(weight) < at_least:
                    side, closed = (sooner, problem.before[:, k]) if weight > 0 else (later, problem.before[k])
                    side |= closed
                    side[problem.block == problem.block[k] if problem.block[k] != problem.block[i] else k] = True
            if sum(min(w, 0) for _, w in open_) < at_least:
                left.append(condition)
        if (sooner & later).any() or sooner[i] or later[i]:
            return None
        if known == int(sooner.sum() + later.sum()):
            return sooner, later, left


def _on(splits: list[_Split], route: Sequence[int], problem: Problem) -> Iterator[int]:
    """The splits that a lawful route uses: those with nothing paid for that is met."""
    of_site: dict[int, list[int]] = {}
    for k, split in enumerate(splits):
        of_site.setdefault(split.site, []).append(k)
    out: set[int] = set()
    here = np.zeros(problem.n, dtype=np.bool_)
    for site in route:
        for k in of_site.get(int(site), ()):
            split = splits[k]
            unmet = (split.sooner & ~here).any() or (split.later & here).any()
            unmet |= any(c.cost is None and not c.met(out) for c in split.left)
            if not unmet and not any(c.met(out) for c in split.paid):
                yield k
                break
        out.add(int(problem.site_contour[site]))
        here[problem.site_contour[site]] = True


# What every plan's moves come to at least, and a cheapest flow comes to too little of.


@dataclass(frozen=True, eq=False, slots=True)
class Inequalities:
    """For each row: moves from a site of `tail` to one of `head`, less moves to a site of `into`.

    It comes to `least` at least in every plan. `tail`, `head` and `into` are (k, m + 1), home last, `least` (k,).
    """

    tail: Bools
    head: Bools
    into: Bools
    least: Floats

    def __len__(self) -> int:
        return len(self.tail)

    def only(self, kept: Bools) -> Inequalities:
        """Those of them that are kept."""
        return Inequalities(self.tail[kept], self.head[kept], self.into[kept], self.least[kept])

    def joined(self, more: Inequalities) -> Inequalities:
        """With more of them."""
        return Inequalities(
            np.concatenate([self.tail, more.tail]),
            np.concatenate([self.head, more.head]),
            np.concatenate([self.into, more.into]),
            np.concatenate([self.least, more.least]),
        )

    def across(self, leave: Ints, reach: Ints) -> csr_matrix:
        """How much each of some moves counts in every inequality, (k, moves)."""
        starts = np.zeros(len(self) + 1, dtype=np.int64)
        places, values = [np.zeros(0, dtype=np.int64)], [np.zeros(0)]
        for k, (tail, head, into) in enumerate(zip(self.tail, self.head, self.into, strict=True)):
            counts = (tail[leave] & head[reach]).view(np.int8)
            if into.any():
                counts = counts - into[reach]
            places.append(np.flatnonzero(counts))
            values.append(counts[places[-1]].astype(np.float64))
            starts[k + 1] = starts[k] + len(places[-1])
        return csr_matrix((np.concatenate(values), np.concatenate(places), starts), shape=(len(self), len(leave)))


def block_inequalities(problem: Problem) -> Inequalities:
    """The contours of a contiguous block follow each other: one move less than there are leads from one to another."""
    names, size = np.unique(problem.block, return_counts=True)
    owner = np.append(problem.site_contour, problem.n)
    inside = np.append(problem.block, -1)[owner][None, :] == names[size > 1][:, None]
    least = (size[size > 1] - 1).astype(np.float64)
    return Inequalities(inside, inside, np.zeros_like(inside), least)


# What every move is worth by the multipliers of a linear program: the bound they prove, and what is missing.
#
# The program holds few moves; a bound must hold of all, and it does whatever the multipliers are.

MARGIN_UM = 0.5
"""Plans cost whole numbers: one that is cheaper than the known one costs 1 less."""


class Multipliers(NamedTuple):
    """Of a linear program: `price` (m + 1,) of the sites, and what is `paid` (k,) for inequalities, never negative."""

    price: Floats
    paid: Floats
    inequalities: Inequalities


def left_of(network: Network, by: Multipliers) -> tuple[float, Floats, Floats]:
    """The bound that multipliers prove, what coming to every contour and home costs at least, and what they leave.

    That is of every move (m + 1, m + 1), with what coming to its contour costs at least in it.
    """
    paying = by.paid > 0.0
    paid, some = by.paid[paying], by.inequalities.only(paying)
    (tails, tail), (heads, head) = (kinds(side) for side in (some.tail, some.head))
    worth = (some.tail[:, tails].T * paid) @ some.head[:, heads].astype(np.float64)
    gain, left = by.price - paid @ some.into, np.empty_like(network.cost)
    for rows in _blocks(len(left)):
        left[rows] = network.cost[rows] - worth[tail[rows]][:, head] + by.price[rows, None] - gain
    least = np.minimum.reduceat(left.min(axis=0), np.append(network.problem.first[:-1], network.problem.m))
    return float(least.sum() + paid @ some.least), least, left


class AllMoves:
    """Every move from site to site, home last: what it costs, and which are in the program, both (m + 1, m + 1).

    A move that is closed costs infinitely much, in the network as well.
    """

    def __init__(self, network: Network, plan_um: int) -> None:
        self._network, self.cost, self._plan_um = network, network.cost, plan_um
        m = network.problem.m
        self._owner = np.append(network.problem.site_contour, network.problem.n)
        self.used: Bools = np.zeros(self.cost.shape, dtype=np.bool_)
        self._own = (np.array([m, *network.plan]), np.array([*network.plan, m]))
        self._at_once = max(MORE, MORE_EACH * network.problem.n)

    def nearest(self) -> tuple[Ints, Ints]:
        """The cheapest moves from and to every site, and the known plan's own."""
        wanted, most = np.zeros_like(self.used), min(NEAREST, len(self._owner)) - 1
        for axis in (0, 1):
            nearest = np.argpartition(self.cost, most, axis=axis).take(range(most + 1), axis)
            np.put_along_axis(wanted, nearest, True, axis)
        wanted &= np.isfinite(self.cost)
        wanted[self._own] = True
        leave, reach = np.nonzero(wanted)
        return leave, reach

    def is_own(self, leave: Ints, reach: Ints) -> Bools:
        """Which of these moves are the known plan's."""
        wide = len(self._owner)
        return np.asarray(np.isin(leave * wide + reach, self._own[0] * wide + self._own[1]))

    def look(self, by: Multipliers, leave: Ints, reach: Ints) -> tuple[float, tuple[Ints, Ints], bool]:
        """The bound that multipliers prove; the moves most missing beside these; and whether some are closed.

        Moves are closed that no plan has that costs less than the known one: a plan with a move costs as much more as
        the move is dearer than the cheapest one. The known plan's own stay, so that there is always a flow.
        """
        bound, least, left = left_of(self._network, by)
        owner, known, closes = self._owner, np.full(len(least), np.inf), False
        np.minimum.at(known, owner[reach], left[leave, reach])
        limit = (known - min(ENOUGH, ENOUGH_OF_PLAN * self._plan_um))[owner]
        room = (self._plan_um - MARGIN_UM - bound + least)[owner]
        own, moves, by_much = self.cost[self._own], [], []
        for rows in _blocks(len(left)):
            row, column = np.nonzero((left[rows] < limit) & ~self.used[rows] & (left[rows] <= room))
            moves.append(np.stack([row + rows.start, column]))
            by_much.append((left[rows] - known[owner])[row, column])
            dear = (left[rows] > room) & np.isfinite(self.cost[rows])
            self.cost[rows][dear] = np.inf
            closes = closes or bool(dear.any())
        self.cost[self._own] = own
        chosen = np.concatenate(moves, axis=1)[:, np.argsort(np.concatenate(by_much), kind="stable")[: self._at_once]]
        return bound, (chosen[0], chosen[1]), closes


def _blocks(sites: int) -> Iterator[slice]:
    """Some rows of a table after others, so that what is worked out meanwhile takes little memory."""
    return (slice(start, start + ROWS) for start in range(0, sites, ROWS))


def kinds(sides: Bools) -> tuple[Ints, Ints]:
    """Of sites that lie on the same sides (k, m + 1) the first, and the kind of every site.

    Most sites of a contour lie on the same side of all inequalities, so that what is paid is summed once for them all.
    """
    packed = np.ascontiguousarray(np.packbits(sides, axis=0).T)
    if not packed.shape[1]:
        return np.zeros(1, dtype=np.int64), np.zeros(len(packed), dtype=np.int64)
    names = packed.view(np.dtype((np.void, packed.shape[1]))).ravel()
    _, first, kind = np.unique(names, return_index=True, return_inverse=True)
    return first, kind
