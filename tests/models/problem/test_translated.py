"""What statements come to: a round takes over what the one before found, and what is new is worked out."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest

from kerfwise.models.problem.conditions import LoweredStatements, lower_statements
from kerfwise.rules.statements import AtLeast, Before, NoGood, Pick, Precede, Statement
from kerfwise.tests.models.problems import ABOUT

CONTOUR_OF = (0, 0, 1, 2)
FIRST: tuple[Statement, ...] = (
    Precede(0, 1, ABOUT),
    Precede(1, 2, ABOUT, 3.0),
    AtLeast((Before(1, 0), Before(2, 0)), (1, 1), 1, ABOUT, when=0),
    AtLeast((Pick(0), Pick(2)), (1, 1), 1, ABOUT),
)
MORE: tuple[Statement, ...] = (
    NoGood(frozenset({0, 1}), frozenset({2}), ABOUT),
    Precede(0, 2, ABOUT),
    AtLeast((Pick(3),), (1,), 1, ABOUT, weight=2.0),
)


def assert_alike(one: LoweredStatements, other: LoweredStatements) -> None:
    for name in (field.name for field in fields(LoweredStatements)):
        a, b = getattr(one, name), getattr(other, name)
        assert np.array_equal(a, b) if name == "pairs" else a == b, name


def test_statements_come_to_pairs_conditions_and_the_rest() -> None:
    told = lower_statements(FIRST, CONTOUR_OF, LoweredStatements())
    assert told.pairs.tolist() == [[0, 1]]
    assert [(c.contour, c.members, c.bound, c.when) for c in told.conditions] == [(1, (2,), 0, None), (0, (1, 2), 1, 0)]
    assert told.general == FIRST[3:]


def test_a_further_round_comes_to_the_same_as_one_from_scratch() -> None:
    first = lower_statements(FIRST, CONTOUR_OF, LoweredStatements())
    further = lower_statements((*FIRST, *MORE), CONTOUR_OF, first)
    assert_alike(further, lower_statements((*FIRST, *MORE), CONTOUR_OF, LoweredStatements()))
    assert further.conditions[0] is first.conditions[0]
    assert len(further.conditions) == 4


@pytest.mark.parametrize("other", [MORE, FIRST[:2], (MORE[1], *FIRST[1:], *MORE), (*FIRST[::-1], *MORE)], ids=str)
def test_of_other_statements_nothing_is_taken_over(other: tuple[Statement, ...]) -> None:
    first = lower_statements(FIRST, CONTOUR_OF, LoweredStatements())
    assert_alike(lower_statements(other, CONTOUR_OF, first), lower_statements(other, CONTOUR_OF, LoweredStatements()))
