"""The beam against brute force, what it claims when it had to drop states, and its limits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from kerfwise.arrays import Ints
from kerfwise.models.engines.beam import beam, beam_search, layers, unfit
from kerfwise.models.engines.beam.beam_search import can_reverse, reversed_problem
from kerfwise.models.engines.beam.bounds import least_in_and_out, priced_walks
from kerfwise.models.engines.beam.tables import BeamTables, make_beam_tables, travel_table
from kerfwise.models.engines.ideals import prove
from kerfwise.models.engines.solution import Incumbent
from kerfwise.models.problem.crossings import Crossings
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.models.problem.problem import Links, Problem
from kerfwise.rules.statements import Lag
from kerfwise.tests.models.brute import cheapest, lawful
from kerfwise.tests.models.problems import ABOUT, problem, problems, scattered
from kerfwise.tests.tools.amount import examples


def within_reach(drawn: Problem) -> Problem:
    """Without what the beam does not take."""
    return replace(drawn, general=(), lags=tuple(lag for lag in drawn.lags if lag.cuts <= 1 and not lag.seconds))


@pytest.mark.slow
@examples(100)
@given(problems())
def test_same_optimum_as_brute_force(drawn: Problem) -> None:
    tiny = within_reach(drawn)
    best, found = cheapest(tiny), beam(tiny)
    assert not unfit(tiny)
    assert found.proven
    if best is None:
        assert found.incumbent is None
        return
    assert found.incumbent is not None
    assert found.incumbent.cost == found.bound == best.cost
    assert broken(tiny, found.incumbent.route) == ()
    assert route_cost(tiny, found.incumbent.route) == best.cost


@pytest.mark.slow
@examples(100)
@given(problems())
def test_same_optimum_with_every_bound(drawn: Problem) -> None:
    tiny = within_reach(drawn)
    best = cheapest(tiny)
    assume(best is not None)
    assert best is not None
    found = beam(tiny, Incumbent(best.route, best.cost + 1), first_width=beam_search.WORTH_PRICING)
    assert found.proven
    assert found.incumbent is not None
    assert found.incumbent.cost == found.bound == best.cost


def test_walks_that_visit_everything_once_end_the_pricing() -> None:
    """Prices that went on along what was left of the last direction, which fades, once grew beyond all measure."""
    here = [(0.0, 0.0)]
    tiny = problem(
        [here * 3, here * 3, here, here], ends_mm=[here * 3, here * 3, [(0.0, 1.0)], here], pairs=[(0, 1), (0, 2)]
    )
    found = beam(tiny, Incumbent((0, 3, 6, 7), 1001), first_width=beam_search.WORTH_PRICING)
    assert found.incumbent is not None
    assert found.incumbent.cost == found.bound == 1000


@pytest.mark.slow
@examples(100)
@given(problems(), st.integers(1, 4))
def test_a_narrow_beam_claims_no_more_than_it_knows(drawn: Problem, width: int) -> None:
    tiny = within_reach(drawn)
    best, found = cheapest(tiny), beam(tiny, first_width=width, last_width=width)
    if best is None:
        assert found.incumbent is None
        return
    assert found.bound is None or found.bound <= best.cost
    if found.incumbent is not None:
        assert broken(tiny, found.incumbent.route) == ()
        assert best.cost <= found.incumbent.cost == route_cost(tiny, found.incumbent.route)
    if found.proven:
        assert found.incumbent is not None
        assert found.incumbent.cost == best.cost


def test_a_narrow_beam_does_drop_states() -> None:
    plain = scattered(3, 12, 2)
    narrow, wide = beam(plain, first_width=2, last_width=2), beam(plain)
    assert not narrow.proven
    assert wide.proven
    assert narrow.width == 2
    assert narrow.bound is not None
    assert wide.bound is not None
    assert narrow.bound < wide.bound


@pytest.mark.parametrize("seed", range(4))
def test_same_optimum_as_the_whole_program(seed: int) -> None:
    plain = scattered(seed, 12, 3, pairs=8, blocks=[(2, 3, 4), (7, 8)])
    proof, found = prove(plain, None, work=10), beam(plain)
    assert proof is not None
    assert proof.incumbent is not None
    assert found.proven
    assert found.bound == proof.incumbent.cost


def test_an_incumbent_saves_work_and_changes_nothing_else() -> None:
    plain = scattered(2, 12, 2, pairs=6)
    free = beam(plain)
    assert free.incumbent is not None
    told = beam(plain, free.incumbent)
    assert (told.incumbent, told.bound, told.proven) == (free.incumbent, free.bound, True)
    assert told.work < free.work
    dearer = Incumbent(free.incumbent.route, free.incumbent.cost + 1)
    assert beam(plain, dearer).bound == free.bound


def zones(count: int, size: int) -> Problem:
    """Zones of contours from left to right, each before the next."""
    bare = scattered(5, count * size, 2)
    pairs = [(i, j) for i in range(count * size) for j in range(count * size) if i // size + 1 == j // size]
    where = [[(x / 1000, y / 1000) for x, y in bare.pierce_um[list(bare.sites(i))].tolist()] for i in range(bare.n)]
    return problem(where, pairs=pairs)


def test_proves_more_contours_than_a_word_has_bits() -> None:
    many = zones(14, 5)
    proof, found = prove(many, None, work=10), beam(many)
    assert proof is not None
    assert proof.incumbent is not None
    assert found.proven
    assert found.bound == proof.incumbent.cost


@pytest.mark.slow
def test_same_states_however_a_layer_is_shared_out(monkeypatch: pytest.MonkeyPatch) -> None:
    plain = scattered(4, 30, 2, pairs=40)
    alone = beam(plain, last_width=500)
    monkeypatch.setattr(layers, "WORTH_SHARING", 2)
    shared = beam(plain, last_width=500)
    assert (shared.incumbent, shared.bound, shared.work) == (alone.incumbent, alone.bound, alone.work)


def test_sets_of_the_same_hash_are_told_apart(monkeypatch: pytest.MonkeyPatch) -> None:
    plain = scattered(6, 9, 2, pairs=4)
    right = beam(plain)

    def without_noise(given: Problem, travel: Ints) -> BeamTables:
        tables = make_beam_tables(given, travel)
        return tables._replace(orders=tables.orders._replace(noise=np.zeros_like(tables.orders.noise)))

    monkeypatch.setattr(beam_search, "make_beam_tables", without_noise)
    assert beam(plain) == right


@pytest.mark.slow
def test_forgetting_what_leads_nowhere_keeps_the_route(monkeypatch: pytest.MonkeyPatch) -> None:
    plain = scattered(7, 40, 2, pairs=60)
    kept = beam(plain, last_width=200)
    monkeypatch.setattr(layers, "WORTH_CLEARING", 300)
    assert beam(plain, last_width=200) == kept


@pytest.mark.slow
def test_equal_work_gives_equal_answers() -> None:
    large = scattered(8, 90, 2, pairs=300)
    first, second = beam(large, work=0.2), beam(large, work=0.2)
    assert first == second
    assert first.work == second.work <= 0.3
    assert first.incumbent is not None
    assert broken(large, first.incumbent.route) == ()


def test_stops_when_told_to() -> None:
    large = scattered(8, 90, 2, pairs=300)
    assert beam(large, time_s=0.0).work < 0.01
    heard: list[str] = []

    def listen(engine: str, cost_um: int | None, bound_um: int | None) -> bool:
        heard.append(engine)
        return len(heard) < 5

    assert beam(large, progress=listen).incumbent is None
    assert heard == ["beam"] * 5


def test_takes_only_what_a_state_holds() -> None:
    plain = scattered(1, 4, 1)
    assert not unfit(plain)
    assert unfit(replace(plain, lags=(Lag(0, 1, ABOUT, cuts=2),))) == "rule test looks further back than the last cut"
    assert unfit(replace(plain, travel_weight=1e4)) == "a move costs more than its tables hold"


def test_no_contours_at_all() -> None:
    found = beam(problem([]))
    assert found.proven
    assert found.incumbent == Incumbent((), 0)


@pytest.mark.slow
@examples(100)
@given(problems())
def test_turned_round_the_routes_are_the_same_backwards(drawn: Problem) -> None:
    linked = replace(within_reach(drawn), crossings=Crossings())
    assert can_reverse(linked) == (len(linked.links) == 0)
    tiny = replace(linked, links=Links())
    other = reversed_problem(tiny)
    back = {route[::-1]: route_cost(other, route) for route in lawful(other)}
    assert back == {route: route_cost(tiny, route) for route in lawful(tiny)}


@pytest.mark.slow
@examples(100)
@given(problems())
def test_walks_bound_the_best_route(drawn: Problem) -> None:
    tiny = within_reach(drawn)
    best = cheapest(tiny)
    assume(best is not None)
    assert best is not None
    travel = travel_table(tiny)
    walks = priced_walks(tiny, travel, least_in_and_out(tiny, travel), best.cost, 50, lambda operations: None)
    stops = [*best.route, tiny.m]
    for at in range(1, tiny.n + 1):
        left = [int(tiny.site_contour[s]) for s in best.route[at:]]
        rest = int(travel[stops[at - 1 : -1], stops[at:]].sum()) + int(tiny.site_cost[list(best.route[at:])].sum())
        home = walks.to_go[0, tiny.n, best.route[-1]] - travel[best.route[-1], tiny.m]  # what it crosses
        assert walks.to_go[0, at, best.route[at - 1]] + walks.price[0, left].sum() <= rest + home + 1e-6


def test_walks_are_dearer_than_least_moves() -> None:
    plain = scattered(3, 12, 2, pairs=8)
    best = beam(plain).bound
    assert best is not None
    travel = travel_table(plain)
    simple = least_in_and_out(plain, travel)
    walks = priced_walks(plain, travel, simple, best, 300, lambda operations: None)
    roots = [
        float(
            (bound.to_go[0, 1, :] - bound.price[0, plain.site_contour] + travel[-1, :-1]).min() + bound.price[0].sum()
        )
        for bound in (simple, walks)
    ]
    assert roots[0] < roots[1] <= best


def test_both_bounds_and_both_ends_are_used(monkeypatch: pytest.MonkeyPatch) -> None:
    plain = scattered(9, 20, 2, pairs=25)
    monkeypatch.setattr(beam_search, "WORTH_PRICING", 1)
    early = beam(plain)
    monkeypatch.setattr(beam_search, "can_reverse", lambda _: False)
    monkeypatch.setattr(beam_search, "WORTH_PRICING", 10**9)
    late = beam(plain)
    assert early.proven
    assert late.proven
    assert early.bound == late.bound
    assert early.width < late.width
