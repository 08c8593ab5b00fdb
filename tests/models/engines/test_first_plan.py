"""A plan laid out from its end keeps all deadlines that can be kept, and is lawful whenever there is one."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import pytest

from kerfwise.models.engines.first_plan import plan_from_its_end, wants_early
from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.models.problem.problem import Problem
from kerfwise.tests.models.problems import ABOUT, problem


def with_deadlines(seed: int, n: int) -> Problem:
    """Contours in a row with orders, and sums of lengths that must not be out before some of them."""
    random = np.random.default_rng(seed)
    lengths = random.integers(1, 20, n).tolist()
    pairs = {tuple(sorted(random.choice(n, 2, replace=False).tolist())) for _ in range(n // 2)}
    asked = []
    for contour in random.choice(n, n // 2, replace=False).tolist():
        others = [k for k in range(n) if k != contour]
        most = int(random.integers(0, sum(lengths)))
        asked.append(Condition(contour, tuple(others), tuple(-lengths[k] for k in others), -most, ABOUT))
    points = [[(float(x), float(y))] for x, y in random.integers(0, 100, (n, 2))]
    return problem(points, pairs=sorted((int(a), int(b)) for a, b in pairs), conditions=asked)


@pytest.mark.parametrize("seed", range(30))
def test_there_is_a_plan_from_the_end_where_there_is_one_at_all(seed: int) -> None:
    drawn = with_deadlines(seed, 6)
    found = plan_from_its_end(drawn)
    lawful = any(not broken(drawn, order) for order in permutations(range(6)))
    assert (found is not None) == lawful
    if found is not None:
        assert not broken(drawn, found.route)
        assert found.cost == route_cost(drawn, found.route)


def test_it_is_tried_where_long_sums_want_contours_early() -> None:
    assert wants_early(with_deadlines(1, 30))
    assert not wants_early(with_deadlines(1, 8))
