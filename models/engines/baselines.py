"""Plain ways to choose an order, for comparison: at random, and by the temperature of the sheet at that moment."""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Sequence

import numpy as np
import shapely

from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.geometry.tolerances import UM_PER_MM
from kerfwise.models.engines.tuning import ATTEMPTS, WARM_SHARE
from kerfwise.models.physics.heat.physical import SheetSimulation
from kerfwise.models.physics.heat.timed_path import Grid, TimedPath, TorchOn, events_of, make_grid
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.profile.plant_sections import Heat
from kerfwise.rules.profile.values import ProfileValues
from kerfwise.rules.statements import EXEMPTION_MM, Statement, by_kind

from . import Strategy
from .deadline import Progress
from .lawful_walk import Walk
from .solution import Solution, SolveOptions
from .solve import solve

# Random lawful orders: the strategy "random transitions" of Verkhoturov et al.


def random_order(problem: Problem, seed: int) -> tuple[int, ...]:
    """A lawful route (sites): every step a contour drawn evenly from those that may come next, then one of its sites.

    Raises RulesConflict if no attempt led to the end.
    """
    chance = random.Random(seed)
    for _ in range(ATTEMPTS):
        walk = Walk(problem)
        while not walk.finished:
            options = walk.options()
            if not options:
                break
            contour = chance.choice(sorted({int(problem.site_contour[s]) for s in options}))
            sites = [s for s in options if problem.site_contour[s] == contour]
            walk.take(chance.choice(sites))
        if walk.finished and not broken(problem, walk.route):
            return tuple(walk.route)
    raise RulesConflict(f"no lawful order came of {ATTEMPTS} attempts at random")


# The strategy Realtime of Verkhoturov et al.: each next contour by the temperature of the sheet at that moment.

Burn = Callable[[int, float, Point], tuple[tuple[TorchOn, ...], float]]
"""Of a candidate cut next, the time, s, and where the torch is: what it burns, and when it is done."""
Indices = tuple[np.ndarray[tuple[int], np.dtype[np.int64]], np.ndarray[tuple[int], np.dtype[np.int64]]]


def realtime_order(problem: Problem, facts: Facts, heat: Heat, thickness_mm: float, burn: Burn) -> tuple[int, ...]:
    """A lawful route (sites): each time the nearest contour whose metal is cool enough, else the coolest one.

    `burn` tells what a candidate burns that is cut next.
    Raises RulesConflict if nothing lawful was left at some step.
    """
    grid = make_grid(facts.nest, heat.grid_mm)
    sheet = SheetSimulation(grid, heat, thickness_mm)
    along = [_along(grid, contour.line) for contour in facts.nest.contours]
    cool_k = WARM_SHARE * (heat.limit_c - heat.ambient_c)
    walk, now_s, at = Walk(problem), 0.0, (float(problem.home_um[0]) / 1000, float(problem.home_um[1]) / 1000)
    while not walk.finished:
        options = walk.options()
        if not options:
            raise RulesConflict("the strategy realtime came to a step where no contour may lawfully be cut")
        field, of = sheet.temperature_c(), problem.site_contour
        warm_k = {c: _warmth_k(field, along[c], heat.ambient_c) for c in sorted({int(of[s]) for s in options})}
        least_k = max(cool_k, min(warm_k.values()))
        site = _nearest(problem, facts, [s for s in options if warm_k[int(of[s])] <= least_k], at)
        walk.take(site)
        number = int(problem.site_candidate[site])
        burns, now_s = burn(number, now_s, at)
        at = facts.candidates[number].end
        if burns:
            sheet.run(events_of(TimedPath(burns, now_s), grid), now_s)
    if wrong := broken(problem, walk.route):
        raise RulesConflict(f"the strategy realtime found no lawful order: {wrong[0].sentence}")
    return tuple(walk.route)


def _nearest(problem: Problem, facts: Facts, sites: list[int], at: Point) -> int:
    pierces = [facts.candidates[int(problem.site_candidate[s])].pierce for s in sites]
    return min(zip((math.dist(at, pierce) for pierce in pierces), sites, strict=True))[1]


def _along(grid: Grid, line: shapely.LineString) -> Indices:
    """Points of the grid under a contour."""
    steps = np.arange(0.0, line.length, grid.step_mm)
    xy = shapely.get_coordinates(shapely.line_interpolate_point(line, steps))
    i = np.clip(np.rint((xy[:, 0] - grid.x0_mm) / grid.step_mm).astype(np.int64), 0, grid.shape[0] - 1)
    j = np.clip(np.rint((xy[:, 1] - grid.y0_mm) / grid.step_mm).astype(np.int64), 0, grid.shape[1] - 1)
    return i, j


def _warmth_k(field: np.ndarray[tuple[int, int], np.dtype[np.float32]], along: Indices, ambient_c: float) -> float:
    """How far the hottest tenth of the metal along a contour is above the air, K."""
    return float(np.quantile(field[along], 0.9)) - ambient_c


# Plain strategies to compare the solver with: shortest path, random, Realtime (Verkhoturov et al.).


def solve_by(
    strategy: Strategy,
    facts: Facts,
    profile: ProfileValues,
    statements: tuple[Statement, ...],
    limits: SolveOptions,
    burn: Burn,
    progress: Progress | None = None,
) -> Solution:
    """A route by a plain strategy that keeps every hard statement; soft ones are not looked at.

    Raises RulesConflict if it finds none.
    """
    prices = by_kind(statements).idle_travel
    bare = tuple(s for s in statements if s in prices or _binds(s))
    if strategy == "shortest":
        return solve(facts, bare, limits, progress)
    problem = make_problem(facts, bare, limits.home_mm, limits.feeds)
    if strategy == "random":
        route: Sequence[int] = random_order(problem, limits.seed)
    else:
        route = realtime_order(problem, facts, profile.heat, profile.material.thickness_mm, burn)
    return Solution(
        route=tuple(problem.site_candidate[list(route)].tolist()),
        objective=route_cost(problem, route) / UM_PER_MM,
        bound=None,
        status="feasible",
        found_by=strategy,
        proved_by="",
        seconds=0.0,
    )


def _binds(statement: Statement) -> bool:
    """Whether it is hard, or hard but for excuses."""
    return statement.weight is None or statement.weight >= EXEMPTION_MM
