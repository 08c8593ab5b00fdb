"""Orders with few overheats: priced, planned, simulated, and priced anew by what the simulation says of that plan.

Prices that were fitted to random orders predict random orders. The plan that is cheapest by them is not random: it
keeps as many of them as it can at once, and travels little. So it is simulated, with a number of lawful routes near to
it, the prices are fitted to those as well, and the nest is planned again, a few times over. What was simulated is known
and not predicted, so in the end the best of all these routes is taken, whichever way it was found.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from itertools import islice
from typing import Protocol

import numpy as np

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.geometry.tolerances import UM_PER_MM
from kerfwise.models.engines.baselines import random_order
from kerfwise.models.engines.lawful_walk import Walk
from kerfwise.models.engines.tuning import COOLER_ATTEMPTS as ATTEMPTS
from kerfwise.models.engines.tuning import COOLER_LOT as LOT
from kerfwise.models.engines.tuning import COOLER_MOST_MOVES as MOST_MOVES
from kerfwise.models.engines.tuning import COOLER_NEARBY as NEARBY
from kerfwise.models.engines.tuning import COOLER_ORDERS_DRAWN as ORDERS
from kerfwise.models.engines.tuning import COOLER_ROUNDS as ROUNDS
from kerfwise.models.engines.tuning import MOST_PULLED, NEARBY_WEIGHT
from kerfwise.models.heat_prices import HeatPrices, HeatTerms, fit_prices, priced_statements
from kerfwise.models.physics.heat.simulate import simulate
from kerfwise.models.physics.heat.timed_path import Regions, TimedPath, make_grid
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.profile.plant_sections import Heat
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.statements import Statement

from .route_paths import RoutePaths

Route = tuple[int, ...]


Planner = Callable[[int, tuple[Statement, ...]], Sequence[int]]
"""Plans (candidates in cutting order) in a round, from 0, with further statements: none in round 0."""
Judge = Callable[[Sequence[int]], float | None]
"""What a route (candidates) costs by all rules, those that judge whole orders included, mm; None if it is unlawful."""

MayGoOn = Callable[[], bool]
"""Asked after every few simulations whether to go on."""


def _always() -> bool:
    return True


@dataclass(frozen=True, eq=False, slots=True)
class SimulatedRoute:
    """A simulated route (sites): its cost by the statements, mm, and its overheats near each contour, (n,)."""

    route: Route
    cost_mm: float
    hot: Ints
    weight: float

    @property
    def overheats(self) -> int:
        """In all."""
        return int(self.hot.sum())

    def total_mm(self, price_mm: float) -> float:
        """What it costs where an overheat costs `price_mm`."""
        return self.cost_mm + price_mm * self.overheats


@dataclass(frozen=True, eq=False, slots=True)
class BestSimulated:
    """The best route simulated (candidates), its cost by the rules, mm, and what the simulation shows of it.

    `shown` is what has a price: overheats, or how far parts are off, mm. `statements` are the prices in the end.
    """

    route: Route
    cost_mm: float
    shown: float
    statements: tuple[Statement, ...] = ()


class SimulatedOrders(Protocol):
    """Finds orders of a nest by simulating many of them."""

    def price_mm(self, profile: Profile) -> float:
        """What the profile has a unit of that cost which the simulation shows, mm of idle travel."""

    def find(
        self, price_mm: float, planner: Planner, judge: Judge | None = None, going: MayGoOn = _always, seed: int = 1
    ) -> BestSimulated:
        """The best route found where a unit costs as much as `price_mm` of idle travel.

        Raises RulesConflict if round 0 has no plan.
        """


class CoolerOrders:
    """Routes of a nest that are simulated and remembered: what was simulated for one price is known for the next.

    `problem`: made of the facts and the rules' statements, without prices of heat. `heat`: the profile's section
    `heat`. `paths`: the torch's paths of the candidates.
    """

    def __init__(
        self,
        facts: Facts,
        problem: Problem,
        heat: Heat,
        thickness_mm: float,
        paths: RoutePaths,
    ) -> None:
        self._facts, self._problem, self._heat, self._thickness_mm = facts, problem, heat, thickness_mm
        self._paths = paths
        self._grid = make_grid(facts.nest, heat.grid_mm)
        self._regions = Regions(facts.nest, self._grid)
        self._terms = HeatTerms.of(facts, problem, heat)
        self._tried: dict[Route, SimulatedRoute] = {}
        self._started = False

    def price_mm(self, profile: Profile) -> float:
        """What the profile has an overheat cost, mm of idle travel."""
        return profile.objective.heat

    def start(self, going: MayGoOn = _always) -> None:
        """Simulate random orders, if that was not done before.

        Raises RulesConflict if no lawful order came of many attempts at random.
        """
        if not self._started:
            self._simulate((random_order(self._problem, seed) for seed in range(ORDERS)), 1.0, going)
        self._started = True

    def prices(self) -> HeatPrices:
        """By all that was simulated so far."""
        tried = list(self._tried.values())
        weights = np.array([one.weight for one in tried])
        return fit_prices(self._terms, [one.route for one in tried], np.array([one.hot for one in tried]), weights)

    def statements(self, prices: HeatPrices, price_mm: float) -> tuple[Statement, ...]:
        """Prices as soft statements, where an overheat costs `price_mm`."""
        return priced_statements(self._facts, self._problem, prices, price_mm)

    def find(
        self,
        price_mm: float,
        planner: Planner,
        judge: Judge | None = None,
        going: MayGoOn = _always,
        seed: int = 1,
    ) -> BestSimulated:
        """The best route found where an overheat costs as much as `price_mm` of idle travel.

        Raises RulesConflict if round 0 has no plan.
        """
        problem, chance = self._problem, random.Random(seed)
        plan = self._sites(planner(0, ()))
        self._simulate([plan], NEARBY_WEIGHT, going)
        with suppress(RulesConflict):  # where no order at random keeps the rules, those near the plan must do
            self.start(going)
        judged: dict[Route, float | None] = {}
        for k in range(1, ROUNDS + 1):
            if not going():
                break
            prices = self.prices()
            try:
                plan = self._sites(planner(k, self.statements(prices, price_mm)))
            except RulesConflict:  # the limits left no time for another plan
                break
            self._simulate([plan], NEARBY_WEIGHT, going)
            best = self._best(price_mm, judge, judged)[0].route
            routes = (nearby(problem, best, prices, price_mm, chance) for _ in range(NEARBY))
            self._simulate((route for route in routes if route is not None), NEARBY_WEIGHT, going)
        tried, cost_mm = self._best(price_mm, judge, judged)
        further = self.statements(self.prices(), price_mm)
        return BestSimulated(self._candidates(tried.route), cost_mm, tried.overheats, further)

    def _best(
        self, price_mm: float, judge: Judge | None, judged: dict[Route, float | None]
    ) -> tuple[SimulatedRoute, float]:
        """The lawful route that costs least, and its cost by the rules; what judges whole orders only adds to it."""
        best: tuple[float, SimulatedRoute, float] | None = None
        for tried in sorted(self._tried.values(), key=lambda one: one.total_mm(price_mm)):
            if best is not None and tried.total_mm(price_mm) >= best[0]:
                break
            if tried.route not in judged:
                judged[tried.route] = tried.cost_mm if judge is None else judge(self._candidates(tried.route))
            cost_mm = judged[tried.route]
            if cost_mm is not None:
                total_mm = cost_mm + price_mm * tried.overheats
                if best is None or total_mm < best[0]:
                    best = total_mm, tried, cost_mm
        assert best is not None  # the plan of round 0 is lawful
        return best[1], best[2]

    def _sites(self, route: Sequence[int]) -> Route:
        return tuple(self._problem.candidate_site[list(route)].tolist())

    def _candidates(self, route: Route) -> Route:
        return tuple(self._problem.site_candidate[list(route)].tolist())

    def _simulate(self, routes: Iterable[Route], weight: float, going: MayGoOn) -> None:
        """Simulate what is new of these routes, in small lots: after each it may be enough."""
        rest = iter(routes)
        with ThreadPoolExecutor() as pool:
            while lot := list(dict.fromkeys(islice(rest, LOT))):
                new = [route for route in lot if route not in self._tried]
                timed = [self._paths.of(self._candidates(route)) for route in new]
                for route, hot in zip(new, pool.map(self._count, timed), strict=True):
                    self._tried[route] = SimulatedRoute(
                        route, route_cost(self._problem, route) / UM_PER_MM, hot, weight
                    )
                if not going():
                    break

    def _count(self, path: TimedPath) -> Ints:
        """The overheats near each contour (n,) of a path."""
        found = simulate(self._facts.nest, path, self._heat, self._thickness_mm, grid=self._grid)
        return self._regions.count(found)


# Lawful routes that are not far from a given one: some contours elsewhere in the order, some entered elsewhere.


def nearby(
    problem: Problem, route: Sequence[int], prices: HeatPrices, price_mm: float, chance: random.Random
) -> tuple[int, ...] | None:
    """A lawful route (sites) near to a route, its entries the cheapest for its order but for a few drawn at random.

    None if no attempt led to the end.
    """
    for _ in range(ATTEMPTS):
        found = _walk(problem, _moved(problem, route, prices, chance), prices, price_mm, chance)
        if found is not None and not broken(problem, found):
            return found
    return None


def _moved(problem: Problem, route: Sequence[int], prices: HeatPrices, chance: random.Random) -> Floats:
    """Where each contour would like to be, (n,): a near pair the other way round, or a stretch backwards."""
    order = [int(problem.site_contour[s]) for s in route]
    pairs = prices.terms.pairs.tolist()
    for _ in range(chance.randint(0, MOST_MOVES)):
        if pairs and chance.random() < 0.5:
            i, j = sorted(chance.choice(pairs), key=order.index)
            block = [c for c in order if problem.block[c] == problem.block[j]]
            rest = [c for c in order if c not in block or c == i]
            at = rest.index(i)
            order = [*rest[:at], *(c for c in block if c != i), *rest[at:]]
        else:
            a, b = sorted((chance.randrange(len(order)), chance.randrange(len(order))))
            order[a : b + 1] = order[a : b + 1][::-1]
    place = np.empty(problem.n)
    place[order] = np.arange(problem.n)
    return place


def _walk(
    problem: Problem, place: Floats, prices: HeatPrices, price_mm: float, chance: random.Random
) -> tuple[int, ...] | None:
    """The lawful order that follows these places as well as it can, with its cheapest entries."""
    walk, out = Walk(problem), np.zeros(problem.n, dtype=np.bool_)
    layers: list[list[int]] = []
    cost = problem.site_cost.astype(np.float64)
    sites, more = prices.of_entries()
    while not walk.finished:
        options = walk.options()
        if not options:
            return None
        contour = min((int(problem.site_contour[s]) for s in options), key=lambda c: (place[c], c))
        layers.append([s for s in options if problem.site_contour[s] == contour])
        cost[layers[-1]] += price_mm * UM_PER_MM * (sites[layers[-1]] + more[layers[-1]] @ out)
        walk.take(layers[-1][0])
        out[contour] = True
    for k in chance.sample(range(len(layers)), min(len(layers), chance.randint(0, MOST_PULLED))):
        layers[k] = [chance.choice(layers[k])]
    return _cheapest(problem, layers, cost)


def _cheapest(problem: Problem, layers: Sequence[list[int]], cost: Floats) -> tuple[int, ...]:
    """One site of each layer, so that travel and sites cost least: a shortest path."""
    total, ways = np.zeros(1), []
    leave = [problem.m]
    for layer in layers:
        through = total[:, None] + problem.travel(leave, layer)
        ways.append(through.argmin(axis=0))
        total, leave = through.min(axis=0) + cost[layer], layer
    at = int((total + problem.travel(leave, [problem.m])[:, 0]).argmin()) if layers else 0
    route = []
    for layer, way in zip(reversed(layers), reversed(ways), strict=True):
        route.append(layer[at])
        at = int(way[at])
    return tuple(reversed(route))
