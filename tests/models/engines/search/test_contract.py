"""A region is the problem itself with some arcs kept: each of its routes costs as much more or less, to the µm."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kerfwise.models.engines.search.region_problem import Region
from kerfwise.models.engines.search.searcher import Contractor, separable
from kerfwise.models.engines.search.state.route_state import make_tables
from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.crossings import FORBIDDEN, Crossings
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.statements import Lag
from kerfwise.tests.models.problems import ABOUT, linked, scattered, with_lags

CONTOURS, SITES = 14, 3
BLOCKS = [range(3), range(6, 8)]


def plate(random: np.random.Generator, hard: float) -> Problem:
    """Orders, blocks, conditions, lags, links and crossings, so many of which that each route meets some.

    `hard` is the share of what no order may break.
    """
    bare = scattered(int(random.integers(1 << 30)), CONTOURS, SITES, pairs=6, blocks=BLOCKS)

    def price() -> int | None:
        return None if random.random() < hard else int(random.integers(1, 90_000))

    conditions = []
    for _ in range(60):
        contour = int(random.integers(CONTOURS))
        members = random.choice(CONTOURS, int(random.integers(1, 4)), replace=False).tolist()
        weights = random.choice([-2, -1, 1, 2], len(members)).tolist()
        when = int(bare.first[contour] + random.integers(SITES)) if random.random() < 0.6 else None
        asked = tuple(members), tuple(weights), int(random.integers(-2, 2))
        conditions.append(Condition(contour, *asked, ABOUT, when, price()))
    pairs = {tuple(sorted(random.choice(CONTOURS, 2, replace=False).tolist())) for _ in range(20)}
    lags = [Lag(i, j, ABOUT, cuts=1, weight=None if random.random() < hard else 30.5) for i, j in sorted(pairs)]
    moves = random.integers(0, bare.m + 1, (900, 2))
    over = random.integers(0, CONTOURS, 900)
    rows = np.unique(np.column_stack([moves, over]), axis=0)
    cost = np.where(random.random(len(rows)) < hard, FORBIDDEN, random.integers(1, 60_000, len(rows)))
    leave, reach, crossed = rows.T.copy()
    crossings = Crossings(leave, reach, crossed, cost, np.zeros(len(rows), dtype=np.int64))
    links = [(*random.choice(bare.m, 2, replace=False).tolist(), 5, 0) for _ in range(60)]
    links = [row for row in links if bare.site_contour[row[0]] != bare.site_contour[row[1]]]
    return replace(
        with_lags(bare, lags),
        conditions=tuple(conditions),
        crossings=crossings,
        site_cost=random.integers(0, 50_000, bare.m),
        links=linked(bare.m, links),
    )


def some_route(problem: Problem, random: np.random.Generator) -> list[int]:
    """A route that keeps orders and blocks, by chance."""
    left, order = set(range(problem.n)), list[int]()
    while left:
        now = [c for c in left if not any(problem.before[other, c] for other in left)]
        open_ = {int(problem.block[c]) for c in order} & {int(problem.block[c]) for c in left}
        inside = [c for c in now if int(problem.block[c]) in open_]
        order.append(int(random.choice(inside or now)))
        left.remove(order[-1])
    return [int(random.choice(problem.sites(c))) for c in order]


def a_region(whole: Problem, route: list[int], random: np.random.Generator, **kept: bool) -> Region:
    """A region of some contours, whole blocks."""
    chosen = random.choice(CONTOURS, int(random.integers(1, 9)), replace=False)
    free = np.isin(whole.block, whole.block[chosen])
    return Contractor(whole, make_tables(whole)).region(np.array(route), free, **kept)


@pytest.mark.parametrize("seed", range(12))
def test_what_a_route_through_a_region_costs(seed: int) -> None:
    random = np.random.default_rng(seed)
    whole = plate(random, hard=0.0)
    assert separable(whole)
    route = some_route(whole, random)
    region = a_region(whole, route, random)
    assert region.whole(region.route).tolist() == route
    more = route_cost(whole, route) - route_cost(region.problem, region.route.tolist())
    for _ in range(40):
        way = some_route(region.problem, random)
        through = region.whole(np.array(way)).tolist()
        assert broken(region.problem, way) == broken(whole, through) == ()
        assert route_cost(whole, through) == route_cost(region.problem, way) + more


@pytest.mark.parametrize("seed", range(12))
def test_a_route_through_a_region_is_lawful_where_the_whole_one_is(seed: int) -> None:
    random = np.random.default_rng(100 + seed)
    whole = plate(random, hard=0.02)
    route = some_route(whole, random)
    region = a_region(whole, route, random)
    settled = len(broken(whole, route)) - len(broken(region.problem, region.route.tolist()))
    assert settled >= 0, "what the region leaves out is broken by the route itself"
    for _ in range(40):
        way = some_route(region.problem, random)
        through = region.whole(np.array(way)).tolist()
        if not settled:
            assert bool(broken(region.problem, way)) == bool(broken(whole, through))


def test_the_first_and_the_last_piece_stay_where_they_are() -> None:
    random = np.random.default_rng(7)
    whole = plate(random, hard=0.0)
    route = some_route(whole, random)
    order = whole.site_contour[route]
    free = np.isin(whole.block, whole.block[order[[6, 8]]])
    region = Contractor(whole, make_tables(whole)).region(np.array(route), free, starts=True, ends=True)
    for _ in range(20):
        through = region.whole(np.array(some_route(region.problem, random))).tolist()
        assert (through[0], through[-1]) == (route[0], route[-1])
