"""How many excuses every plan needs: held against every order of small problems."""

from __future__ import annotations

import numpy as np
import pytest

from kerfwise.models.engines.bounds import excused_um, fewest_excuses, without_excuses
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.portfolio import count_excuses, excuses_suit
from kerfwise.models.engines.shared_state import Run
from kerfwise.models.engines.solution import Incumbent, SolveOptions
from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.models.problem.problem import Problem
from kerfwise.tests.models.brute import lawful
from kerfwise.tests.models.problems import ABOUT, problem

EXCUSE_UM = 10**9


def made(seed: int) -> Problem:
    """A few contours with orders, perhaps a block, and conditions that are hard, soft, or may be excused."""
    random = np.random.default_rng(seed)
    places = [[tuple(random.uniform(0, 99, 2)) for _ in range(random.integers(1, 3))] for _ in range(5)]
    pairs = [tuple(np.sort(random.choice(5, 2, replace=False)).tolist()) for _ in range(random.integers(3))]
    sites = [(k, s) for k, s in enumerate(np.repeat(np.arange(5), [len(p) for p in places]).tolist())]
    conditions = []
    for _ in range(random.integers(3, 9)):
        site, contour = sites[random.integers(len(sites))]
        members = tuple(sorted(random.choice([k for k in range(5) if k != contour], 2, replace=False).tolist()))
        weights = tuple(random.choice([-2, -1, 1, 2], 2).tolist())
        bound = int(random.integers(sum(min(w, 0) for w in weights) + 1, sum(max(w, 0) for w in weights) + 1))
        cost = [EXCUSE_UM, EXCUSE_UM, 2 * EXCUSE_UM, None, 5000][random.integers(5)]
        when = site if random.integers(2) else None
        conditions.append(Condition(contour, members, weights, bound, ABOUT, when, cost))
    return problem(places, pairs=pairs, conditions=conditions, blocks=[[2, 3]] * int(random.integers(2)))


@pytest.mark.parametrize("seed", range(20))
def test_the_fewest_are_told_and_found(seed: int) -> None:
    """Sets and ways to cut decide all excuses here, so that the bound is met, from whichever plan it sets out."""
    given = made(seed)
    routes = list(lawful(given))
    if not routes:
        return
    fewest = min(route_cost(given, route) // EXCUSE_UM for route in routes)
    worst = max(routes, key=lambda route: route_cost(given, route))
    plan = Incumbent(worst, route_cost(given, worst))
    excused = plan.cost // EXCUSE_UM
    assert excused_um(given, worst) == excused * EXCUSE_UM
    assert route_cost(without_excuses(given), worst) == plan.cost - excused * EXCUSE_UM
    known = fewest_excuses(given, plan, Deadline(9.0))
    assert known.least_um == fewest * EXCUSE_UM
    if excused > fewest:
        assert known.route is not None
        assert not broken(given, known.route)
        assert route_cost(given, known.route) // EXCUSE_UM == fewest


def test_a_plan_with_an_excuse_too_many_gives_way_to_one_without() -> None:
    """The near contour comes last, or its neighbour's cut needs an excuse: a search would have to make both moves."""
    held = Condition(0, (1,), (1,), 1, ABOUT, cost=EXCUSE_UM)
    run = Run(problem([[(10.0, 0.0)], [(20.0, 0.0)]], conditions=[held]), SolveOptions(work=5.0))
    run.offer(Incumbent((0, 1), route_cost(run.problem, (0, 1))), "search")
    assert excuses_suit(run)
    count_excuses(run, 1.0)
    assert run.known.incumbent is not None
    assert run.known.incumbent.route == (1, 0)
    assert not excuses_suit(run)
    assert (run.excuses_um, run.known.bound_um) == (0, 0)


def test_an_excuse_that_every_plan_needs_is_a_bound() -> None:
    never = [Condition(0, (1,), (1,), 1, ABOUT, cost=EXCUSE_UM), Condition(1, (0,), (1,), 1, ABOUT, cost=EXCUSE_UM)]
    run = Run(problem([[(10.0, 0.0)], [(20.0, 0.0)]], conditions=never), SolveOptions(work=5.0))
    run.offer(Incumbent((0, 1), route_cost(run.problem, (0, 1))), "search")
    count_excuses(run, 1.0)
    assert run.excuses_um == run.known.bound_um == EXCUSE_UM
    assert not excuses_suit(run)
