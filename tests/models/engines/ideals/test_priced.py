"""Sweeps by the multipliers of linear programs against brute force: bounds never above, plans never dearer."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from importlib import import_module

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from kerfwise.models.engines.bounds.reduced_costs import reduced_costs
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.ideals import priced
from kerfwise.models.engines.ideals.lattice import sweeping
from kerfwise.models.engines.ideals.prove import priceable, prove, prove_priced
from kerfwise.models.engines.solution import Incumbent
from kerfwise.models.engines.tuning import OVERDRAWN_S
from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.crossings import FORBIDDEN, Crossings
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.models.problem.problem import Problem, SoftGroup
from kerfwise.rules.statements import Lag
from kerfwise.tests.models.brute import cheapest, lawful
from kerfwise.tests.models.engines.ideals.test_ahead import in_zones
from kerfwise.tests.models.problems import ABOUT, problem, problems, scattered, with_lags
from kerfwise.tests.tools.amount import examples

PROVING = import_module("kerfwise.models.engines.ideals.prove")  # the package has a function of that name


def swept(tiny: Problem, known: Incumbent, limit: int, work: float = 1.0, backwards: float = 0.0) -> Incumbent | None:
    """The best of all plans up to the limit; no bound is above it, and no plan from stretch to stretch below."""
    stretches = priced.price(tiny, known, Deadline(work, most_bytes=1e9), (), backwards, OVERDRAWN_S)
    assert stretches is not None
    with ThreadPoolExecutor(1) as thread:
        found = stretches.sweep(limit, sweeping(Deadline(), 10.0), thread)
        one = stretches.descend(known.cost, sweeping(Deadline(), 10.0), thread)
    if found is not None:
        assert stretches.root <= found.cost
        assert one is None or one.cost >= found.cost
    if one is not None:
        assert one.cost == route_cost(tiny, one.route)
        assert broken(tiny, one.route) == ()
    return found


def agrees(tiny: Problem) -> None:
    """The best plan is found from the worst one on, and none that costs less."""
    plans = sorted((route_cost(tiny, route), route) for route in lawful(tiny))
    if not plans:
        return
    (best, _), (most, worst) = plans[0], plans[-1]
    far, near = Incumbent(worst, most), Incumbent(plans[0][1], best)
    for known, work, backwards in ((far, 1.0, 0.0), (far, 1e-3, 1.0), (near, 1e-3, 1e-6), (near, 1.0, 0.0)):
        found = swept(tiny, known, best, work, backwards)
        assert found is not None
        assert found.cost == best == route_cost(tiny, found.route)
        assert broken(tiny, found.route) == ()
        assert swept(tiny, known, best - 1, work, backwards) is None


@pytest.mark.slow
@examples(25)
@given(in_zones())
def test_the_best_plan_is_found_zone_after_zone(drawn: Problem) -> None:
    tiny = replace(drawn, soft_groups=())
    assume(tiny.looks_one_back)
    agrees(tiny)


@pytest.mark.slow
@examples(40)
@given(in_zones())
def test_swept_backwards_to_the_end_stretches_promise_what_the_best_plan_costs(drawn: Problem) -> None:
    tiny = replace(drawn, crossings=Crossings(), soft_groups=())
    assume(tiny.looks_one_back)
    plans = sorted((route_cost(tiny, route), route) for route in lawful(tiny))
    assume(plans)
    (best, _), (most, worst) = plans[0], plans[-1]
    settled = priced.price(tiny, Incumbent(worst, most), Deadline(1e-3, most_bytes=1e9), (), 1.0, OVERDRAWN_S)
    assert settled is not None
    assert settled.root == best
    with ThreadPoolExecutor(1) as thread:
        one = settled.descend(most, sweeping(Deadline(), 10.0), thread)
    assert one is not None
    assert one.cost == best


@pytest.mark.slow
@examples(25)
@given(problems(contours=6))
def test_the_best_plan_is_found_where_all_contours_are_one_stretch(drawn: Problem) -> None:
    tiny = replace(drawn, soft_groups=(), general=())
    assume(tiny.looks_one_back)
    agrees(tiny)


@examples(15)
@given(problems(contours=6))
def test_from_the_dearest_plan_on_programs_alone_prove_the_best(drawn: Problem) -> None:
    tiny = replace(drawn, soft_groups=(), general=())
    assume(priceable(tiny))
    plans = sorted((route_cost(tiny, route), route) for route in lawful(tiny))
    assume(plans)
    proof = prove_priced(tiny, Incumbent(plans[-1][1], plans[-1][0]), Deadline(1.0))
    assert proof is not None
    assert proof.incumbent is not None
    assert proof.incumbent.cost == plans[0][0] == route_cost(tiny, proof.incumbent.route)
    assert broken(tiny, proof.incumbent.route) == ()


@st.composite
def with_holes(draw: st.DrawFn) -> Problem:
    """Two zones of contours with holes right before them, conditions between these, and pairs that are to lie apart."""
    where = draw(
        st.lists(st.lists(st.tuples(*[st.integers(0, 60)] * 2), min_size=1, max_size=2), min_size=6, max_size=6)
    )
    blocks = draw(st.sampled_from([[(0, 1)], [(0, 1), (4, 5)], [(0, 1, 2)], [(0, 1, 2), (3, 4)]]))
    before = [(c, block[-1]) for block in blocks for c in block[:-1]]
    border = draw(st.sampled_from([3, 6]))
    before += [(a, b) for a in range(border) for b in range(border, 6)]
    outer = [c for c in range(6) if all(c not in block[:-1] for block in blocks)]
    conditions = []
    for _ in range(draw(st.integers(0, 4))):
        contour, *members = draw(st.permutations(outer))
        weights = tuple(draw(st.sampled_from([-1, 1])) for _ in members[:2])
        when = draw(st.sampled_from([None, 0, 1]))
        site = None if when is None else sum(map(len, where[:contour])) + min(when, len(where[contour]) - 1)
        cost = draw(st.sampled_from([None, 0, 3000, 40_000]))
        bound = draw(st.integers(-1, 2))
        conditions.append(Condition(contour, tuple(members[:2]), weights, bound, ABOUT, site, cost))
    lags = []
    for _ in range(draw(st.integers(0, 3))):
        first, second, *_ = draw(st.permutations(range(6)))
        weight = draw(st.sampled_from([None, 0.0, 5.0, 30.0]))
        lags.append(Lag(first, second, ABOUT, cuts=draw(st.sampled_from([1, 1, 0])), weight=weight))
    points = [[(float(x), float(y)) for x, y in row] for row in where]
    return problem(points, pairs=before, blocks=blocks, conditions=conditions, lags=lags)


@st.composite
def crossing(draw: st.DrawFn) -> Problem:
    """The same with few or many moves, home's among them, that lead over what may be out, all at one price.

    Mostly none from contour to contour of a block or over any but its last, so that this one can stand for the others.
    """
    tiny, share = draw(with_holes()), draw(st.sampled_from([0.02, 0.1, 0.3, 0.6]))
    rng = np.random.default_rng(draw(st.integers(0, 10**6)))
    there = rng.random((tiny.m + 1, tiny.m + 1, tiny.n)) < share
    block = np.append(tiny.block[tiny.site_contour], -1)
    if draw(st.sampled_from([True, True, True, False])):
        there[block[:, None] == block] = False
        there[:, :, [c for c in range(tiny.n) if (tiny.before[c] & (tiny.block == tiny.block[c])).any()]] = False
    leave, reach, over = np.nonzero(there)
    price = draw(st.sampled_from([1, 5000, 20_000, 60_000, FORBIDDEN] if share < 0.2 else [1, 5000, 20_000, 60_000]))
    return replace(tiny, crossings=Crossings(leave, reach, over, np.full(len(leave), price), np.zeros_like(leave)))


@pytest.mark.slow
@examples(25)
@given(crossing())
def test_what_moves_cross_is_paid_for_where_it_is_out(tiny: Problem) -> None:
    agrees(tiny)


def test_each_contour_of_a_block_that_a_move_crosses_is_paid_for() -> None:
    """C1 ends the block of C0, C2 and C3 want it out before them, and moves between these lead over both."""
    rows = [(leave, reach, over, 15_000, 0) for leave, reach in ((2, 3), (3, 2)) for over in (0, 1)]
    over = Crossings(*np.array(rows).T.copy())
    points = [[(10.0, 0.0)], [(20.0, 0.0)], [(20.0, 10.0)], [(10.0, 10.0)]]
    wants = [Condition(contour, (1,), (1,), 1, ABOUT) for contour in (2, 3)]
    agrees(problem(points, pairs=[(0, 1)], blocks=[(0, 1)], conditions=wants, crossings=over))


def test_the_way_home_is_paid_for_from_each_split_of_a_site() -> None:
    """C1 wants C0 out before it, and then the way home leads over C0: it is cheaper to pay for what C1 wants."""
    wants = Condition(1, (0,), (1,), 1, ABOUT, 1, cost=4000)
    home = Crossings(*(np.array([k]) for k in (1, 2, 0, 50_000, 0)))
    agrees(problem([[(10.0, 0.0)], [(20.0, 0.0)]], conditions=[wants], crossings=home))


@pytest.mark.slow
@examples(25)
@given(with_holes())
def test_ways_through_holes_are_found_again(tiny: Problem) -> None:
    agrees(tiny)


@pytest.mark.slow
@examples(15)
@given(with_holes())
def test_multipliers_found_with_fewer_statements_hold_with_more(tiny: Problem) -> None:
    """Those of a stretch stay where it is as it was, and are found anew where it is not."""
    best, fewer = cheapest(tiny), replace(tiny, conditions=tiny.conditions[:-1])
    assume(best is not None)
    assert best is not None
    known = Incumbent(best.route, route_cost(fewer, best.route))
    earlier = priced.price(fewer, known, Deadline(1.0, most_bytes=1e9), (), 1.0)
    stretches = priced.price(tiny, best, Deadline(1.0, most_bytes=1e9), () if earlier is None else earlier.found, 1.0)
    assert stretches is not None
    assert stretches.root <= best.cost
    with ThreadPoolExecutor(1) as thread:
        found = stretches.sweep(best.cost, sweeping(Deadline(), 10.0), thread)
        assert stretches.sweep(best.cost - 1, sweeping(Deadline(), 10.0), thread) is None
    assert found is not None
    assert found.cost == best.cost


@examples(20)
@given(with_holes())
def test_no_plan_costs_less_than_the_bound_and_what_is_left_of_its_moves(tiny: Problem) -> None:
    best = cheapest(tiny)
    assume(best is not None)
    assert best is not None
    found = reduced_costs(tiny, best, best.cost, Deadline(1.0))
    assert found is not None
    assert found.dear.min() >= 0
    network = found.network
    route = np.array([network.problem.m, *network.plan, network.problem.m])
    assert found.bound + found.dear[route[:-1], route[1:]].sum() <= best.cost


def two_zones() -> tuple[Problem, Incumbent]:
    """Ten contours, some of them apart, with conditions that may be paid for, and some lawful plan."""
    bare = scattered(5, 10, 2, pairs=4)
    before = bare.before.copy()
    before[:5, 5:] = True
    held = [Condition(k, (k + 1,), (-1,), 0, ABOUT, cost=30_000) for k in (0, 2, 6)]
    lags = [Lag(0, 1, ABOUT, cuts=1), Lag(4, 5, ABOUT, cuts=1, weight=400.0), Lag(7, 8, ABOUT, cuts=1, weight=90.0)]
    given = with_lags(replace(bare, before=before, conditions=tuple(held)), lags)
    far = prove(replace(given, home_um=given.home_um + 9_000_000), None, Deadline(1.0))
    assert far is not None
    assert far.incumbent is not None
    return given, Incumbent(far.incumbent.route, route_cost(given, far.incumbent.route))


def test_what_is_proven_is_the_same_each_time() -> None:
    given, known = two_zones()
    stages = 0.0, 0.1, 0.4  # the first sweeps do not suffice
    plain = prove(given, None, Deadline(1.0))
    proof, again = (prove(given, known, Deadline(1.0), stages=stages) for _ in range(2))
    assert plain is not None
    assert proof is not None
    assert again is not None
    assert proof.priced
    assert again.priced
    assert plain.incumbent is not None
    assert proof.incumbent is not None
    assert proof.incumbent.cost == plain.incumbent.cost < known.cost
    assert (again.incumbent, again.work) == (proof.incumbent, proof.work)
    tables = [priced.price(given, known, Deadline(1.0, most_bytes=1e9), found.priced) for found in (proof, again)]
    assert tables[0] is not None
    assert tables[1] is not None
    for one, other in zip(tables[0].stretches, tables[1].stretches, strict=True):
        assert one.lows.tobytes() == other.lows.tobytes()
        assert one.relaxed.dear.tobytes() == other.relaxed.dear.tobytes()


def test_without_memory_for_tables_there_are_none() -> None:
    given, known = two_zones()
    assert priced.price(given, known, Deadline(1.0, most_bytes=1e9)) is not None
    assert priced.price(given, known, Deadline(1.0, most_bytes=1e3)) is None


def test_where_groups_cost_or_crossings_have_several_prices_there_are_no_linear_programs() -> None:
    given, _ = two_zones()
    one, two = (Crossings(*np.array([[0, 4, 1, 5000, 0], [1, 4, 1, cost, 0]]).T) for cost in (5000, 6000))
    assert priceable(given)
    assert priceable(replace(given, crossings=one))
    assert not priceable(replace(given, crossings=two))
    assert not priceable(replace(given, soft_groups=(SoftGroup((0, 1), 100, ABOUT),)))
    assert priceable(scattered(5, 10, 2))


def test_of_very_many_contours_there_are_no_linear_programs(monkeypatch: pytest.MonkeyPatch) -> None:
    given, _ = two_zones()
    monkeypatch.setattr(PROVING, "LARGE_NEST", given.n)
    assert priceable(given)
    monkeypatch.setattr(PROVING, "LARGE_NEST", given.n - 1)
    assert not priceable(given)
