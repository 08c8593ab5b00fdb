"""Zones move along a plan without them, and where its runs are no zones, along one that mixes neighbouring zones."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
import pytest

from kerfwise.arrays import Ints
from kerfwise.encoder.facts import FactOptions, Facts, compute_facts, zones
from kerfwise.encoder.facts.zones_along_route import zones_along
from kerfwise.encoder.readers import ReadOptions
from kerfwise.encoder.readers.json_nest import read_json
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.jobs import adaptive_zones
from kerfwise.jobs.adaptive_zones import Free, ZonedPlan, better_zones, planned_by_zones, without_neighbour_orders
from kerfwise.jobs.request import Request, facts_of, make_request, options_for
from kerfwise.models.engines.solution import Solution, SolveOptions, Status
from kerfwise.models.engines.solve import solve
from kerfwise.models.problem.precedence import transitive
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.profile.load import load_profile


def test_neighbours_may_be_mixed_and_no_others() -> None:
    """Six plates in a row, a mark on each: a zone for every plate."""
    plates = (
        part(str(k), rect(10 + 100 * k, 10, 80, 80), marks=[[(20 + 100 * k, 20), (40 + 100 * k, 20)]]) for k in range(6)
    )
    facts = compute_facts(nest(600, 100, *plates), FactOptions(zone_contours=1))
    index = facts.nest.index
    outer = [index[f"{k}.outer"] for k in range(6)]
    assert facts.zone[outer].tolist() == [1, 2, 3, 4, 5, 6]
    found = [
        (outer.index(s.before), outer.index(s.after)) for s in without_neighbour_orders(facts, frozenset({"some-rule"}))
    ]
    before = np.zeros((6, 6), dtype=np.bool_)
    before[tuple(np.transpose(found))] = True
    assert (transitive(before) == (np.arange(6)[:, None] + 2 <= np.arange(6))).all()
    assert (0, 4) not in found, "it follows from the others"


ROW = nest(600, 100, *(part(str(k), rect(10 + 100 * k, 10, 80, 80)) for k in range(6)))
"""Six plates in a row."""


def chosen(
    monkeypatch: pytest.MonkeyPatch, first: tuple[float, Status], others: Sequence[tuple[float, Status]], tries: int = 9
) -> tuple[ZonedPlan, list[float]]:
    """What becomes of a first plan of that cost where other zones, one more each time, make such plans; and the work
    that each of those was given. After so many `tries` somebody says stop."""
    profile = load_profile()
    facts = replace(facts_of(ROW, profile), zone=np.array([1, 1, 1, 2, 2, 2]))
    asked = make_request(facts, profile)
    left, works = list(others), list[float]()

    def by_zones(facts: Facts, profile: object, start: Solution, limits: SolveOptions, *_: object) -> object:
        works.append(limits.work)
        cost, status = left.pop(0)
        return Request(facts, asked.stated), replace(solution, objective=cost, status=status, seconds=1.0)

    def along(facts: Facts, order: Sequence[int]) -> Iterator[Ints]:
        yield from (np.minimum(np.arange(1, 7), count) for count in range(2, 2 + len(others)))

    solution = solve(asked.facts, asked.stated.statements, SolveOptions(work=1.0))
    solution = replace(solution, objective=first[0], status=first[1], seconds=2.0)
    free = Free(asked.stated, replace(solution, objective=90.0), 0.5)
    monkeypatch.setattr(adaptive_zones, "without_zones", lambda *given: free)
    monkeypatch.setattr(adaptive_zones, "zones_along", along)
    monkeypatch.setattr(adaptive_zones, "_by_zones", by_zones)
    limits = SolveOptions(work=10.0)
    return better_zones(asked, (), profile, solution, limits, progress=lambda *_: len(works) < tries), works


@pytest.mark.parametrize(
    ("first", "others", "cost", "elsewhere"),
    [
        ((100.0, "optimal"), [(95.0, "feasible"), (97.0, "optimal")], 95.0, 97.0),
        ((100.0, "optimal"), [(95.0, "feasible"), (96.0, "feasible")], 95.0, 100.0),
        ((100.0, "feasible"), [(95.0, "feasible"), (97.0, "feasible")], 95.0, None),
        ((100.0, "feasible"), [(101.0, "optimal"), (102.0, "optimal")], 100.0, 101.0),
        ((100.0, "optimal"), [(95.0, "feasible"), (95.0, "optimal")], 95.0, None),
        ((100.0, "optimal"), [(95.0, "optimal")], 95.0, None),
        ((100.0, "feasible"), [(100.0, "optimal")], 100.0, None),
    ],
)
def test_the_best_plan_is_taken_proven_or_not(
    first: tuple[float, Status],
    others: list[tuple[float, Status]],
    cost: float,
    elsewhere: float | None,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found, _ = chosen(monkeypatch, first, others)
    assert found.solution.objective == cost
    assert found.proven_elsewhere == elsewhere
    told = found.cost(SolveOptions(work=10.0))
    assert told is not None
    assert told.proven_elsewhere_mm == elsewhere
    proven = [status for other, status in (first, *others) if other == cost and status == "optimal"]
    assert (found.solution.status == "optimal") == bool(proven)


def test_what_the_first_plan_has_left_is_for_other_zones(monkeypatch: pytest.MonkeyPatch) -> None:
    _, works = chosen(monkeypatch, (100.0, "optimal"), [(95.0, "feasible"), (97.0, "optimal")])
    assert works == pytest.approx([adaptive_zones.A_TRY * 8.0, 7.0])


def test_tries_of_no_avail_are_counted_where_neighbouring_zones_are_mixed(monkeypatch: pytest.MonkeyPatch) -> None:
    profile = load_profile()
    asked = make_request(replace(facts_of(ROW, profile), zone=np.array([1, 1, 1, 2, 2, 2])), profile)
    solution = replace(solve(asked.facts, asked.stated.statements, SolveOptions(work=1.0)), seconds=2.0)
    routes = iter((solution.route, solution.route[::-1]))
    works: list[float] = []

    def without_zones(*given: object) -> Free:
        better = replace(solution, objective=solution.objective - 1.0, route=next(routes))
        return Free(asked.stated, better, 0.5)

    def by_zones(facts: Facts, profile: object, start: Solution, limits: SolveOptions, *_: object) -> None:
        works.append(limits.work)

    monkeypatch.setattr(adaptive_zones, "without_zones", without_zones)
    monkeypatch.setattr(adaptive_zones, "zones_along", lambda *_: iter(np.minimum(np.arange(1, 7), k) for k in (2, 3)))
    monkeypatch.setattr(adaptive_zones, "_by_zones", by_zones)
    better_zones(asked, (), profile, solution, SolveOptions(work=10.0))
    first = adaptive_zones.A_TRY * 8.0
    least = adaptive_zones.SHARE * 10.0
    assert works == pytest.approx([first, 8.0 - first, adaptive_zones.A_TRY * least, least])


@pytest.mark.parametrize("timed", [False, True])
def test_a_plan_by_other_zones_says_all_that_it_took(timed: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    profile = load_profile()
    asked = make_request(replace(facts_of(ROW, profile), zone=np.array([1, 1, 1, 2, 2, 2])), profile)
    solution = replace(solve(asked.facts, asked.stated.statements, SolveOptions(work=1.0)), seconds=2.0)
    routes, costs, clock = iter((solution.route, solution.route[::-1])), iter((1.0, -1.0)), [100.0]

    def without_zones(*given: object) -> Free:
        clock[0] += 0.75
        better = replace(solution, objective=solution.objective - 2.0, route=next(routes))
        return Free(asked.stated, better, 0.5)

    def by_zones(facts: Facts, profile: object, start: Solution, limits: SolveOptions, *_: object) -> object:
        clock[0] += 1.5
        return Request(facts, asked.stated), replace(solution, objective=solution.objective + next(costs), seconds=1.0)

    monkeypatch.setattr(adaptive_zones, "without_zones", without_zones)
    monkeypatch.setattr(adaptive_zones, "running_s", lambda: clock[0])
    monkeypatch.setattr(adaptive_zones, "running_s", lambda: clock[0])
    monkeypatch.setattr(adaptive_zones, "zones_along", lambda *_: iter([np.minimum(np.arange(1, 7), 2)]))
    monkeypatch.setattr(adaptive_zones, "_by_zones", by_zones)
    limits = SolveOptions(time_s=10.0) if timed else SolveOptions(work=10.0)
    moved = better_zones(asked, (), profile, solution, limits, 108.0 if timed else None).solution
    assert moved.objective == solution.objective - 1.0
    assert moved.seconds == (2.0 + 2 * 0.75 + 2 * 1.5 if timed else 2.0 + 2 * 0.5 + 2 * 1.0)


@pytest.mark.parametrize("tries", [0, 1])
def test_told_to_stop_it_tries_no_more_zones(tries: int, monkeypatch: pytest.MonkeyPatch) -> None:
    found, works = chosen(monkeypatch, (100.0, "optimal"), [(95.0, "feasible"), (97.0, "optimal")], tries)
    assert len(works) == tries
    assert found.solution.objective == (100.0, 95.0)[tries]


def test_zones_that_the_other_plan_does_not_keep_to_and_no_proof_applies_to_are_passed_over(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    profile = load_profile()
    lag = profile.rules["heat-lag"]
    two_cuts = replace(lag, options=replace(lag.options, lag_cuts=2))  # type: ignore[type-var]
    profile = replace(profile, rules={**profile.rules, "heat-lag": two_cuts})
    asked = make_request(replace(facts_of(ROW, profile), zone=np.array([1, 1, 1, 2, 2, 2])), profile)
    solution = solve(asked.facts, asked.stated.statements, SolveOptions(work=0.2))
    free = Free(asked.stated, replace(solution, objective=solution.objective - 1.0), 0.5)
    monkeypatch.setattr(adaptive_zones, "without_zones", lambda *given: free)
    monkeypatch.setattr(adaptive_zones, "zones_along", lambda *given: iter([np.array([1, 2, 1, 2, 1, 2])]))
    assert better_zones(asked, (), profile, solution, SolveOptions(work=1.0)).solution is solution


@pytest.mark.slow
def test_where_runs_are_no_zones_neighbouring_zones_are_mixed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(zones, "MOST_OF_ONE", 100)
    profile = load_profile()
    off = replace(profile.rules["no-tip-travel"], strength="off", weight=None)
    profile = replace(profile, rules={**profile.rules, "no-tip-travel": off})
    sheet = read_json(json.dumps(make_sheet(2, 40)).encode(), ReadOptions())
    asked, limits = make_request(facts_of(sheet, profile), profile), options_for(sheet, profile, work=5.0)
    orders: list[Sequence[int]] = []

    def none_at_first(facts: Facts, order: Sequence[int]) -> Iterator[Ints]:
        orders.append(order)
        yield from () if len(orders) == 1 else zones_along(facts, order)

    monkeypatch.setattr(adaptive_zones, "zones_along", none_at_first)
    found = planned_by_zones(asked, profile, limits)
    by, moved = found.asked, found.solution
    assert found.free is not None
    assert len(orders) == 2
    place = {k: at for at, k in enumerate(orders[1])}
    for statement in without_neighbour_orders(asked.facts, frozenset({"zone-order"})):
        assert place[statement.before] < place[statement.after]
    assert moved.status == "optimal"
    assert (by.facts.zone != asked.facts.zone).any()
