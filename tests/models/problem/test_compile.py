"""A problem that goes on from an earlier one is the one that would be made from scratch."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np
import pytest
import shapely

from kerfwise.encoder.errors import RulesConflict
from kerfwise.jobs.request import Request, facts_of, make_request
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.crossings import Crossings
from kerfwise.models.problem.moves import MovePrices, PairTable
from kerfwise.models.problem.problem import Durations, Links, Problem
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.statements import AtLeast, Before, Crossing, Forbid, IdleTravel, NoGood, Precede, Statement
from kerfwise.tests.models.problems import ABOUT

PLATE = nest(
    400,
    120,
    part("A", rect(10, 10, 80, 80), [circle(50, 50, 9)]),
    part("B", rect(110, 10, 80, 80)),
    part("C", rect(210, 10, 80, 80)),
)
NO_GOOD = NoGood(frozenset({0, 1}), frozenset({2}), ABOUT, 30.0)
AREA = shapely.box(100, 0, 105, 5)
MORE: dict[str, tuple[Statement, ...]] = {
    "nothing": (),
    "a set": (NO_GOOD,),
    "the same twice": (NO_GOOD, NO_GOOD, NoGood(frozenset({2}), frozenset({3}), ABOUT)),
    "a soft order": (Precede(3, 1, ABOUT, 2.0),),
    "a hard order": (Precede(1, 3, ABOUT),),
    "a price of a candidate": (Forbid(2, ABOUT, 7.0),),
    "a candidate less": (NO_GOOD, Forbid(0, ABOUT)),
    "a condition of a candidate": (AtLeast((Before(1, 0),), (1,), 1, ABOUT, 1, 4.0),),
    "dearer travel": (IdleTravel(ABOUT, 2.0), NO_GOOD),
}
FIRST = {"nothing": (), "what is out": (Crossing(None, AREA, ABOUT, 5.0), NO_GOOD)}
"""What an afterthought may add, and what was stated before beside the rules."""


@pytest.fixture(scope="module")
def asked() -> Request:
    profile = load_profile()
    return make_request(facts_of(PLATE, profile), profile)


def assert_alike(one: Problem, other: Problem) -> None:
    for name in (field.name for field in fields(Problem) if field.name != "told"):
        assert alike(getattr(one, name), getattr(other, name)), name


def alike(a: Any, b: Any) -> bool:
    """Tables are compared field by field."""
    if isinstance(a, Crossings | Links | Durations | MovePrices | PairTable):
        return all(alike(getattr(a, f.name), getattr(b, f.name)) for f in fields(a))
    return np.array_equal(a, b) if isinstance(a, np.ndarray) else bool(a == b)


@pytest.mark.parametrize("first", FIRST)
@pytest.mark.parametrize("more", MORE)
def test_going_on_comes_to_the_same_as_from_scratch(asked: Request, first: str, more: str) -> None:
    given = (*asked.stated.statements, *FIRST[first])
    earlier = make_problem(asked.facts, given, (0.0, 0.0))
    further = make_problem(asked.facts, (*given, *MORE[more]), (0.0, 0.0), earlier=earlier)
    assert_alike(further, make_problem(asked.facts, (*given, *MORE[more]), (0.0, 0.0)))
    again = make_problem(asked.facts, (*given, *MORE[more], NO_GOOD), (0.0, 0.0), earlier=further)
    assert_alike(again, make_problem(asked.facts, (*given, *MORE[more], NO_GOOD), (0.0, 0.0)))


def test_what_is_known_of_sites_is_taken_over(asked: Request) -> None:
    earlier = make_problem(asked.facts, asked.stated.statements, (0.0, 0.0))
    statements = (*asked.stated.statements, NO_GOOD)
    assert make_problem(asked.facts, statements, (0.0, 0.0), earlier=earlier).pierce_um is earlier.pierce_um
    statements = (*statements, Forbid(0, ABOUT, 1.0))
    assert make_problem(asked.facts, statements, (0.0, 0.0), earlier=earlier).pierce_um is not earlier.pierce_um


def test_a_contour_without_an_entry_is_named(asked: Request) -> None:
    closed = [Forbid(c, ABOUT) for c in asked.facts.candidates_of(2)]
    name = asked.facts.nest.contours[2].id
    with pytest.raises(RulesConflict, match=f"{name} has no lawful entry left"):
        make_problem(asked.facts, (*asked.stated.statements, *closed), (0.0, 0.0))


def test_orders_that_contradict_each_other_are_told_before_entries(asked: Request) -> None:
    closed = [Forbid(c, ABOUT) for c in asked.facts.candidates_of(2)]
    round_about = (Precede(0, 1, ABOUT), Precede(1, 0, ABOUT))
    with pytest.raises(RulesConflict, match="the order rules contradict each other"):
        make_problem(asked.facts, (*asked.stated.statements, *closed, *round_about), (0.0, 0.0))
