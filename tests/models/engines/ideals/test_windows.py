"""Windows of a route in their best order: against brute force, and on routes with a known fault."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given

from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.ideals.heuristic_sweeps import polish
from kerfwise.models.engines.ideals.stretch_bounds import NOWHERE, LeastIn
from kerfwise.models.engines.search import Searcher
from kerfwise.models.engines.solution import Incumbent
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.models.problem.problem import Problem
from kerfwise.tests.models.brute import cheapest
from kerfwise.tests.models.problems import problem, problems, scattered
from kerfwise.tests.tools.amount import examples


@pytest.mark.slow
@examples(80)
@given(problems())
def test_a_window_over_the_whole_route_makes_it_the_best(drawn: Problem) -> None:
    tiny = replace(drawn, general=(), lags=())
    best, first = cheapest(tiny), Searcher(tiny)
    assume(best is not None)
    first.run(Deadline(0.0001))
    assert best is not None
    assume(first.best is not None)
    assert first.best is not None
    assert polish(tiny, first.best, Deadline(10)).incumbent.cost == best.cost


def ring(n: int) -> Problem:
    """Contours on a circle round the machine's home, numbered the way round."""
    turns = [2 * math.pi * k / n for k in range(n)]
    return problem([[(1000 * math.cos(turn), 1000 * math.sin(turn))] for turn in turns])


@pytest.mark.parametrize("at", [0, 7, 19, 38])
def test_two_contours_in_each_others_place_are_put_right(at: int) -> None:
    circle = ring(40)
    route = list(range(40))
    route[at], route[at + 1] = route[at + 1], route[at]
    found = polish(circle, Incumbent(tuple(route), route_cost(circle, route)), Deadline(10)).incumbent
    assert found.route == tuple(range(40))


def test_routes_stay_lawful_and_never_become_dearer() -> None:
    for seed in range(4):
        drawn = scattered(seed, contours=40, sites=3, pairs=30, blocks=[(3, 6), (20, 22)])
        search = Searcher(drawn, seed)
        search.run(Deadline(0.001))
        assert search.best is not None
        found = polish(drawn, search.best, Deadline(1)).incumbent
        assert found.cost <= search.best.cost
        assert found.cost == route_cost(drawn, found.route)
        assert broken(drawn, found.route) == ()


def test_no_work_no_change() -> None:
    line = problem([[(10.0, 0.0)], [(20.0, 30.0)], [(10.0, 1.0)]])
    crooked = Incumbent((0, 1, 2), route_cost(line, (0, 1, 2)))
    assert polish(line, crooked, Deadline(0.0)).incumbent == crooked


def test_little_work_looks_at_few_of_many_contours(monkeypatch: pytest.MonkeyPatch) -> None:
    """What leads to a contour is looked up for those of windows that are asked for, not for the whole problem."""
    looked: list[int] = []
    least = LeastIn._least
    monkeypatch.setattr(LeastIn, "_least", lambda known, contour: looked.append(contour) or least(known, contour))
    many = ring(400)
    route = tuple(range(400))
    polish(many, Incumbent(route, route_cost(many, route)), Deadline(1e-6))
    assert 0 < len(looked) <= 24
    assert len(set(looked)) == len(looked)


@examples(30)
@given(problems())
def test_no_move_to_a_contour_costs_less_than_the_least(drawn: Problem) -> None:
    least, follows = LeastIn(drawn), drawn.successors()
    assert len(least) == drawn.n
    sites = [list(drawn.sites(c)) for c in range(drawn.n)] + [[drawn.m]]
    for contour in range(drawn.n):
        ways = [
            int(drawn.travel([one], [other])[0, 0]) + (int(drawn.site_cost[other]) if len(drawn.links) else 0)
            for before in np.flatnonzero(follows[:, contour]).tolist()
            for one in sites[before]
            for other in sites[contour]
        ]
        assert least[contour] == min(ways, default=NOWHERE)
