"""What a route breaks is told the same, however many contours there are."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, given
from hypothesis import strategies as st

from kerfwise.models.problem import evaluate
from kerfwise.models.problem.evaluate import broken_orders
from kerfwise.models.problem.problem import Problem
from kerfwise.tests.models.problems import problem, problems
from kerfwise.tests.tools.amount import examples


@given(problems(), st.randoms(use_true_random=False))
@examples(60, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_orders_hold_where_those_with_none_between_do(drawn: Problem, chance: object) -> None:
    order = list(range(drawn.n))
    chance.shuffle(order)  # type: ignore[attr-defined]
    plainly = broken_orders(drawn, order)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(evaluate, "ROWS_AT_ONCE", 1)  # every problem is a large one
        assert broken_orders(drawn, order) == plainly


def test_of_a_large_problem_each_broken_order_is_named() -> None:
    n = 2 * evaluate.ROWS_AT_ONCE + 3
    row = problem([[(float(k), 0.0)] for k in range(n)], pairs=[(k, k + 2) for k in range(n - 2)])
    straight = list(range(n))
    assert broken_orders(row, straight) == []
    wrong = np.array(straight)
    wrong[[700, 704]] = [704, 700]
    assert [about.contours for about in broken_orders(row, wrong.tolist())] == [
        (row.ids[700], row.ids[702]),
        (row.ids[700], row.ids[704]),
        (row.ids[702], row.ids[704]),
    ]
