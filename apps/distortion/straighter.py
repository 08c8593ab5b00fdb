"""Plans that bend their parts less: a search whose every step is a simulation of the whole program.

Where a part is entered, and which way round it is cut, matters mostly to that part alone. So the ways of all parts are
tried at once: in every simulation each part is cut another way, and then all are cut as each of them was best. From
there on the search is local: a part is entered elsewhere, cut earlier or later, some parts are cut in the opposite
order. The rules hold in every route, and the best of all that were simulated is taken.
"""

from __future__ import annotations

import math
import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from kerfwise.arrays import Floats
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.geometry.tolerances import UM_PER_MM
from kerfwise.jobs.by_engine import OrdersOf
from kerfwise.jobs.cooler_orders import BestSimulated, Judge, MayGoOn, Planner, Route
from kerfwise.jobs.first_plan import nearest_way
from kerfwise.jobs.inputs import Inputs, expect_one_torch, of_first_torch
from kerfwise.jobs.route_paths import RoutePaths
from kerfwise.models.engines.lawful_walk import route_like
from kerfwise.models.physics.heat.timed_path import TorchOn
from kerfwise.models.physics.time_and_cost import feeds_of
from kerfwise.models.plan.plan import Plan
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.stating.state_rules import Stated

from .cutting import cell_mm, cut_sheet, cutting_of
from .elasticity import metal_of
from .part_errors import errors_of
from .tolerances import tolerances_of

CELLS = 2000
"""Cells of a sheet while plans are looked for. On 800 the plans found seemed better than they are: 23 % less error,
15 % on a finer mesh."""
SWEEPS = 2
"""How often the ways of all parts are tried at once."""
WAYS = 16
"""Ways of each contour that one sweep tries."""
STEPS_EACH, FEWEST, MOST = 1, 12, 60
"""Steps of the local search: so many for each contour, and at least and at most."""
MOST_MOVES = 3
"""Changes that make one step."""
WARMTH = 0.001
"""How much worse, as a share of the first plan's error, a step may be at the beginning to be taken now and then."""


@dataclass(frozen=True, eq=False, slots=True)
class SimulatedPlan:
    """A route (candidates), how far each part is off, mm (p,), and what it costs by the statements, mm."""

    route: Route
    off_mm: Floats
    cost_mm: float

    def total_mm(self, price_mm: float) -> float:
        """What it costs where a mm of the mean error costs `price_mm`."""
        return self.cost_mm + price_mm * float(self.off_mm.mean())


class StraighterOrders:
    """Routes of a nest whose parts' errors are simulated and remembered.

    Parameters
    ----------
    facts, stated
        Of the nest, and its rules.
    profile
        Machine, material and heat.
    start
        A plan of the nest, or of the one that it was before it was compensated: it is tried before all others.
    """

    def __init__(self, facts: Facts, profile: Profile, stated: Stated, start: Plan | None = None) -> None:
        nest = facts.nest
        self._nest, self._heat = nest, profile.heat
        self._problem = make_problem(facts, stated.statements, profile.home_on(nest), feeds_of(profile))
        self._facts, self.paths = facts, RoutePaths(facts, profile, stated)
        self.how = cutting_of(profile.material, cell_mm(nest, CELLS))
        self._part = nest.owners
        self._candidates: list[list[int]] = [[] for _ in nest.contours]
        for candidate, site in enumerate(self._problem.candidate_site.tolist()):
            if site >= 0:
                self._candidates[int(self._problem.site_contour[site])].append(candidate)
        self.tried: dict[Route, SimulatedPlan] = {}
        self._start = None if start is None else self.like(start)

    def like(self, plan: Plan) -> Route | None:
        """The route as much like a plan's as the rules allow, its entries included; None of a plan of another nest."""
        cuts = [row.cut for row in of_first_torch(plan).cuts]
        if {cut.contour for cut in cuts} != self._nest.index.keys():
            return None
        lawful = self._problem.candidate_site >= 0
        return self._lawful([nearest_way(self._facts, cut, lawful) for cut in cuts])

    def price_mm(self, profile: Profile) -> float:
        """Of a mm of error, mean over the parts of their worst places, mm of idle travel."""
        return profile.objective.distortion

    def ways(self, contour: int, begin_s: float) -> list[tuple[TorchOn, ...]]:
        """The torch's path round a contour by each of its candidates, those that no rule allows there included."""
        facts = self._facts
        numbers = range(int(facts.first[contour]), int(facts.first[contour + 1]))
        return [self.paths.burn(k, begin_s, facts.candidates[k].pierce)[0] for k in numbers]

    def find(
        self, price_mm: float, planner: Planner, judge: Judge | None = None, going: MayGoOn = lambda: True,
        seed: int = 1,
    ) -> BestSimulated:  # fmt: skip
        """The best route found where a mm of the mean error costs as much as `price_mm` of idle travel.

        Raises RulesConflict if there is no plan to begin with.
        """
        chance, judged = random.Random(seed), dict[Route, float | None]()
        at = self._simulated(tuple(map(int, planner(0, ()))))
        best = at, (None if judge is None else judge(at.route)) or at.cost_mm

        def better(than_mm: float, one: SimulatedPlan) -> float | None:
            """What a plan costs by all rules, if that is lawful and comes to no more than this with its error."""
            if one.total_mm(price_mm) > than_mm:
                return None
            if one.route not in judged:
                judged[one.route] = one.cost_mm if judge is None else judge(one.route)
            cost_mm = judged[one.route]
            return None if cost_mm is None or cost_mm - one.cost_mm + one.total_mm(price_mm) > than_mm else cost_mm

        def all_in(found: tuple[SimulatedPlan, float]) -> float:
            return found[1] - found[0].cost_mm + found[0].total_mm(price_mm)

        if self._start is not None:
            self._simulated(self._start)
        for known in list(self.tried.values()):  # the plan at hand, and those for another price
            if (cost_mm := better(all_in(best), known)) is not None:
                best = known, cost_mm
        steps = min(MOST, max(FEWEST, STEPS_EACH * self._problem.n))
        warmth_mm = WARMTH * price_mm * float(at.off_mm.mean())
        now = [best]
        for share, route in self._routes(now, steps, chance):
            if not going():
                break
            if route is None or route in self.tried:
                continue
            one = self._simulated(route)
            more_mm = -math.log(1.0 - chance.random()) * warmth_mm * (1 - share)
            if (cost_mm := better(all_in(now[0]) + more_mm, one)) is not None:
                now[0] = one, cost_mm
                best = min(best, now[0], key=all_in)
        return BestSimulated(best[0].route, best[1], float(best[0].off_mm.mean()))

    def _routes(
        self, now: Sequence[tuple[SimulatedPlan, float]], steps: int, chance: random.Random
    ) -> Iterator[tuple[float, Route | None]]:
        """Routes to simulate one after the other, and how far the search has come, 0 to 1; None is an attempt failed.

        `now` has the plan that it has come to, which changes meanwhile.
        """
        for _ in range(SWEEPS):
            order = now[0][0].route
            first = [chance.randrange(len(ways)) if ways else 0 for ways in self._candidates]
            for k in range(min(WAYS, max(map(len, self._candidates), default=0))):
                ways = {
                    c: self._candidates[c][(first[c] + k) % len(self._candidates[c])] for c in map(self._contour, order)
                }
                yield 0.0, self._lawful([ways[self._contour(c)] for c in order])
            yield 0.0, self._lawful(self._as_best(order, range(len(self._nest.parts))))
        for k in range(steps):
            yield k / steps, self._lawful(self._changed(now[0][0], chance))

    def _contour(self, candidate: int) -> int:
        return int(self._problem.site_contour[self._problem.candidate_site[candidate]])

    def _as_best(self, route: Sequence[int], parts: Sequence[int]) -> list[int]:
        """The route with each of these parts entered as in that simulation which had it straightest."""
        wanted: dict[int, int] = {}
        plans = list(self.tried.values())
        off_mm = np.array([plan.off_mm for plan in plans])
        for part in parts:
            best = plans[int(off_mm[:, part].argmin())].route
            wanted |= {self._contour(c): c for c in best if self._part[self._contour(c)] == part}
        return [wanted.get(self._contour(c), c) for c in route]

    def _changed(self, plan: SimulatedPlan, chance: random.Random) -> list[int]:
        """The route with a few changes to parts, more often to those that are far off."""
        route = list(plan.route)
        for _ in range(chance.choice((1, 1, 2, MOST_MOVES))):
            (part,) = chance.choices(range(len(plan.off_mm)), (plan.off_mm + 1e-9).tolist())
            mine = [c for c in route if self._part[self._contour(c)] == part]
            kind = chance.random()
            if not mine:
                continue
            if kind < 0.3:
                old = chance.choice([*mine, mine[-1]])  # the outer contour is the last, and bends most
                route[route.index(old)] = chance.choice(self._candidates[self._contour(old)])
            elif kind < 0.4:
                route = self._as_best(route, [part])
            elif kind < 0.75:
                rest = [c for c in route if c not in mine]
                place = chance.randint(0, len(rest))
                route = [*rest[:place], *mine, *rest[place:]]
            else:
                a, b = sorted((chance.randrange(len(route)), chance.randrange(len(route))))
                route[a : b + 1] = route[a : b + 1][::-1]
        return route

    def _lawful(self, wanted: Sequence[int]) -> Route | None:
        """A route (candidates) as much like the wanted one as the rules allow; None where that comes to no end."""
        problem = self._problem
        liked = {int(problem.candidate_site[c]): c for c in wanted}
        sites = route_like(problem, [int(problem.candidate_site[c]) for c in wanted])
        if sites is None or broken(problem, sites):
            return None
        return tuple(liked.get(s, int(problem.site_candidate[s])) for s in sites)

    def _simulated(self, route: Route) -> SimulatedPlan:
        if route not in self.tried:
            moved = cut_sheet(self._nest, self.paths.of(route), self._heat, self.how)
            off_mm = np.array([error.max_mm or 0.0 for error in errors_of(self._nest, moved)])
            sites = self._problem.candidate_site[list(route)].tolist()
            self.tried[route] = SimulatedPlan(route, off_mm, route_cost(self._problem, sites) / UM_PER_MM)
        return self.tried[route]


def straighter_for(profile: Profile, start: Plan | None = None) -> OrdersOf | None:
    """What finds straighter orders, from a plan at hand on, where the profile has a price on distortion.

    Raises InputError if it has one on overheats as well, several torches, or a material of unknown strength.
    """
    if not profile.objective.distortion:
        return None
    if profile.objective.heat:
        raise InputError(
            "objective: plans are chosen by one simulation: give a price for heat or for distortion, not for both"
        )
    expect_one_torch(profile, "the price of distortion")
    metal_of(profile.heat.material)
    return partial(StraighterOrders, start=start)


def orders_for(inputs: Inputs, start: Plan | None = None) -> OrdersOf | None:
    """What finds straighter orders, if there is a price on distortion; for a nest whose parts' errors are asked for.

    Raises InputError if they cannot be simulated: of several torches, of an unknown metal, or with a tolerance that is
    no length.
    """
    tolerances_of(inputs.nest, inputs.profile)
    expect_one_torch(inputs.profile, "the simulation of distortion")
    metal_of(inputs.profile.heat.material)
    return straighter_for(inputs.profile, start)
