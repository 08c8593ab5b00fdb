"""Bounds of stretches apart against brute force: never above what any lawful plan costs, from any state on."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from importlib import import_module
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.models.engines.bounds import completion
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.ideals import prove
from kerfwise.models.engines.ideals.lattice import TooLarge, sweep_through, sweeping
from kerfwise.models.engines.ideals.priced import price
from kerfwise.models.engines.ideals.stretch import series
from kerfwise.models.engines.ideals.stretches.stretch_bounds import Ahead, look_ahead, missed_in
from kerfwise.models.engines.ideals.stretches.stretch_tables import FAR
from kerfwise.models.engines.solution import Incumbent
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.models.problem.problem import Problem
from kerfwise.tests.models.brute import cheapest, lawful
from kerfwise.tests.models.problems import problem, problems, scattered
from kerfwise.tests.tools.amount import examples

PROVING = import_module("kerfwise.models.engines.ideals.prove")  # the package has a function of that name


@st.composite
def in_zones(draw: st.DrawFn, contours: int = 6) -> Problem:
    """A tiny problem, the contours of which are cut zone after zone."""
    tiny = draw(problems(contours))
    zone = np.array(sorted(draw(st.lists(st.integers(0, 2), min_size=tiny.n, max_size=tiny.n))))
    for a in range(tiny.n):  # what is tied together shares a zone
        tied = (tiny.before[a] | tiny.before[:, a] | (tiny.block == tiny.block[a])) & (np.arange(tiny.n) < a)
        zone[a] = zone[tied].max(initial=zone[a])
    before = tiny.before | (zone[:, None] < zone[None, :])
    whole = all(len(np.unique(zone[tiny.block == block])) == 1 for block in tiny.block)
    fits = whole and not (before & before.T).any()
    return replace(tiny, before=before if fits else tiny.before, general=(), lags=())


def still(ahead: list[Ahead], missed: list[int], tiny: Problem, route: tuple[int, ...], k: int) -> float:
    """What a plan still costs at least after the first k sites of a route."""
    ends = np.cumsum([len(here.group) for here in ahead])
    number = int(np.searchsorted(ends, k))
    here, done = ahead[number], int(ends[number]) - len(ahead[number].group)
    left = {int(tiny.site_contour[s]) for s in route[k:]} & set(here.group)
    own, bound = here.group.index(int(tiny.site_contour[route[k - 1]])), here.bound
    free = sum(1 << j for j, c in enumerate(bound.near[own].tolist()) if c >= 0 and here.group[c] in left)
    column = int(np.searchsorted(here.sites, route[k - 1]))
    rest = bound.to_go[k - done, free, column] + sum(bound.price[here.group.index(c)] for c in left)
    return float(rest) + sum(missed[number + 1 :])


@pytest.mark.slow
@examples(40)
@given(in_zones())
def test_no_plan_costs_less_from_any_state_on(tiny: Problem) -> None:
    best = cheapest(tiny)
    if best is None:
        return
    ahead = look_ahead(tiny, best.route, Deadline(0.001, most_bytes=1e9))
    assert [here.group for here in ahead] == series(tiny)
    with ThreadPoolExecutor(1) as thread:
        missed = missed_in(tiny, ahead, best.route, best.cost, sweeping(Deadline(), 1.0), thread)
        worst = max(lawful(tiny), key=lambda route: route_cost(tiny, route))
        from_worst = missed_in(tiny, ahead, worst, route_cost(tiny, worst), sweeping(Deadline(), 1.0), thread)
    assert from_worst == missed  # whatever plan is known
    assert min(missed) >= 0
    assert ahead[0].bound.root + sum(missed) <= best.cost
    for number, route in enumerate(lawful(tiny)):
        if number == 50:
            break
        cost = route_cost(tiny, route)
        for k in range(1, tiny.n + 1):
            sites = list(route[:k])
            spent = int(tiny.legs([tiny.m, *sites[:-1]], sites).sum() + tiny.site_cost[sites].sum())
            assert spent + still(ahead, missed, tiny, route, k) <= cost


@pytest.mark.slow
@examples(40)
@given(in_zones())
def test_the_best_plan_zone_after_zone_is_found_with_bounds_and_without(tiny: Problem) -> None:
    free, best = prove(tiny, None, Deadline(10)), cheapest(tiny)
    assert free is not None
    assert (free.incumbent is None) == (best is None)
    if best is None or free.incumbent is None:
        return
    assert free.incumbent.cost == best.cost
    worst = max(lawful(tiny), key=lambda route: route_cost(tiny, route))
    bounded = prove(tiny, Incumbent(worst, route_cost(tiny, worst)), Deadline(10))
    assert bounded is not None
    assert bounded.incumbent is not None
    assert bounded.incumbent.cost == best.cost


@pytest.mark.slow
@examples(40)
@given(in_zones(), st.integers(1, 6))
def test_where_the_budget_ends_at_a_limit_what_is_proven_is_a_bound(tiny: Problem, ends_at: int) -> None:
    best = cheapest(tiny)
    if best is None:
        return
    worst = max(lawful(tiny), key=lambda route: route_cost(tiny, route))
    limits: list[int] = []

    def ends(problem: Problem, limit: int, *given: Any) -> Incumbent | None:
        limits.append(limit)
        if len(limits) == ends_at:
            raise TooLarge
        return sweep_through(problem, limit, *given)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(PROVING, "sweep_through", ends)
        proof = prove(tiny, Incumbent(worst, route_cost(tiny, worst)), Deadline(10), stages=(1.0,))
    assert limits == sorted(limits)
    if len(limits) < ends_at:
        assert proof is not None
        assert proof.incumbent is not None
        assert proof.incumbent.cost == best.cost
        assert proof.least is None
    elif proof is not None:
        assert proof.incumbent is None
        assert proof.least is not None
        assert 0 < proof.least <= best.cost


def rows(zones: int, contours: int, sites: int) -> Problem:
    """Zones from left to right, contours strewn in each."""
    bare, count = scattered(3, zones * contours, sites), zones * contours
    where = [[(x / 1000, y / 1000) for x, y in bare.pierce_um[list(bare.sites(i))].tolist()] for i in range(count)]
    ranked = [(i, j) for i in range(count) for j in range(count) if i // contours + 1 == j // contours]
    return problem(where, pairs=ranked)


def test_what_is_missed_is_not_looked_for_a_second_time() -> None:
    """The last of three zones cannot be left as cheaply as its bound says: the sweep of the first knows."""
    three = rows(3, 5, 2)
    best = prove(three, None, Deadline(10))
    assert best is not None
    assert best.incumbent is not None
    remembering_nothing = Deadline(0.0, most_bytes=0.0)  # and one round of walks
    ahead = look_ahead(three, best.incumbent.route, remembering_nothing)
    with ThreadPoolExecutor(1) as thread:
        budget = sweeping(Deadline(), 1.0)
        missed = missed_in(three, ahead, best.incumbent.route, best.incumbent.cost, budget, thread)
        with pytest.raises(TooLarge):
            missed_in(three, ahead, best.incumbent.route, best.incumbent.cost, sweeping(Deadline(), 0.0), thread)
        assert missed_in(three, ahead, best.incumbent.route, FAR, budget, thread) == [0, 0, 0]
    assert missed[0] == 0
    assert sum(missed) > 0
    assert ahead[0].bound.root + sum(missed) <= best.incumbent.cost


def test_bounds_that_take_more_than_there_is_are_left_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """They are not begun, and what is proven is the same as if they were."""
    three = rows(3, 5, 2)
    best = prove(three, None, Deadline(10))
    assert best is not None
    assert best.incumbent is not None
    completion = import_module("kerfwise.models.engines.bounds.completion")
    walk_on, rounds = completion.walk_on, []
    monkeypatch.setattr(PROVING, "priceable", lambda problem: False)  # linear programs have work of their own
    monkeypatch.setattr(completion, "walk_on", lambda *given: rounds.append(1) or walk_on(*given))

    def told(work: float, at_all: bool = False) -> tuple[Any, int]:
        rounds.clear()
        with monkeypatch.context() as patched:
            if at_all:
                patched.setattr(PROVING, "look_ahead", lambda *given: look_ahead(*given[:3]))
            return prove(three, best.incumbent, Deadline(work)), len(rounds)

    limits = [10 ** (-k / 2) for k in range(2, 17)]
    found, whatever = ([told(work, at_all) for work in limits] for at_all in (False, True))
    assert [proof for proof, _ in found] == [proof for proof, _ in whatever]
    assert [made for _, made in found] <= [made for _, made in whatever]
    assert found[0] == whatever[0]
    assert found[-1] == (None, 0)
    assert whatever[-1] == (None, 9)  # three stages of three zones


def in_two_halves(half: int) -> tuple[Problem, Incumbent]:
    """Contours of which one half is cut before the other, and a plan."""
    bare = scattered(5, 2 * half, 8)
    where = [[(x / 1000, y / 1000) for x, y in bare.pierce_um[list(bare.sites(i))].tolist()] for i in range(2 * half)]
    zoned = problem(where, pairs=[(a, b) for a in range(half) for b in range(half, 2 * half)])
    assert PROVING.priceable(zoned)
    route = tuple(int(s) for s in zoned.first[:-1])
    return zoned, Incumbent(route, route_cost(zoned, route))


@pytest.fixture
def rounds(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """Deterministic seconds of each round of a bound by walks from now on."""
    taken: list[float] = []
    back = completion._look_back

    def counted(n: int, additions: float, *tables: Any) -> None:
        taken.append(n * additions / completion.ADDITIONS_PER_S)
        back(n, additions, *tables)

    monkeypatch.setattr(completion, "_look_back", counted)
    return taken


@pytest.mark.parametrize("work", [1e-4, 1e-3, 1e-2])
def test_bounds_by_walks_take_no_more_than_the_limit(
    work: float, rounds: list[float], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Not even where a single round of all stretches takes longer, and linear programs come next."""
    zoned, plan = in_two_halves(20)
    monkeypatch.setattr(PROVING, "OVERDRAWN_S", 0.0)
    prove(zoned, plan, Deadline(work, most_bytes=1e9))
    assert sum(rounds) <= work


def test_the_round_of_a_sweep_backwards_counts(rounds: list[float]) -> None:
    """It is not begun where it takes more than the sweeps backwards have, and is part of what they took."""
    zoned, plan = in_two_halves(6)

    def spent(swept: float) -> tuple[int, list[float]]:
        rounds.clear()
        stretches = price(zoned, plan, Deadline(0.1, most_bytes=1e9), (), swept, 1.0)
        assert stretches is not None
        return len(rounds), [stretch.settled.work for stretch in stretches.stretches]

    forwards, nothing = spent(0.0)
    assert spent(1e-7) == (forwards, nothing)
    both, backwards = spent(1.0)
    assert both == forwards + 2
    assert min(backwards) > min(rounds) > 0
