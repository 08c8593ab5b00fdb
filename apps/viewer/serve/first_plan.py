"""A lawful plan at once: from a plan at hand, in which only what changed is free, or else by a first short search."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from kerfwise.arrays import Bools
from kerfwise.encoder.already_cut import NOTHING_CUT, AlreadyCut
from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.geometry.tolerances import UM_PER_MM
from kerfwise.jobs.inputs import Inputs, of_first_torch
from kerfwise.jobs.plan_nest import VerifiedPlan, plan_of, seen_after, verified
from kerfwise.jobs.request import Request, facts_of, make_request
from kerfwise.jobs.resume import lock_broken_cut_first
from kerfwise.models.engines.deadline import Progress
from kerfwise.models.engines.solution import Solution, SolveOptions
from kerfwise.models.plan.explain import try_order
from kerfwise.models.plan.explain.context import PlanContext, make_context
from kerfwise.models.plan.plan import Plan
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.stating.lazy_statements import lazy_statements

FIRST_WORK = 0.05
"""Work of a first search, where no plan is at hand or it cannot be kept to."""
BETTER_WORK, BETTER_SHARE = 0.3, 0.1
"""Work of a short search from the first plan on, and the most of it as a share of the work of the whole."""
FEW = 8
"""Contours up to which no first plan is looked for: the best one is found as soon."""


class FirstPlans:
    """The first plans of a nest: `at_once`, and after a short search from there on `better`.

    Parameters
    ----------
    inputs
        Nest and profile.
    limits
        Of the whole planning.
    already
        What a stopped program has cut.
    progress
        Asked now and then whether to go on.

    Raises
    ------
    InputError, RulesConflict
        As `plan_nest` does, if the nest cannot be planned.
    """

    def __init__(
        self,
        inputs: Inputs,
        limits: SolveOptions,
        already: AlreadyCut = NOTHING_CUT,
        progress: Progress | None = None,
    ) -> None:
        self.profile = lock_broken_cut_first(inputs.profile, already)
        facts = facts_of(inputs.nest, self.profile, already)
        self.request = make_request(facts, self.profile)
        self._limits, self._progress = limits, progress

    def at_once(self, start: Plan | None = None) -> Solution | None:
        """A lawful route: the order of a plan at hand with what the locks change in it, or what a search finds first.

        None where neither is found so soon.
        """
        if start is not None and (kept := self._along(start)) is not None:
            return kept
        return self._searched(FIRST_WORK)

    def better(self, first: Solution) -> Solution | None:
        """What a short search finds from a first plan on; None where that is no better."""
        found = self._searched(min(BETTER_WORK, BETTER_SHARE * self._limits.work), first)
        return found if found is not None and found.objective < first.objective else None

    def verified(self, solution: Solution) -> VerifiedPlan:
        """The plan of a route with its program and the verdict on both."""
        return verified_plan(self.request, self.profile, solution, self._limits)

    def _along(self, start: Plan) -> Solution | None:
        start = of_first_torch(start)
        try:
            setting = make_context(self.request.facts, self.profile, self.request.stated, start)
        except (InputError, RulesConflict):  # it is one of another drawing
            return None
        problem = setting.problem
        for tried in _orders(setting, _places(self.profile, self.request.facts.nest.index, start)):
            judged = try_order(setting, tried)
            if judged.cost is not None:
                route = tuple(int(problem.site_candidate[s]) for s in judged.route)
                return Solution(route, judged.cost / UM_PER_MM, None, "feasible", "search", "", 0.0, problem=problem)
        return None

    def _searched(self, work: float, start: Solution | None = None) -> Solution | None:
        from kerfwise.models.engines.solve import solve

        facts, limits = self.request.facts, replace(self._limits, member="search", work=work, gap=None)
        looks, route = lazy_statements(facts, self.profile), () if start is None else start.route
        try:
            return solve(facts, self.request.stated.statements, limits, self._progress, looks, start=route)
        except (InputError, RulesConflict):
            return None


def verified_plan(request: Request, profile: Profile, solution: Solution, limits: SolveOptions) -> VerifiedPlan:
    """The plan of a route that was found meanwhile, without the reasons for its order, and the verdict on it."""
    seen = seen_after(request.facts, profile, solution.route)
    plan = plan_of(request, profile, solution, limits, seen, reasons=False)
    return verified(request.facts, profile, plan, solution)


def _places(profile: Profile, index: dict[str, int], start: Plan) -> dict[int, int]:
    """Contour → its place in the order, from 0, by the locks."""
    done, count = len(start.already_cut), len(index)
    ends = {"first": done + 1, "last": done + count}
    found = {}
    for lock in profile.locks:
        if lock.contour in index and lock.position is not None:
            at = lock.position if isinstance(lock.position, int) else ends[lock.position]
            found[index[lock.contour]] = at - 1 - done
    return {contour: at for contour, at in found.items() if 0 <= at < count}


def _orders(setting: PlanContext, places: dict[int, int]) -> Iterator[list[int]]:
    """Orders near to one at hand: locked contours at their places; and then with what has to come before moved, too."""
    order, placed = setting.order, {at: contour for contour, at in places.items()}
    if len(placed) < len(places):
        return
    ahead = iter([c for c in order if c not in places])
    yield [placed[k] if k in placed else next(ahead) for k in range(len(order))]
    if (kept := _kept_order(order, setting.problem.before, places)) is not None:
        yield kept


def _kept_order(order: Sequence[int], before: Bools, places: dict[int, int]) -> list[int] | None:
    """The order at hand as far as hard orders and places allow; None where they do not.

    Contour after contour, the next of the order that may come: whose predecessors are out, and after which all that
    has to be out before a locked contour can still be.
    """
    n = len(order)
    rank = np.empty(n, dtype=np.int64)
    rank[list(order)] = np.arange(n)
    due = np.full(n, n)
    for contour, at in places.items():
        due[contour] = at
        due[before[:, contour]] = np.minimum(due[before[:, contour]], at - 1)
    waits, out = before.sum(axis=0).astype(np.int64), np.zeros(n, dtype=np.bool_)
    at_place = {at: contour for contour, at in places.items()}
    made: list[int] = []
    for k in range(n):
        free = ~out & (waits == 0)
        if (pinned := at_place.get(k)) is not None:
            free &= np.arange(n) == pinned
        else:
            free[list(places)] = False
            for last in np.unique(due[~out & (due < n)]).tolist():
                pressing = ~out & (due <= last)
                if int(pressing.sum()) >= last - k + 1:
                    free &= pressing
                    break
        if not free.any():
            return None
        chosen = int(np.where(free, rank, n).argmin())
        made.append(chosen)
        out[chosen] = True
        waits -= before[chosen]
    return made
