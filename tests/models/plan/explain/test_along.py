"""What is known along the order of a plan, where that order has no lawful way."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from kerfwise.models.plan.explain.alternatives import PositionCosts
from kerfwise.models.problem.conditions import Condition
from kerfwise.tests.models.problems import ABOUT, problem


def test_an_order_without_a_lawful_way_has_no_cost_though_nothing_is_moved() -> None:
    """The first contour is not to be cut before the second: no entry helps the plan's own order."""
    asked = Condition(0, (1,), (1,), 1, ABOUT)
    two = problem([[(10.0, 0.0), (20.0, 0.0)], [(30.0, 0.0)]], conditions=[asked])
    setting: Any = SimpleNamespace(
        problem=two, order=(0, 1), conditions={0: (asked,)}, stated=SimpleNamespace(statements=())
    )
    along = PositionCosts(setting)
    assert along.moved((0, 1)) is None
    assert along.pinned(0, 0) is None
    assert along.moved((1, 0)) == 60_000
