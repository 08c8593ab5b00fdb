"""What a flow goes over, and what every move is worth by the multipliers of a linear program."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any, NamedTuple

import numpy as np

from kerfwise.arrays import Bools, Float32s, Floats, Ints
from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.crossings import Crossings
from kerfwise.models.problem.moves import MovePrices
from kerfwise.models.problem.problem import Links, Problem

from .inequalities import Inequalities
from .move_costs import Inside, by_threads, contract_condition, costs_of, passages_of, renumber_condition, stand_for

# What a flow goes over: sites, split by what their conditions ask, each with what must be out before and after it.
#
# Many conditions ask of a site one thing: that some neighbour is still in, or already out. Then whatever leads to
# that site must keep clear of what comes after the neighbour, and the site follows nothing that another site forbids.
# Where a condition can be paid for, its site is there twice: once as it asks, once paid. Blocks that their last
# contour can stand for are there by that alone.

MOST_SPLIT = 2
"""Conditions of a site that are paid for by a site of their own, at the most."""


@dataclass(frozen=True, eq=False, slots=True)
class Network:
    """A problem of m sites that no plan undercuts, and what holds wherever a site of it is used.

    `contours` are those of the whole problem that its contours are: of some blocks the last one alone.
    `cost` (m + 1, m + 1) is that of every move with the site it leads to, and with the way through such a block to its
    last contour, home last, infinite where no plan has it: no more than that where there are many sites, as narrow
    numbers do not hold all that wide ones do.
    `sites` (m,) are those of the whole problem that its sites stand for, `inside` the ways through such blocks to them.
    `sooner[s, c]` says that contour c is out before site s is cut, `later[s, c]` that it is not; both (m + 1, n), all
    false for home. `plan` is the known plan on these sites.
    """

    problem: Problem
    contours: Ints
    sites: Ints
    inside: Inside
    cost: Floats | Float32s
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
    for condition in problem.conditions:
        if condition.when is not None:
            hard = condition.cost is not None and condition.cost > most
            conditions_of[condition.when].append(replace(condition, cost=None) if hard else condition)
    splits = _splits(problem, kept, conditions_of, MOST_SPLIT, most)
    if len(splits) > most_sites:
        splits = _splits(problem, kept, conditions_of, 0, most)
    sites = np.array([split.site for split in splits], dtype=np.int64)
    contours = number[problem.site_contour[sites]]
    paid = np.array([sum(c.cost or 0 for c in split.paid) for split in splits], dtype=np.int64)
    wide = [condition for condition in problem.conditions if condition.when is None]
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


# What every move is worth by the multipliers of a linear program: the bound they prove, and what is missing.
#
# The program holds few moves; a bound must hold of all. What they cost stands in one table, gone through some rows at
# a time. Where it is kept in narrow numbers, multipliers are rounded down to such as are summed in them exactly: a
# bound holds whatever the multipliers are.

NEAREST = 3
"""Moves from and to every site that are looked at from the start."""
MORE, MORE_EACH = 8000, 30
"""Moves that are added at once at the most, or so many for every contour, where those are more."""
MARGIN_UM = 0.5
"""Plans cost whole numbers: one that is cheaper than the known one costs 1 less."""
ENOUGH, ENOUGH_OF_PLAN = 1.0, 1e-6
"""A move that would make the program cheaper by no more than this, or this share of the plan, is not missing."""
ROWS = 128
"""Sites whose moves are gone through at once."""


class Multipliers(NamedTuple):
    """Of a linear program: `price` (m + 1,) of the sites, and what is `paid` (k,) for inequalities, never negative."""

    price: Floats
    paid: Floats
    inequalities: Inequalities


class AllMoves:
    """Every move from site to site, home last: which are open, and which of those are in the program.

    Attributes
    ----------
    open, used
        Both (m + 1, m + 1).
    products
        Multiplications that the last look took.
    """

    def __init__(self, network: Network, plan_um: int) -> None:
        m, self._cost, self._plan_um = network.problem.m, network.cost, plan_um
        self._owner = np.append(network.problem.site_contour, network.problem.n)
        self._first = np.append(network.problem.first[:-1], m)
        self.open: Bools = np.isfinite(self._cost)
        self.used: Bools = np.zeros_like(self.open)
        self._own = (np.array([m, *network.plan]), np.array([*network.plan, m]))
        self._forced = np.zeros(len(network.plan) + 1, dtype=np.bool_)
        self._left: Floats | Float32s = np.zeros((0, 0))
        self._enough = min(ENOUGH, ENOUGH_OF_PLAN * plan_um)
        self._at_once = max(MORE, MORE_EACH * network.problem.n)
        self.products, self._most_um = 0, 0.0

    @property
    def narrow(self) -> bool:
        """Whether costs are kept in half the bytes."""
        return bool(self._cost.dtype == np.float32)

    def nearest(self) -> tuple[Ints, Ints]:
        """The cheapest moves from and to every site, and the known plan's own."""
        everywhere, most = np.arange(len(self._owner)), min(NEAREST, len(self._owner)) - 1
        wanted = np.zeros_like(self.open)
        for start in range(0, len(everywhere), ROWS):
            rows = everywhere[start : start + ROWS]
            part = np.argpartition(self._cost[rows], most, axis=1)[:, : most + 1]
            wanted[rows[:, None], part] = True
            part = np.argpartition(self._cost[:, rows], most, axis=0)[: most + 1]
            wanted[part, rows[None, :]] = True
        wanted &= self.open
        wanted[self._own] = True
        leave, reach = np.nonzero(wanted)
        return leave, reach

    def is_own(self, leave: Ints, reach: Ints) -> Bools:
        """Which of these moves are the known plan's."""
        return self._are_of(self._own, leave, reach)

    def costs(self, leave: Ints, reach: Ints) -> Floats:
        """What moves cost: those of the known plan that are not allowed as much as a plan more."""
        cost: Floats = self._cost[leave, reach].astype(np.float64)
        if self._forced.any():
            row, column = self._own
            forced = self._are_of((row[self._forced], column[self._forced]), leave, reach)
            cost[forced] += self._plan_um
        return cost

    def _are_of(self, known: tuple[Ints, Ints], leave: Ints, reach: Ints) -> Bools:
        """Which of some moves are among the known ones."""
        wide = len(self._owner)
        return np.asarray(np.isin(leave * wide + reach, known[0] * wide + known[1]))

    def look(
        self, by: Multipliers, in_use: tuple[Ints, Ints], go: Callable[[], bool] = lambda: True
    ) -> tuple[float, tuple[Ints, Ints] | None]:
        """What coming to every contour costs at least by these multipliers, in sum; and the moves most missing.

        None where none is missing; `in_use` are the moves of the program, and `go` is asked now and then.
        """
        owner, paying = self._owner, by.paid > 0.0
        paid, some = by.paid[paying], by.inequalities.only(paying)
        gain = by.price - paid @ some.into
        kind: Any = self._cost.dtype
        (tails, tail), (heads, head) = (kinds(side) for side in (some.tail, some.head))
        worth = (some.tail[:, tails].T * paid.astype(kind)) @ some.head[:, heads].astype(kind)
        self.products = worth.size * len(paid)
        if not self._left.size:
            self._left = np.empty_like(self._cost)
        left, starts = self._left, range(0, len(owner), ROWS)
        least_in, most_in = np.empty((len(starts), len(owner))), np.empty(len(starts))

        def look_from(start: int) -> None:
            rows = slice(start, start + ROWS)
            part = self._cost[rows].astype(np.float64)
            part -= worth[tail[rows]][:, head]
            part += by.price[rows, None]
            part -= gain[None, :]
            for row, column in zip(*(ends[self._forced] for ends in self._own), strict=True):
                if start <= row < start + ROWS:
                    part[row - start, column] += self._plan_um
            closed = ~self.open[rows]
            part[closed] = -np.inf
            most_in[start // ROWS] = part.max()
            part[closed] = np.inf
            least_in[start // ROWS] = part.min(axis=0)
            left[rows] = part

        by_threads(look_from, starts, go)
        self._most_um = max(float(most_in.max()), -float(least_in.min()))
        self._least: Floats = np.minimum.reduceat(least_in.min(axis=0), self._first)
        return float(self._least.sum()), self._missing(*in_use)

    def _missing(self, leave: Ints, reach: Ints) -> tuple[Ints, Ints] | None:
        left, owner = self._left, self._owner
        known = np.full(len(self._least), np.inf)
        np.minimum.at(known, owner[reach], left[leave, reach])
        limit = (known - self._enough)[owner]
        found, by = [], []
        for start in range(0, len(owner), ROWS):
            rows = slice(start, start + ROWS)
            row, column = np.nonzero((left[rows] < limit[None, :]) & ~self.used[rows])
            found.append(np.stack([row + start, column]))
            by.append(left[row + start, column] - known[owner[column]])
        moves, missing = np.concatenate(found, axis=1), np.concatenate(by)
        if not len(missing):
            return None
        chosen = moves[:, np.argsort(missing, kind="stable")[: self._at_once]]
        return chosen[0], chosen[1]

    def close(self, bound: float) -> bool:
        """Close the moves that no plan has that costs less than the known one, and answer whether there are any.

        By the last look, which proves this bound: a plan with a move costs as much more as the move is dearer than the
        cheapest one. The known plan's own stay, so that there is always a flow.
        """
        left, closes = self._left, False
        wrong = 2.0**-23 * self._most_um
        room = (self._plan_um - MARGIN_UM - bound + (wrong if self.narrow else 0.0) + self._least)[self._owner]
        own = self.open[self._own]
        for start in range(0, len(self._owner), ROWS):
            rows = slice(start, start + ROWS)
            dear = (left[rows] > room[None, :]) & self.open[rows]
            self.open[rows] &= ~dear
            closes = closes or bool(dear.any())
        self.open[self._own] = own
        if closes:
            stays = np.ones(len(self._owner), dtype=np.bool_)
            stays[:-1] = self.open[:, :-1].any(axis=0) & self.open[:-1].any(axis=1)
            self.open[~stays] = False
            self.open[:, ~stays] = False
        return closes

    def restrict(self, allowed: Bools) -> None:
        """Leave these moves alone open, (m + 1, m + 1), and the known plan's own."""
        self.open = allowed.copy()
        self._forced = ~allowed[self._own]
        self.open[self._own] = True

    @property
    def allowed(self) -> Bools:
        """The open moves, without those of the known plan that stay although they are not allowed."""
        allowed = self.open.copy()
        allowed[tuple(ends[self._forced] for ends in self._own)] = False
        return allowed


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


def whole(by: Multipliers, width: int) -> Multipliers:
    """The same with what is paid in multiples of a power of 2: no sum over a site is more than 2 ** `width` of them."""
    paid = by.paid
    most = float((paid @ by.inequalities.tail).max(initial=0.0))
    if most <= 0.0:
        return by
    unit = 2.0 ** (np.ceil(np.log2(most)) - width)
    return by._replace(paid=np.floor(paid / unit) * unit)
