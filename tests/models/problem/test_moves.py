"""A problem that goes on from an earlier one is the one that would be made from scratch."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given

from kerfwise import RulesConflict
from kerfwise.jobs.request import Request, facts_of, make_request
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.crossings import Crossings
from kerfwise.models.problem.moves import MovePrices, PairTable
from kerfwise.models.problem.precedence import lawful_followers
from kerfwise.models.problem.problem import Durations, Links, Problem
from kerfwise.rule_kit import (
    AtLeast,
    Before,
    Crossing,
    Forbid,
    Lag,
    NoGood,
    Precede,
    Statement,
    circle,
    nest,
    part,
    rect,
)
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.statements import IdleTravel
from kerfwise.tests.models.brute import cheapest, lawful
from kerfwise.tests.models.problems import ABOUT, problem, problems, scattered
from kerfwise.tests.tools.amount import examples

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


def test_the_short_way_round_is_the_cheapest() -> None:
    line = problem([[(30, 0)], [(10, 0), (10, 5)], [(20, 0)]])
    best = cheapest(line)
    assert best is not None
    assert best.cost == 60_000


def test_every_order_of_free_contours_is_lawful() -> None:
    assert len(list(lawful(problem([[(1, 0)], [(2, 0), (3, 0)], [(4, 0)]])))) == 12


def test_an_order_halves_them() -> None:
    assert len(list(lawful(problem([[(1, 0)], [(2, 0)], [(4, 0)]], pairs=[(2, 0)])))) == 3


def test_nothing_is_lawful_when_two_contours_cannot_be_far_enough_apart() -> None:
    assert cheapest(problem([[(1, 0)], [(2, 0)]], lags=[Lag(0, 1, ABOUT, cuts=1)])) is None


def test_scattered_problems_are_the_same_each_time() -> None:
    first, second = scattered(3, 6, 2, pairs=4), scattered(3, 6, 2, pairs=4)
    assert (first.pierce_um == second.pierce_um).all()
    assert (first.before == second.before).all()


@given(problems())
@examples(20)
def test_who_may_follow_whom_is_the_same_however_often_it_is_asked(drawn: Problem) -> None:
    plainly = lawful_followers(drawn.before, drawn.block, drawn.apart(), drawn.moves.barred).whole()
    other = replace(drawn, lags=(), moves=MovePrices())
    for asked in (drawn, drawn, other, drawn):
        wanted = lawful_followers(other.before, other.block).whole() if asked is other else plainly
        assert (asked.successors() == wanted).all()


def test_what_is_changed_in_an_answer_stays_out_of_the_next() -> None:
    line = problem([[(1, 0)], [(2, 0)], [(4, 0)]], pairs=[(2, 0)])
    line.successors()[:] = False
    assert line.successors().any()


@given(problems())
@examples(20)
def test_a_drawn_problem_is_well_formed(drawn: Problem) -> None:
    assert drawn.first[-1] == drawn.m == len(drawn.end_um)
    assert not (drawn.before & drawn.before.T).any()
