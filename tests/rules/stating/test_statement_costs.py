"""Weighted completion: the order that Smith's rule gives, the price by hand, and nothing where all parts are alike."""

from __future__ import annotations

from dataclasses import replace
from itertools import permutations

import pytest

import kerfwise
from kerfwise import Nest
from kerfwise.encoder.facts import compute_facts
from kerfwise.rule_kit import About, AtLeast, Before, FactOptions, Facts, Lag, Precede, Statement, nest, part, rect
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.stating.statement_costs import classes, late_parts, soften


def facts_of(made: Nest) -> Facts:
    """Facts without candidates."""
    return compute_facts(made, FactOptions(), ())


SIDES = {"A": 90.0, "B": 20.0, "C": 50.0, "D": 30.0}


def row(**said: dict[str, object]) -> Nest:
    """Four squares in a row, with what is said of them."""
    made = [part(name, rect(10 + 110 * k, 10, side, side)) for k, (name, side) in enumerate(SIDES.items())]
    return nest(460, 110, *(replace(one, attributes=said.get(one.id, {})) for one in made))


def plant(price: float) -> kerfwise.Profile:
    """The default profile with no rules but those about metal, almost free travel and this price of waiting."""
    profile = load_profile()
    on = ("pierce", "inner-before-outer")
    off = {
        name: setting if name in on else replace(setting, strength="off", weight=None)
        for name, setting in profile.rules.items()
    }
    return replace(profile, rules=off, objective=replace(profile.objective, completion=price, idle=1e-3))


def test_classes_are_by_priority_then_due() -> None:
    made = row(A={"priority": 2}, B={"priority": 1, "due": "2026-12-24"}, C={"priority": 1, "due": "2026-12-01"})
    assert classes(made.parts) == {"A": 1, "B": 2, "C": 3, "D": 0}
    assert set(classes(row(A={"priority": "high"}).parts).values()) == {0}


def waits_mm(order: tuple[str, ...], rank: dict[str, int], price: float, profile: kerfwise.Profile) -> float:
    """The price of an order by hand: class × price × seconds cut before each part is out."""
    machine = profile.machine
    seconds = {name: machine.pierce_time_s + 4 * side / machine.cut_feed_mm_s for name, side in SIDES.items()}
    return sum(price * rank[late] * seconds[early] for k, late in enumerate(order) for early in order[:k] if rank[late])


def test_the_plan_is_that_of_smiths_rule_and_proven() -> None:
    made = row(A={"due": "2026-12-01"}, B={"due": "2026-12-02"}, D={"due": "2026-12-03"})
    rank = {"A": 3, "B": 2, "C": 0, "D": 1}
    profile = plant(1000.0)
    result = kerfwise.solve(made, profile, work=5)
    order = tuple(planned.part for planned in result.plan.cuts)
    best = min(permutations(SIDES), key=lambda one: waits_mm(one, rank, 1000.0, profile))
    assert order == best == ("B", "A", "D", "C")
    assert result.plan.solve.status == "optimal"
    assert result.plan.solve.objective == pytest.approx(waits_mm(best, rank, 1000.0, profile), rel=1e-3)


def test_parts_that_are_alike_and_a_price_of_nothing_change_nothing() -> None:
    assert list(late_parts(facts_of(row()), plant(1000.0))) == []
    due = row(A={"due": "2026-12-01"})
    assert list(late_parts(facts_of(due), plant(0.0))) == []
    assert len(list(late_parts(facts_of(due), plant(1.0)))) == 3


ABOUT = About("r", (), "")


def test_kinds_and_prices_of_their_own_may_be_mixed() -> None:
    given: list[Statement] = []
    for k in range(24):
        given += [AtLeast((Before(k, 0),), (2,), 1, ABOUT, k)] * (k % 5) + [Lag(k, k + 1, ABOUT, 3)] * (k // 8 * 8)
        given += [Precede(k, 0, ABOUT, 7.0 if k % 3 else None), Precede(0, k, ABOUT, 0.0)]
    found = list(soften(iter(given), 25.0))
    assert found == [replace(s, weight=25.0) if s.weight is None else s for s in given]
    assert any(s.weight == 0.0 for s in found)
    assert all(s.weight is None for s in given if isinstance(s, Lag))


def test_none_are_none() -> None:
    assert list(soften([], 25.0)) == []
