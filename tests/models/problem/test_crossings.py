"""Moves over parts that are out: found one by one, or left out and said so where there are too many."""

from __future__ import annotations

from dataclasses import replace
from itertools import count

import numpy as np
import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.jobs.request import facts_of, make_request
from kerfwise.models.engines import deadline
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.engines.solve import solve as solve_rounds
from kerfwise.models.physics.time_and_cost import feeds_of
from kerfwise.models.plan.make_plan import make_plan
from kerfwise.models.problem import crossings
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.crossings import Crossings, in_order
from kerfwise.models.problem.evaluate import route_cost, unpriced_crossings
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.statements import About, Precede, by_kind

ROW = nest(500, 300, *(part(f"P{k}", rect(50 + 120 * k, 50, 100, 100)) for k in range(3)))


def with_tips(strength: str) -> Profile:
    profile = load_profile("plasma-carbon-steel")
    tips = replace(profile.rules["no-tip-travel"], strength=strength, weight=50.0 if strength == "soft" else None)
    return replace(profile, rules={**profile.rules, "no-tip-travel": tips})


def test_moves_over_the_part_between_are_found() -> None:
    profile = with_tips("soft")
    asked = make_request(facts_of(ROW, profile), profile)
    problem = make_problem(asked.facts, asked.stated.statements, (0.0, 0.0))
    rows = problem.crossings
    ends = problem.ends()[rows.leave][:, 0] / 1000
    starts = problem.pierces()[rows.reach][:, 0] / 1000
    middle = rows.over == ROW.index["P1.outer"]
    assert middle.any()
    assert ((ends < 270) & (starts > 170) | (ends > 170) & (starts < 270))[middle].all()
    assert problem.left_out == ()


def test_rows_stand_in_the_order_of_their_moves_and_take_few_bytes() -> None:
    profile = with_tips("soft")
    asked = make_request(facts_of(ROW, profile), profile)
    problem = make_problem(asked.facts, asked.stated.statements, (0.0, 0.0))
    rows, m = problem.crossings, problem.m
    pairs = list(zip(rows.leave.tolist(), rows.reach.tolist(), strict=True))
    assert rows.moves(m).tolist() == [leave * (m + 1) + reach for leave, reach in pairs]
    assert pairs == sorted(pairs)
    assert in_order(rows.moves(m)) is None
    mixed = rows.only(np.random.default_rng(1).permutation(len(rows)))
    order = in_order(mixed.moves(m))
    assert order is not None
    assert mixed.only(order).moves(m).tolist() == rows.moves(m).tolist()
    assert rows.nbytes == 24 * len(rows)


def test_the_numbers_of_moves_between_many_sites_do_not_overflow() -> None:
    one = np.array([99_999], dtype=np.int32)
    assert Crossings(one, one, one, one.astype(np.int64), one).moves(100_000).tolist() == [99_999 * 100_001 + 99_999]


def test_too_many_moves_leave_a_soft_rule_unpriced_and_the_plan_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(crossings, "MOST_MOVES", 10)
    profile = with_tips("soft")
    asked = make_request(facts_of(ROW, profile), profile)
    solution = solve_rounds(asked.facts, asked.stated.statements, SolveOptions(work=1.0, feeds=feeds_of(profile)))
    plan = make_plan(asked.facts, profile, asked.stated, solution, "portfolio", 1)
    (dropped,) = [d for d in plan.dropped if d.rule == "no-tip-travel"]
    assert dropped.why.startswith("not priced: idle travel over parts that are out asks about")
    assert not dropped.relaxed


def test_too_many_moves_are_refused_where_the_rule_is_hard(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(crossings, "MOST_MOVES", 10)
    profile = with_tips("hard")
    asked = make_request(facts_of(ROW, profile), profile)
    with pytest.raises(InputError, match="more than the 10 that can be looked at: switch no-tip-travel off"):
        make_problem(asked.facts, asked.stated.statements, (0.0, 0.0))


def test_moves_looked_at_once_are_not_looked_at_again(monkeypatch: pytest.MonkeyPatch) -> None:
    profile = with_tips("soft")
    asked = make_request(facts_of(ROW, profile), profile)
    statements = tuple(s for s in asked.stated.statements if not isinstance(s, Precede))
    first = make_problem(asked.facts, statements, (0.0, 0.0))
    about = About("test", (), "P1 comes before P2")
    more = (*statements, Precede(ROW.index["P1.outer"], ROW.index["P2.outer"], about))
    anew = make_problem(asked.facts, more, (0.0, 0.0))
    assert len(anew.crossings) < len(first.crossings), "another order, other moves"
    assert len(make_problem(asked.facts, more, (0.0, 0.0), earlier=first).crossings) == len(anew.crossings)
    monkeypatch.setattr(crossings, "MOST_MOVES", 0)
    assert make_problem(asked.facts, statements, (0.0, 0.0), earlier=first).crossings is first.crossings


def test_moves_for_which_the_time_is_too_short_leave_a_soft_rule_unpriced() -> None:
    asked_shares: list[float] = []

    def half_the_pace(share: float) -> bool:
        asked_shares.append(share)
        return False

    profile = with_tips("soft")
    asked = make_request(facts_of(ROW, profile), profile)
    problem = make_problem(asked.facts, asked.stated.statements, (0.0, 0.0), going=half_the_pace)
    assert asked_shares == [0.0]
    ((rule, why),) = problem.left_out
    assert (rule, len(problem.crossings)) == ("no-tip-travel", 0)
    assert why.endswith("moves, for which the time limit is too short")
    again = make_problem(asked.facts, asked.stated.statements, (0.0, 0.0), None, problem, half_the_pace)
    assert (asked_shares, again.left_out) == ([0.0], problem.left_out)


def test_all_moves_are_looked_at_where_the_rule_is_hard() -> None:
    profile = with_tips("hard")
    asked = make_request(facts_of(ROW, profile), profile)
    problem = make_problem(asked.facts, asked.stated.statements, (0.0, 0.0), going=lambda share: False)
    assert len(problem.crossings)


@pytest.mark.parametrize(("time_s", "left_out"), [(1.0, 1), (None, 0)])
def test_the_clock_counts_under_a_limit_in_seconds_alone(
    monkeypatch: pytest.MonkeyPatch, time_s: float | None, left_out: int
) -> None:
    ticks = count()
    monkeypatch.setattr(crossings, "GROUPS_AT_ONCE", 1)
    monkeypatch.setattr(deadline, "running_s", lambda: float(next(ticks)))
    profile = with_tips("soft")
    asked = make_request(facts_of(ROW, profile), profile)
    options = SolveOptions(work=1.0, time_s=time_s, feeds=feeds_of(profile))
    assert len(solve_rounds(asked.facts, asked.stated.statements, options).left_out) == left_out


def test_what_a_route_crosses_is_paid_for_besides_where_single_moves_are_not_asked() -> None:
    """As if each move of the route had been looked at among all others."""
    chance, profile = np.random.default_rng(7), with_tips("soft")
    asked = make_request(facts_of(ROW, profile), profile)
    tips = by_kind(asked.stated.statements).crossing
    whole, bare = (make_problem(asked.facts, told, (0.0, 0.0)) for told in (tips, ()))
    paid = list[int]()
    for _ in range(200):
        route = [int(chance.choice(whole.sites(int(c)))) for c in chance.permutation(whole.n)]
        paid.append(unpriced_crossings(bare, tips, route))
        assert route_cost(bare, route) + paid[-1] == route_cost(whole, route)
    assert {0, 50_000} <= set(paid)
