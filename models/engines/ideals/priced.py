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

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.models.engines import bounds
from kerfwise.models.engines.bounds.move_costs import Moves, open_crossings, passages_of, stand_for
from kerfwise.models.engines.bounds.network import Network
from kerfwise.models.engines.bounds.reduced_costs import ReducedCosts, entering, reduced_costs
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.ideals.stretches.priced_stretches import Priced, PricedStretches, StretchPrices
from kerfwise.models.engines.ideals.stretches.stretch_tables import (
    FAR,
    HOME,
    add_settled,
    conditions_within,
    crossing_price,
    ends_of,
    home_from,
    stretch_problem,
    travel_between,
)
from kerfwise.models.engines.solution import Incumbent
from kerfwise.models.engines.tuning import BACKWARD_MOST_NEIGHBOURS as MOST_NEIGHBOURS
from kerfwise.models.engines.tuning import SEVERAL, WALKS
from kerfwise.models.problem.bitsets import Masks, words
from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.crossings import Crossings
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.statements import About

from .lattice import sweeping
from .stretch import ConditionsByContour, CrossingAlternatives, nothing_over, series
from .stretches.priced_stretches import Settled, settle

ABOUT = About("network", (), "what a site asks that is split by its conditions")


def price(
    problem: Problem,
    incumbent: Incumbent,
    deadline: Deadline,
    earlier: Sequence[StretchPrices] = (),
    swept: float = 0.0,
    overdrawn_s: float = 0.0,
) -> PricedStretches | None:
    """Solve the linear program of every stretch, the last first, and sweep it backwards.

    Parameters
    ----------
    incumbent
        A lawful plan.
    deadline
        Its work is that of all programs.
    swept
        Deterministic seconds of all sweeps backwards.
    overdrawn_s
        Deterministic seconds by which the bounds by walks may take more than is left.
    earlier
        What was found of the same problem with fewer statements: it stays where a stretch is as it was.

    Returns
    -------
    None where that cannot be had within the work or the memory.
    """
    groups = series(problem)
    weight = np.array([float(np.diff(problem.first)[list(group)].sum()) ** 2 for group in groups])
    until = np.cumsum([len(group) for group in groups]).tolist()
    parts = ConditionsByContour(problem)
    deadline.engine = "ideals"
    deadline("ideals", incumbent.cost, None)
    found: list[Priced] = []
    spent, swept_left, left_bytes = 0.0, swept, deadline.most_bytes
    for k in reversed(range(len(groups))):
        share = (deadline.work - spent) * float(weight[k] / weight[: k + 1].sum())
        before = ends_of(problem, groups[k - 1])[1] if k else np.array([HOME])
        out = frozenset(c for group in groups[:k] for c in group)
        route = incumbent.route[until[k] - len(groups[k]) : until[k]]
        known = earlier[k] if len(earlier) == len(groups) else None
        onward = found[-1].onward if found else home_from(problem, ends_of(problem, groups[k])[1])
        query = _Asked(parts.of(groups[k]), groups[k], before, out, onward, known)
        left_s = deadline.work - spent + overdrawn_s
        here, took = query.priced(route, incumbent.cost, deadline.counting(share, most_bytes=left_bytes), left_s)
        spent += took
        if here is None:
            return None
        left_bytes -= here.nbytes
        if left_bytes < 0.0:
            return None
        if swept > 0.0:
            most = sweeping(deadline, swept_left * (SEVERAL / (k + SEVERAL)), deadline.most_bytes - left_bytes)
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
    known: StretchPrices | None

    def priced(self, route: Sequence[int], known: int, deadline: Deadline, most: float) -> tuple[Priced | None, float]:
        """It under its multipliers, and the deterministic seconds that took; a lawful plan has `route` there.

        None where a single round of the bound by walks takes `most` deterministic seconds or more.
        """
        problem, own = self.problem, self.problem.sites_of(self.group)
        leave = ends_of(problem, self.group)[1]
        travel = travel_between(problem, self.before, own)
        add_settled(problem, self.earlier, self.before, own, travel)
        travel = np.minimum(travel, FAR)
        apart = stretch_problem(problem, self.group, own, travel.min(axis=0), leave, np.minimum(self.onward, FAR))
        apart = replace(apart, conditions=tuple(conditions_within(problem, self.group, own, self.earlier)))
        apart = crossing_within(problem, self.group, own, self.earlier, apart)
        plan = tuple(np.searchsorted(own, route).tolist())
        of_plan = Incumbent(plan, route_cost(apart, plan))
        programs = deadline.counting((1.0 - WALKS) * deadline.work)
        relaxed = reduced_costs(apart, of_plan, known, programs, self.known and self.known.by)
        if relaxed is None:
            return None, deadline.work
        posed = _posed(relaxed)
        target = float(max(1, of_plan.cost - relaxed.bound))
        walked = replace(posed, matrix=relaxed.dear, conditions=())
        walks = deadline.counting(WALKS * deadline.work)
        try:
            rest = bounds.complete(walked, target, walks, MOST_NEIGHBOURS, most)
        except bounds.TooMuch:
            return None, deadline.work
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

    def _as_it_was(self, known: StretchPrices, relaxed: ReducedCosts, entry: Ints) -> bool:
        """Whether all costs are what they were, those of coming to the stretch and leaving it included."""
        return (
            relaxed.by.multipliers is known.by.multipliers
            and np.array_equal(entry, known.entry)
            and np.array_equal(relaxed.network.cost, known.by.network.cost)
        )


def _posed(relaxed: ReducedCosts) -> Problem:
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


# The ways of the moves of a network that lead over what may be out: how much longer each is, and what it crosses.

_Ways = tuple[Ints, Ints, Masks]


def crossing_within(
    problem: Problem, group: tuple[int, ...], own: Ints, earlier: frozenset[int], apart: Problem
) -> Problem:
    """A stretch as a problem `apart`, with sites `own` of the whole one, and what its moves cross.

    What is over contours of `earlier`, which are out, and over the one that is left, its table of moves has.
    """
    if not len(problem.crossings):
        return apart
    assert apart.matrix is not None
    matrix = apart.matrix.copy()
    add_settled(problem, earlier, own, own, matrix[:-1, :-1])
    site, number = np.full(problem.m + 1, -1, dtype=np.int64), np.full(problem.n, -1, dtype=np.int64)
    site[own], number[list(group)] = np.arange(len(own)), np.arange(len(group))
    rows = problem.crossings.renumbered(site)
    rows = replace(rows, over=number[rows.over])
    rows = rows.only((rows.over >= 0) & (rows.over != apart.site_contour[rows.leave]))
    return replace(apart, matrix=matrix, crossings=rows)


def ways_over(apart: Problem, network: Network, useful: Bools) -> CrossingAlternatives:
    """What the moves of a network of a problem cost more for what is out; `useful` (m, m) are those that plans have.

    What is out in all orders that have a move, the network's costs have.
    """
    width = words(network.problem.n)
    rows = apart.crossings.only(open_crossings(apart))
    if not len(rows):
        return nothing_over(width)
    passages = passages_of(apart)
    _, number, last_of = stand_for(apart, passages)
    masks = _Masks(apart.m, rows, number[last_of[rows.over]], width)
    last = np.isin(network.contours, [passage.last for passage in passages])
    direct = useful & ~last[network.problem.site_contour][None]
    found = [_straight(network, masks, direct), *_through(apart, network, masks, useful, crossing_price(apart))]
    move, extra, mask = (np.concatenate(column) for column in zip(*found, strict=True))
    order = np.argsort(move, kind="stable")
    begin = np.searchsorted(move[order], np.arange(network.problem.m**2 + 1)).astype(np.int64)
    return CrossingAlternatives(begin, extra[order], mask[order], network.problem.m, np.array([crossing_price(apart)]))


class _Masks:
    """What the moves between sites of a problem cross: contours of its network, numbered `over` (rows,), as sets."""

    def __init__(self, m: int, rows: Crossings, over: Ints, width: int) -> None:
        self._m = m
        self._moves, at = np.unique(rows.leave.astype(np.int64) * m + rows.reach, return_inverse=True)
        self._masks = np.zeros((len(self._moves) + 1, width), dtype=np.uint64)  # the last is that of nothing
        bit = np.uint64(1) << (over % 64).astype(np.uint64)
        np.bitwise_or.at(self._masks, (at, over // 64), bit)

    def of(self, leave: Ints, reach: Ints) -> Masks:
        """The sets that some moves cross, (moves, words)."""
        wanted = leave * self._m + reach
        at = np.minimum(np.searchsorted(self._moves, wanted), len(self._moves) - 1)
        found: Masks = self._masks[np.where(self._moves[at] == wanted, at, len(self._moves))]
        return found


def _straight(network: Network, masks: _Masks, direct: Bools) -> _Ways:
    """The one way of every move to a contour that stands for itself alone, where it crosses something."""
    leave, reach = np.nonzero(direct)
    mask = masks.of(network.sites[leave], network.sites[reach])
    there = mask.any(axis=1)
    move = (leave * network.problem.m + reach)[there]
    return move, np.zeros(len(move), dtype=np.int64), mask[there]


def _through(apart: Problem, network: Network, masks: _Masks, useful: Bools, price: int) -> Iterator[_Ways]:
    """The ways through every block: by the site that it is entered with."""
    moves = Moves(apart)
    for some, here, way in network.inside.ways:
        inner = network.inside.inner[some]
        leave = np.flatnonzero(useful[:, here].any(axis=1))
        entered = moves.between(network.sites[leave], inner)
        at, to = np.nonzero(useful[np.ix_(leave, here)])
        cost = entered[at] + way[:, to].T  # (moves, ways)
        of_all = masks.of(np.repeat(network.sites[leave], len(inner)), np.tile(inner, len(leave)))
        mask = of_all.reshape(len(leave), len(inner), of_all.shape[1])
        order = np.argsort(cost, axis=1, kind="stable")
        ranked, crossed = np.take_along_axis(cost, order, axis=1), mask[at[:, None], order]
        kept = _undominated(ranked, crossed, price)
        kept[~crossed[:, 0].any(axis=1)] = False  # the cheapest way crosses nothing
        move, rank = np.nonzero(kept)
        extra = (ranked[move, rank] - ranked[move, 0]).astype(np.int64)
        yield leave[at[move]] * network.problem.m + here[to[move]], extra, crossed[move, rank]


def _undominated(cost: Floats, mask: Masks, price: int) -> Bools:
    """Which ways, (moves, ways), cheapest first, may be the best: no cheaper one costs less whatever is out."""
    kept = np.isfinite(cost)
    for k in range(1, cost.shape[1]):
        for j in range(k):
            worse = np.bitwise_count(mask[:, j] & ~mask[:, k]).sum(axis=1, dtype=np.int64) * price
            kept[:, k] &= ~(kept[:, j] & (cost[:, j] + worse <= cost[:, k]))
    return kept
