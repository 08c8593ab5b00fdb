"""Moves over parts that are out: found one by one, or left out and said so where there are too many."""

from __future__ import annotations

from dataclasses import replace
from itertools import count

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from kerfwise import InputError, Profile
from kerfwise.jobs.request import facts_of, make_request
from kerfwise.models.engines import deadline
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.engines.solve import solve as solve_rounds
from kerfwise.models.physics.time_and_cost import feeds_of
from kerfwise.models.plan.make_plan import make_plan
from kerfwise.models.problem import crossings
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.crossings import Crossings, IdleMoves, crossed_areas, in_order
from kerfwise.models.problem.evaluate import route_cost, unpriced_crossings
from kerfwise.rule_kit import About, Precede, nest, part, rect
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.statements import by_kind

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


RING = shapely.box(10, 10, 20, 20).difference(shapely.box(13, 13, 17, 17))
TWO = shapely.union_all([shapely.box(0, 0, 2, 2), shapely.box(5, 0, 7, 2)])


def crossed(leave: list[list[float]], reach: list[list[float]], areas: list[shapely.Geometry]) -> list[tuple[int, ...]]:
    moves = IdleMoves(
        np.array(leave, dtype=float),
        np.array(reach, dtype=float),
        np.zeros(len(reach), dtype=np.int64),
        np.arange(len(areas)),
    )
    ((one, other, area),) = crossed_areas([moves], areas, np.zeros((1, len(areas)), dtype=np.bool_))
    return sorted(zip(one.tolist(), other.tolist(), area.tolist(), strict=True))


@pytest.mark.parametrize(
    ("leave", "reach", "meets"),
    [
        ([5, 15], [25, 15], True),
        ([14, 14], [16, 16], False),  # within the hole
        ([14, 14], [25, 14], True),
        ([11, 11], [12, 12], True),  # within the area, no edge is cut
        ([11, 11], [11, 11], True),
        ([15, 15], [15, 15], False),
        ([5, 21], [25, 21], False),
        ([5, 5], [9, 20], False),
    ],
)
def test_a_ring_is_met_where_it_has_metal(leave: list[float], reach: list[float], meets: bool) -> None:
    assert bool(crossed([leave], [reach], [RING])) is meets


def test_areas_in_pieces_and_empty_ones() -> None:
    areas = [shapely.Polygon(), TWO, shapely.Polygon()]
    assert crossed([[3, -1]], [[3, 3], [6, 1]], areas) == [(0, 1, 1)]


def test_areas_of_no_account_are_left_out() -> None:
    moves = IdleMoves(np.array([[5.0, 15.0]]), np.array([[25.0, 15.0]] * 2), np.array([0, 1]), np.array([0]))
    late = np.array([[True], [False]])
    assert [rows.tolist() for rows in crossed_areas([moves], [RING], late)[0]] == [[0], [1], [0]]


@st.composite
def scenes(draw: st.DrawFn) -> tuple[np.ndarray, np.ndarray, list[shapely.Geometry]]:
    rng = np.random.default_rng(draw(st.integers(0, 10**6)))
    points = rng.uniform(0, 100, (2, draw(st.integers(1, 40)), 2))
    blobs = [shapely.Point(*rng.uniform(0, 100, 2)).buffer(rng.uniform(1, 40), quad_segs=3) for _ in range(6)]
    return points[0], points[1], [blobs[0].difference(blobs[1]), blobs[2].union(blobs[3]), blobs[4], blobs[5]]


@given(scenes())
def test_what_is_crossed_is_what_shapely_says(scene: tuple[np.ndarray, np.ndarray, list[shapely.Geometry]]) -> None:
    leave, reach, areas = scene
    found = crossed(leave.tolist(), reach.tolist(), areas)
    lines = shapely.linestrings(
        [[a, b] for a in leave for b in reach],
    )
    meets = shapely.intersects(lines[:, None], np.array(areas, dtype=object)[None, :])
    lines_met, areas_met = np.nonzero(meets)
    k = len(reach)
    assert found == sorted(zip((lines_met // k).tolist(), (lines_met % k).tolist(), areas_met.tolist(), strict=True))


@given(scenes())
def test_by_arrays_the_same_is_crossed_in_the_same_order(
    scene: tuple[np.ndarray, np.ndarray, list[shapely.Geometry]],
) -> None:
    leave, reach, areas = scene
    asked, late = np.append(reach, leave[:1], axis=0), np.arange(2 * len(areas)).reshape(2, -1) % 5 == 0
    moves = IdleMoves(leave, asked, np.arange(len(asked)) % 2, np.arange(len(areas))[::-1].copy())
    ((*compiled,),) = crossed_areas([moves], areas, late)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("kerfwise.models.problem.crossings.AT_ONCE", 50)
        patch.setattr("kerfwise.models.problem.crossings.suited", lambda kernel, steps, by_arrays: by_arrays)
        ((*by_arrays,),) = crossed_areas([moves], areas, late)
    for one, other in zip(compiled, by_arrays, strict=True):
        assert one.dtype == other.dtype
        np.testing.assert_array_equal(one, other)


def test_rows_are_the_same_however_little_room_there_is_at_first(monkeypatch: pytest.MonkeyPatch) -> None:
    leave, reach = np.random.default_rng(3).uniform(0, 30, (2, 12, 2))
    known = crossed(leave.tolist(), reach.tolist(), [RING, TWO])
    monkeypatch.setattr("kerfwise.models.problem.crossings.ROWS_AT_FIRST", 1)
    assert len(known) > 16
    assert crossed(leave.tolist(), reach.tolist(), [RING, TWO]) == known
