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
from dataclasses import dataclass, replace

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.models.engines import bounds
from kerfwise.models.engines.bounds.reduced import Reduced, entering, reduced
from kerfwise.models.engines.solution import Incumbent, Progress
from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.statements import About

from .alone import FAR, alone, conditions_within, ends_of
from .backward import MOST_NEIGHBOURS, Settled, settle
from .budget import SweepBudget
from .by_contour import ByContour
from .crossed import HOME, add_settled
from .priced_stretches import Found, Priced, PricedStretches
from .series import series
from .stretches import home_from, travel_between
from .ways_over import crossing_within, ways_over

ABOUT = About("network", (), "what a site asks that is split by its conditions")
WALKS = 0.05
"""Share of the work that bounds by walks may take."""
SEVERAL = 3.0
"""A sweep backwards may take as many times its even share of what is left, as most need little."""


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
