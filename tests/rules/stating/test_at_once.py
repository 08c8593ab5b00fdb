"""Statements in terms of the first torch: what is cut at one time has no order."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
import shapely

from kerfwise.encoder.facts import FactOptions, compute_facts
from kerfwise.encoder.facts.facts import Copies
from kerfwise.encoder.identical_parts import Group
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.statements import (
    About,
    AtLeast,
    Before,
    Contiguous,
    Crossing,
    Enough,
    Lag,
    NoGood,
    Precede,
    Statement,
    Steps,
)
from kerfwise.rules.stating.reduced_statements import GantryStatements

ABOUT = About("r", ("a", "b", "c", "d"), "")
A, B, C, D, E = range(5)
"""A and B are cut by torch 1; C with A, D with B, by torch 2; E by torch 1 alone, which calls it 2."""


@pytest.fixture
def at_once() -> GantryStatements:
    places = [(10, 10), (110, 10), (10, 110), (110, 110), (210, 10)]
    five = nest(400, 200, *(part(name, rect(x, y, 80, 80)) for name, (x, y) in zip("ABCDE", places, strict=True)))
    groups = (Group((A, C), (A, C)), Group((B, D), (B, D)))
    number, torch = np.array([0, 1, 0, 1, 2]), np.array([1, 1, 2, 2, 1])
    none = np.zeros(0, dtype=np.int64)
    return GantryStatements(Copies(compute_facts(five, FactOptions()), groups, number, none, torch, (0.0, 100.0)))


def told(at_once: GantryStatements, *statements: Statement, of_each_torch: bool = False) -> list[Statement]:
    return list(at_once.of_first(statements, of_each_torch))


def test_orders_are_those_of_what_is_cut_with_them(at_once: GantryStatements) -> None:
    assert told(at_once, Precede(C, B, ABOUT)) == [Precede(0, 1, ABOUT)]
    assert told(at_once, Precede(D, E, ABOUT)) == [Precede(1, 2, ABOUT)]
    assert not at_once.impossible


@pytest.mark.parametrize(
    "asked", [Precede(A, C, ABOUT), Lag(C, A, ABOUT, cuts=1), AtLeast((Before(A, C),), (1,), 1, ABOUT)]
)
def test_an_order_of_what_is_cut_at_once_cannot_be(at_once: GantryStatements, asked: Statement) -> None:
    assert told(at_once, asked) == []
    assert at_once.impossible == [(0, ABOUT)]


def test_a_wish_that_cannot_be_is_let_go(at_once: GantryStatements) -> None:
    assert told(at_once, Precede(A, C, ABOUT, weight=5.0)) == []
    assert not at_once.impossible


def test_a_rule_of_each_torch_asks_nothing_between_two(at_once: GantryStatements) -> None:
    asked = (Precede(A, D, ABOUT), Precede(C, D, ABOUT), Precede(A, E, ABOUT))
    assert told(at_once, *asked, of_each_torch=True) == [Precede(0, 1, ABOUT), Precede(0, 2, ABOUT)]


def held(sum_of: Enough | AtLeast, order: Sequence[int]) -> bool:
    def holds(literal: object) -> bool:
        if isinstance(literal, Enough):
            return held(literal, order)
        if isinstance(literal, Steps):
            return literal.least <= order.index(literal.j) - order.index(literal.i) <= literal.most
        assert isinstance(literal, Before)
        return order.index(literal.i) < order.index(literal.j)

    return sum(w for lit, w in zip(sum_of.literals, sum_of.weights, strict=True) if holds(lit)) >= sum_of.bound


@pytest.mark.parametrize(
    "asked",
    [
        AtLeast((Before(A, C), Before(A, D), Before(A, B)), (3, 2, 2), 4, ABOUT),
        AtLeast((Before(C, A), Before(E, A)), (-1, 2), 1, ABOUT),
        AtLeast((Before(A, C), Before(C, A), Before(B, A)), (1, 1, 1), 2, ABOUT),
        AtLeast((Enough((Before(A, C), Before(B, A)), (1, 1), 1), Before(E, A)), (1, 1), 1, ABOUT),
        AtLeast((Enough((Before(A, C), Before(B, A)), (1, 1), 1), Before(E, A)), (-1, 1), 0, ABOUT),
        AtLeast((Steps(A, B), Steps(B, E)), (-1, -1), -1, ABOUT),
        AtLeast((Steps(A, E, -3, 3), Before(B, A)), (-1, 1), 0, ABOUT),
    ],
)
def test_a_sum_is_met_only_where_it_is_met_in_either_order(at_once: GantryStatements, asked: AtLeast) -> None:
    """An order of the first torch that is lawful is lawful with the copies put right before, or right after."""
    made = told(at_once, asked)
    copies = {0: (A, C), 1: (B, D), 2: (E,)}
    for order in ([0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]):
        lawful = not at_once.impossible and all(isinstance(s, AtLeast) and held(s, order) for s in made)
        if lawful:
            assert held(asked, [k for one in order for k in copies[one]])
            assert held(asked, [k for one in order for k in copies[one][::-1]])


@pytest.mark.parametrize(("out", "left"), [({A, B}, {C, E}), ({A}, {C, D, E}), ({A, D}, {C, B}), ({E, C}, {D})])
def test_what_must_not_be_seen_is_not_seen_in_either_order(
    at_once: GantryStatements, out: set[int], left: set[int]
) -> None:
    asked = NoGood(frozenset(out), frozenset(left), ABOUT)
    made = told(at_once, asked)
    copies = {0: (A, C), 1: (B, D), 2: (E,)}

    def seen(order: Sequence[int], out: frozenset[int], left: frozenset[int]) -> bool:
        return any(out <= set(order[:k]) and not left & set(order[:k]) for k in range(1, len(order) + 1))

    lawful_somewhere = False
    for order in ([0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]):
        lawful = not at_once.impossible and all(
            held(s, order) if isinstance(s, AtLeast) else isinstance(s, NoGood) and not seen(order, s.out, s.left)
            for s in made
        )
        orders = ([k for one in order for k in copies[one]], [k for one in order for k in copies[one][::-1]])
        assert lawful == (not any(seen(one, asked.out, asked.left) for one in orders))
        lawful_somewhere |= lawful
    assert lawful_somewhere


def test_a_run_of_copies_is_one_run(at_once: GantryStatements) -> None:
    runs = told(at_once, Contiguous((A, B), ABOUT), Contiguous((C, D), ABOUT))
    assert runs == [Contiguous((0, 1), ABOUT)]


def test_no_torch_travels_over_what_is_out(at_once: GantryStatements) -> None:
    area = shapely.box(0, 100, 50, 150)
    one, other = told(at_once, Crossing(C, area, ABOUT))
    assert isinstance(one, Crossing)
    assert isinstance(other, Crossing)
    assert one.over == other.over == 0
    assert (one.area.bounds, other.area.bounds) == ((0, 100, 50, 150), (0, 0, 50, 50))
