"""Contradictions by hand and at random: found where there are, minimal by brute force, relaxed at the least cost."""

from __future__ import annotations

from itertools import combinations

import pytest
from hypothesis import given

from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.plan.conflict.core import Core, find_core
from kerfwise.models.plan.conflict.groups import CanClash, hard_groups
from kerfwise.models.plan.conflict.order_model import fewest_out
from kerfwise.models.plan.conflict.ways_out import Relaxation, _weights, find_relaxation
from kerfwise.rules.registry import RULES
from kerfwise.rules.statements import About, AtLeast, Before, Contiguous, Forbid, Lag, NoGood, Pick, Precede
from kerfwise.tests.models.plan.conflict.statements import can_hold, row, statements
from kerfwise.tests.tools.amount import examples

FACTS = row()


def about(sentence: str, rule: str = "locks") -> About:
    return About(rule, (), sentence)


def core_of(asked: list[CanClash]) -> Core | None:
    return find_core(FACTS, hard_groups(asked), {"level-ahead": 1})


def relaxation(asked: list[CanClash]) -> Relaxation | None:
    gives_way = {name: rule.gives_way for name, rule in RULES.items()}
    return find_relaxation(hard_groups(asked), RULES, lambda groups: find_core(FACTS, groups, gives_way))


def said(asked: list[CanClash]) -> list[str]:
    core = core_of(asked)
    assert core is not None
    assert core.minimal
    return [group.about.sentence for group in core.groups]


def test_a_cycle_without_what_hangs_on_it() -> None:
    chain = [Precede(0, 1, about("a")), Precede(1, 2, about("b")), Precede(2, 3, about("c")), Precede(2, 0, about("d"))]
    assert said([*chain]) == ["a", "b", "d"]
    assert core_of(chain[:3]) is None


def test_entry_against_direction() -> None:
    entry, direction, other = Forbid(1, about("entry")), Forbid(0, about("direction")), Forbid(2, about("other"))
    assert said([other, entry, direction]) == ["entry", "direction"]
    assert core_of([other, entry]) is None


def test_statements_with_one_sentence_are_one() -> None:
    assert said([Forbid(0, about("none of them")), Forbid(1, about("none of them"))]) == ["none of them"]


def test_a_run_against_orders() -> None:
    run = Contiguous((0, 1), about("run"))
    orders = [Precede(0, 2, about("in")), Precede(2, 1, about("out")), Precede(0, 3, about("aside"))]
    assert said([run, *orders]) == ["run", "in", "out"]


def test_a_position_against_an_order() -> None:
    ahead = AtLeast(tuple(Before(k, 3) for k in (0, 1, 2)), (1, 1, 1), 3, about("last"))
    assert said([ahead, Precede(3, 1, about("before"))]) == ["last", "before"]


def test_a_candidate_that_asks_for_an_order() -> None:
    asks = AtLeast((Before(1, 0),), (1,), 1, about("asks"), when=0)
    must = AtLeast((Pick(0),), (1,), 1, about("must"))
    assert said([asks, must, Precede(0, 1, about("order"))]) == ["asks", "must", "order"]
    assert core_of([asks, Precede(0, 1, about("order"))]) is None


def test_a_lag_counts_what_no_statement_names() -> None:
    assert core_of([Lag(0, 1, about("two between"), cuts=2)]) is None
    assert said([Lag(0, 1, about("three between"), cuts=3)]) == ["three between"]


def test_a_no_good_against_orders() -> None:
    strip = NoGood(frozenset({0, 2}), frozenset({1}), about("strip"))
    assert said([strip, Precede(0, 1, about("a")), Precede(2, 1, about("b"))]) == ["strip", "a", "b"]


def test_locks_give_way_last() -> None:
    """Two orders of level-ahead weigh more than a lock would by itself."""
    last = AtLeast(tuple(Before(k, 0) for k in (1, 2, 3)), (1, 1, 1), 3, about("last"))
    ahead = [Precede(0, 1, about("a", "level-ahead")), Precede(0, 2, about("b", "level-ahead"))]
    found = relaxation([last, *ahead])
    assert found is not None
    assert [group.about.sentence for group in found.groups] == ["a", "b"]


def test_what_may_never_give_way_leaves_no_way_out() -> None:
    inner = [Precede(0, 1, about("a", "inner-before-outer")), Precede(1, 0, about("b", "inner-before-outer"))]
    assert relaxation(inner) is None


@pytest.mark.slow
@examples(60)
@given(statements())
def test_found_where_there_is_one_and_minimal(asked: list[CanClash]) -> None:
    core = core_of(asked)
    assert (core is None) == can_hold(FACTS, asked)
    if core is None:
        return
    assert core.minimal
    inside = [s for group in core.groups for s in group.statements]
    assert not can_hold(FACTS, inside)
    for one in inside:
        assert can_hold(FACTS, [s for s in inside if s is not one])


@pytest.mark.slow
@examples(40)
@given(statements(most=5))
def test_the_way_out_is_the_cheapest(asked: list[CanClash]) -> None:
    """Every set of statements that may give way is tried."""
    found = relaxation(asked)
    may = [s for s in asked if not RULES[s.about.rule].of_fallen_metal]
    out = [gone for size in range(len(may) + 1) for gone in combinations(may, size)]
    helping = [_price(gone) for gone in out if can_hold(FACTS, [s for s in asked if s not in gone])]
    assert (found is None) == (not helping)
    groups = hard_groups(asked)
    at_once = fewest_out(FACTS, groups, _weights(groups, RULES), Deadline(9.0))
    assert (at_once is None) == (not helping)
    if at_once is not None:
        numbers, shown = at_once
        assert shown
        assert _price(tuple(s for k in numbers for s in groups[k].statements)) == min(helping)
    if found is not None:
        gone = tuple(s for group in found.groups for s in group.statements)
        assert can_hold(FACTS, [s for s in asked if s not in gone])
        assert _price(gone) == min(helping)


def _price(gone: tuple[CanClash, ...]) -> tuple[int, int]:
    """Locks first, then how many statements: each costs the same in the objective."""
    return sum(s.about.rule == "locks" for s in gone), len(gone)
