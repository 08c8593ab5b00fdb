"""How many excuses every plan needs, and an order with fewer where a search has not found it.

An excuse weighs more than any plan travels, so that a search which needs several moves to save one never makes the
first of them, and what linear programs prove of such weights says nothing. What excuses hang on is the set of contours
that are out at the moment a contour is cut. So these sets are chosen by constraint programming, of few contours
together: of those that a plan excuses, and round by round of those that an order like the plan's, with these sets,
would excuse or break. Every plan keeps what is asked of the sets, so that none has fewer excuses than they need.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from ortools.sat.python.cp_model import FEASIBLE, OPTIMAL, CpModel, LiteralT

from kerfwise.arrays import Ints
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.lawful_walk import EXCUSE_UM, route_like
from kerfwise.models.engines.solution import Incumbent
from kerfwise.models.engines.tuning import EXCUSES_MOST_ROWS as MOST_ROWS
from kerfwise.models.engines.tuning import EXCUSES_ROWS_PER_S as ROWS_PER_S
from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.moves import MovePrices
from kerfwise.models.problem.precedence import close, known_immediate_pairs
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.stating.feasible_order import quiet_solver


@dataclass(frozen=True, slots=True)
class FewestExcuses:
    """What excuses cost every plan at least, µm; a route with fewer than the plan has, which may break other things."""

    least_um: int
    route: tuple[int, ...] | None
    work: float


def without_excuses(problem: Problem) -> Problem:
    """The problem without what excuses cost: every plan costs that much less."""
    light = (c if c.cost is None else replace(c, cost=c.cost % EXCUSE_UM) for c in problem.conditions)
    conditions = tuple(c for c in light if c.cost != 0)
    return replace(problem, conditions=conditions, site_cost=problem.site_cost % EXCUSE_UM)


def excused_um(problem: Problem, route: Sequence[int]) -> int:
    """What the excuses of a route cost, as far as sets of contours and ways to cut them decide that."""
    asking, place = _asking(problem), {int(problem.site_contour[s]): k for k, s in enumerate(route)}
    return EXCUSE_UM * sum(
        _short(problem, asking[contour], place, contour, [route[k]])[1] for contour, k in place.items()
    )


def fewest_excuses(problem: Problem, plan: Incumbent, deadline: Deadline) -> FewestExcuses:
    """What excuses cost every plan at least, as far as that is shown before the deadline."""
    asking, began = _asking(problem), deadline.left
    order = [int(problem.site_contour[s]) for s in plan.route]
    chosen = _wrong(problem, asking, order, plan.route)
    most, least = excused_um(problem, plan.route) // EXCUSE_UM, 0
    route: tuple[int, ...] | None = None
    while least < most and (sets := _Sets.of(problem, asking, chosen, deadline)):
        shown, before = sets.least(deadline)
        least = max(least, shown)
        if before is None or least >= most:
            break
        bare = replace(problem, before=before, conditions=(), lags=(), moves=MovePrices())
        if (along := route_like(bare, plan.route)) is None:
            break
        order = [int(problem.site_contour[s]) for s in along]
        if not (more := _wrong(problem, asking, order) - chosen):
            route = _by_the_best_ways(problem, asking, order, plan.route)
            break
        chosen |= more
    return FewestExcuses(least * EXCUSE_UM, route, began - deadline.left)


_Asking = dict[int, list[Condition]]


def _asking(problem: Problem) -> _Asking:
    """The hard conditions of each contour, and those that may be excused."""
    found: _Asking = defaultdict(list)
    for c in problem.conditions:
        if c.cost is None or c.cost >= EXCUSE_UM:
            found[c.contour].append(c)
    return found


def _wrong(problem: Problem, asking: _Asking, order: Sequence[int], route: Sequence[int] = ()) -> set[int]:
    """The contours that an order, or the route along it, excuses, or that something hard is not kept of."""
    place = {contour: k for k, contour in enumerate(order)}
    ways = [[site] for site in route] if route else [problem.sites(contour) for contour in order]
    return {k for k, sites in zip(order, ways, strict=True) if _short(problem, asking[k], place, k, sites) != (0, 0)}


def _by_the_best_ways(problem: Problem, asking: _Asking, order: Sequence[int], known: Sequence[int]) -> tuple[int, ...]:
    """A route along an order, each contour cut as it is in a known route where nothing is better."""
    place, liked = {contour: k for k, contour in enumerate(order)}, set(known)

    def worse(site: int) -> tuple[tuple[int, int], bool, int]:
        contour = int(problem.site_contour[site])
        return _short(problem, asking[contour], place, contour, [site]), site not in liked, int(problem.site_cost[site])

    return tuple(min(problem.sites(contour), key=worse) for contour in order)


def _short(
    problem: Problem, asked: Iterable[Condition], place: dict[int, int], contour: int, ways: Sequence[int]
) -> tuple[int, int]:
    """What is hard and not kept, and how many excuses it takes, with the best of these ways to cut a contour."""
    unmet = [
        c
        for c in asked
        if sum(w for k, w in zip(c.members, c.weights, strict=True) if place[k] < place[contour]) < c.bound
    ]
    found = []
    for site in ways:
        costs = [c.cost for c in unmet if c.when in (None, site)]
        excuses = sum(cost // EXCUSE_UM for cost in costs if cost is not None)
        found.append((costs.count(None), excuses + int(problem.site_cost[site]) // EXCUSE_UM))
    return min(found)


class _Sets:
    """What is out before each of some contours, as literals: what they ask for is a sum over its own set.

    What is cut in one go is all in such a set or all out of it. Of two of the contours the set of one lies within that
    of the other, and each is closed under the hard orders.
    """

    def __init__(self, problem: Problem, asking: _Asking, chosen: Sequence[int]) -> None:
        self._problem, self._chosen, self._model = problem, chosen, CpModel()
        self._literal: dict[tuple[int, int], LiteralT] = {}
        self._excuses: list[LiteralT] = []
        self._weights: list[int] = []
        for members, some, links in _knots(problem, chosen):
            self._nest(members, some, links)
        for contour in chosen:
            self._ask(contour, asking[contour])

    @classmethod
    def of(cls, problem: Problem, asking: _Asking, chosen: Iterable[int], deadline: Deadline) -> _Sets | None:
        """The model; None where it would be too large, or nothing is left."""
        some = sorted(chosen)
        rows = len(some) * (known_immediate_pairs(problem.before).shape[1] + len(some) * problem.n)
        if rows > MOST_ROWS or rows / ROWS_PER_S > deadline.left or not some:
            return None
        deadline.spend(rows / ROWS_PER_S)
        return cls(problem, asking, some)

    def _before(self, k: int, contour: int) -> LiteralT:
        """Literal: k is out when the contour is cut."""
        problem = self._problem
        if k == contour or problem.before[contour, k]:
            return False
        if problem.before[k, contour]:
            return True
        blocks = problem.block[k], problem.block[contour]
        one, other = (k, contour) if blocks[0] == blocks[1] else (-1 - int(blocks[0]), -1 - int(blocks[1]))
        if (one, other) not in self._literal:
            literal = self._model.new_bool_var("")
            self._literal[one, other], self._literal[other, one] = literal, literal.negated()
        return self._literal[one, other]

    def _nest(self, members: Sequence[int], some: Sequence[int], links: Sequence[Sequence[int]]) -> None:
        """Closes the sets before some of the members, and has one lie within the other."""
        for contour in some:
            for one, other in links:
                self._if(self._before(other, contour), True, self._before(one, contour))
            for within in some:
                inside = self._before(within, contour)
                for k in members if within != contour else ():
                    self._if(inside, self._before(k, within), self._before(k, contour))

    def _if(self, one: LiteralT, other: LiteralT, then: LiteralT) -> None:
        if one is False or other is False or then is True:
            return
        self._model.add_bool_or(then).only_enforce_if(one, other)

    def _ask(self, contour: int, asked: Iterable[Condition]) -> None:
        """What is asked of a contour, by the way it is cut; each excuse is counted."""
        sites = {site: self._model.new_bool_var("") for site in self._problem.sites(contour)}
        self._model.add_exactly_one(sites.values())
        for site, used in sites.items():
            if excuses := int(self._problem.site_cost[site]) // EXCUSE_UM:
                self._excuses.append(used)
                self._weights.append(excuses)
        for c in asked:
            premise: list[LiteralT] = [] if c.when is None else [sites[c.when]]
            if c.cost is not None:
                excuse = self._model.new_bool_var("")
                self._excuses.append(excuse)
                self._weights.append(c.cost // EXCUSE_UM)
                premise.append(excuse.negated())
            total = sum(w * self._before(k, contour) for k, w in zip(c.members, c.weights, strict=True))
            if isinstance(total, int):
                if total < c.bound:
                    self._model.add_bool_or(False).only_enforce_if(premise)
            else:
                self._model.add(total >= c.bound).only_enforce_if(premise)

    def least(self, deadline: Deadline) -> tuple[int, np.ndarray | None]:
        """How many excuses the sets need at least; and hard orders with those of such sets, None if none are known."""
        self._model.minimize(sum(w * x for w, x in zip(self._weights, self._excuses, strict=True)))
        solver = quiet_solver(deadline.left)
        if deadline.timed:
            solver.parameters.max_time_in_seconds = max(deadline.left, 0.0)
        status = solver.solve(self._model)
        deadline.spend(solver.response_proto.deterministic_time)
        shown = max(0, math.ceil(solver.best_objective_bound - 1e-6))
        if status not in (OPTIMAL, FEASIBLE):
            return shown, None
        pairs = [tuple(p) for p in known_immediate_pairs(self._problem.before).T.tolist()]
        for contour in self._chosen:
            for k in range(self._problem.n):
                literal = self._before(k, contour)
                if not isinstance(literal, bool):
                    pairs.append((k, contour) if solver.boolean_value(literal) else (contour, k))
        before = close(self._problem.n, pairs, self._problem.block)
        return shown, before


def _knots(problem: Problem, chosen: Sequence[int]) -> Iterable[tuple[list[int], list[int], list[Sequence[int]]]]:
    """Contours that stand for their blocks, and those within each block: all, the chosen of them, immediate orders."""
    block, links = problem.block, known_immediate_pairs(problem.before).T
    names, first = np.unique(block, return_index=True)
    of = first[np.searchsorted(names, block)]
    yield (
        first.tolist(),
        np.unique(of[list(chosen)]).tolist(),
        _distinct(of[links][block[links[:, 0]] != block[links[:, 1]]]),
    )
    for name in np.unique(block[list(chosen)]):
        inside = np.flatnonzero(block == name)
        within = links[(block[links] == name).all(axis=1)]
        yield inside.tolist(), [k for k in chosen if block[k] == name], _distinct(within)


def _distinct(links: Ints) -> list[Sequence[int]]:
    return [] if not len(links) else np.unique(links, axis=0).tolist()
