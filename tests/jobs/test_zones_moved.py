"""Zones move along a plan without them, and where its runs are no zones, along one that mixes neighbouring zones."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from kerfwise.arrays import Ints
from kerfwise.benchmarks.plates import planned_by_zones
from kerfwise.encoder.facts import Facts, zones
from kerfwise.encoder.readers import ReadOptions
from kerfwise.encoder.readers.json_nest import read_json
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.jobs import adaptive_zones
from kerfwise.jobs.adaptive_zones import Free, ZonedPlan, better_zones
from kerfwise.jobs.request import Request, facts_of, make_request, options_for
from kerfwise.models.engines.solution import Solution, SolveOptions, Status
from kerfwise.models.engines.solve import solve
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.statements import EXEMPTION_MM

MORE = [(32, 115), (43, 115), (2, 60), (5, 41)]
"""Seeds and contours of plates for a longer run."""
ROW = nest(600, 100, *(part(str(k), rect(10 + 100 * k, 10, 80, 80)) for k in range(6)))
"""Six plates in a row."""


def chosen(
    monkeypatch: pytest.MonkeyPatch,
    first: tuple[float, Status],
    others: Sequence[tuple[float, Status]],
    free_mm: float = 90.0,
    work: float = 0.1,
    shaped: int = 9,
) -> tuple[ZonedPlan, list[tuple[int, float]]]:
    """What becomes of a first plan of that cost where one without zones costs `free_mm`, and other zones, one more
    each time, make such plans; `shaped` of them do what zones are for. And which were tried, with how much work."""
    profile = load_profile()
    facts = replace(facts_of(ROW, profile), zone=np.array([1, 1, 1, 2, 2, 2]))
    asked = make_request(facts, profile)
    left, tried = list(others), list[tuple[int, float]]()

    def by_zones(facts: Facts, profile: object, start: Solution, limits: SolveOptions, *_: object) -> object:
        tried.append((int(facts.zone.max()), limits.work))
        cost, status = left.pop(0) if left else (free_mm, "feasible")
        return Request(facts, asked.stated), replace(solution, objective=cost, status=status, seconds=0.01)

    def along(facts: Facts, order: Sequence[int], *, any_shape: bool = False) -> Iterator[Ints]:
        yield from (np.minimum(np.arange(1, 7), count) for count in ((9,) if any_shape else range(2, 2 + shaped)))

    solution = solve(asked.facts, asked.stated.statements, SolveOptions(work=1.0))
    solution = replace(solution, objective=first[0], status=first[1], seconds=2.0)
    free = Free(asked.stated, replace(solution, objective=free_mm), 0.02)
    monkeypatch.setattr(adaptive_zones, "searched", lambda *given, **_: free)
    monkeypatch.setattr(adaptive_zones, "zones_along", along)
    monkeypatch.setattr(adaptive_zones, "_by_zones", by_zones)
    return better_zones(asked, (), profile, solution, SolveOptions(work=work)), tried


@pytest.mark.parametrize(
    ("first", "others", "cost", "elsewhere"),
    [
        ((100.0, "optimal"), [(90.0, "feasible"), (97.0, "optimal")], 90.0, 97.0),
        ((100.0, "optimal"), [(90.0, "feasible"), (96.0, "feasible")], 90.0, 100.0),
        ((100.0, "feasible"), [(90.0, "feasible"), (97.0, "feasible")], 90.0, None),
        ((100.0, "optimal"), [(89.0, "feasible"), (89.0, "optimal")], 89.0, None),
        ((100.0, "optimal"), [(90.0, "optimal")], 90.0, None),
        ((90.0, "feasible"), [(90.0, "optimal")], 90.0, None),
        ((80.0, "optimal"), [(90.0, "optimal")], 80.0, None),
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


def test_where_zones_cost_more_others_and_a_single_one_are_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    found, tried = chosen(monkeypatch, (100.0, "optimal"), [(95.0, "optimal"), (95.0, "optimal"), (93.0, "optimal")])
    assert [zones for zones, _ in tried] == [2, 3, 6, 1]
    assert found.solution.objective == 90.0
    assert found.asked.facts.zone.max() == 1
    assert "the whole sheet is one" in " ".join(found.solution.notes)
    cost = found.cost(SolveOptions(work=10.0))
    assert cost is not None
    assert (cost.mm, cost.proven_elsewhere_mm) == (0.0, 93.0)
    found, tried = chosen(monkeypatch, (100.0, "optimal"), [(90.0, "optimal")], shaped=0)
    assert [zones for zones, _ in tried] == [6], "no zones do what zones are for"
    assert found.solution.objective == 90.0


def test_up_to_each_rung_all_is_done_as_under_larger_limits(monkeypatch: pytest.MonkeyPatch) -> None:
    dear: list[tuple[float, Status]] = [(95.0, "feasible")] * 40
    tried = {work: chosen(monkeypatch, (100.0, "optimal"), dear, work=work)[1] for work in (0.1, 0.3, 1.0, 3.0)}
    for less, more in pairwise(tried.values()):
        assert more[: len(less)] == less
        assert len(more) > len(less)


def test_told_to_stop_it_tries_no_more_zones() -> None:
    profile = load_profile()
    asked = make_request(replace(facts_of(ROW, profile), zone=np.array([1, 1, 1, 2, 2, 2])), profile)
    solution = solve(asked.facts, asked.stated.statements, SolveOptions(work=1.0))
    found = better_zones(asked, (), profile, solution, SolveOptions(work=10.0), progress=lambda *_: False)
    assert found.solution is solution
    assert found.free is None


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
    monkeypatch.setattr(adaptive_zones, "searched", lambda *given, **_: free)
    monkeypatch.setattr(adaptive_zones, "zones_along", lambda *given, **_: iter([np.array([1, 2, 1, 2, 1, 2])]))
    assert better_zones(asked, (), profile, solution, SolveOptions(work=1.0)).solution is solution


@pytest.mark.parametrize(
    ("seed", "contours", "works"),
    [(3, 24, (0.1, 0.3, 1.0)), *(pytest.param(s, n, (0.1, 0.3, 1.0, 3.0), marks=pytest.mark.full) for s, n in MORE)],
)
def test_more_work_makes_no_dearer_plan(
    seed: int, contours: int, works: tuple[float, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """And the plan costs no more than the best one that it knows without zones, where that pays for the same."""
    if contours < 100:
        monkeypatch.setattr(zones, "MOST_OF_ONE", 10)
        monkeypatch.setattr(adaptive_zones, "GEOMETRY", 0)
    profile = load_profile()
    sheet = read_json(json.dumps(make_sheet(seed, contours)).encode(), ReadOptions())
    asked = make_request(facts_of(sheet, profile), profile)
    assert asked.facts.zone.max() > 1
    costs = []
    for work in works:
        found = planned_by_zones(asked, profile, options_for(sheet, profile, work=work))
        costs.append(found.solution.objective)
        assert found.free is not None
        assert not found.free.dearer(found.asked, found.solution, options_for(sheet, profile))
    assert costs == sorted(costs, reverse=True)


def test_a_plan_that_does_not_pay_for_its_moves_over_parts_is_no_cheaper_for_it() -> None:
    """A clock may leave such moves unpriced in the one and not in the other, which is proven."""
    profile = load_profile()
    asked = make_request(facts_of(ROW, profile), profile)
    paying = solve(asked.facts, asked.stated.statements, SolveOptions(work=1.0))
    ways = sorted(range(len(asked.facts.candidates)), key=lambda c: asked.facts.candidates[c].pierce[1])
    low, high = ({asked.facts.candidates[c].contour: c for c in order} for order in (ways[::-1], ways))
    over = (*(low[k] for k in (1, 2, 3, 4, 5)), high[0])  # from the last plate back over those that are out
    left_out = (("no-tip-travel", "the clock"),)
    bare = replace(paying, route=over, objective=paying.objective - 1, status="feasible", left_out=left_out)
    free = Free(asked.stated, paying, 0.02)
    best = adaptive_zones._best([(asked, bare), (asked, paying)], free)
    assert (paying.status, best.solution, best.proven_elsewhere) == ("optimal", paying, None)
    assert adaptive_zones._best([(asked, bare)], free).solution is bare


def along_unpriced(monkeypatch: pytest.MonkeyPatch, known_mm: float, zones: Sequence[Sequence[int]]) -> list[list[int]]:
    """Which of these zones are tried along the best plan of the row, where that does not pay for its moves."""
    profile = load_profile()
    asked = make_request(facts_of(ROW, profile), profile)
    solution = solve(asked.facts, asked.stated.statements, SolveOptions(work=1.0))
    free, tried = Free(asked.stated, solution, 0.02, ("no-tip-travel",)), list[list[int]]()
    dearer = replace(solution, objective=9e4, status="optimal", route=solution.route[1::2] + solution.route[::2])
    of = np.array([asked.facts.candidates[c].contour for c in solution.route]).argsort()

    def along(facts: Facts, order: object, *, any_shape: bool = False) -> Iterator[Ints]:
        yield from (np.array(zone)[of] for zone in ([] if any_shape else zones))

    def by_zones(facts: Facts, *_: object) -> object:
        tried.append(facts.zone[of.argsort()].tolist())
        return Request(facts, asked.stated), dearer

    monkeypatch.setattr(adaptive_zones, "zones_along", along)
    monkeypatch.setattr(adaptive_zones, "_by_zones", by_zones)
    limits = SolveOptions(work=9.0)
    account = adaptive_zones.Account(0.0, lambda spent: limits)
    known_mm *= solution.objective % EXEMPTION_MM
    list(adaptive_zones.plans_along(asked, profile, free, account, limits, known_mm=known_mm))
    return tried


def test_zones_that_break_a_plan_too_much_or_no_less_than_proven_ones_are_passed_over(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    kept, broken = [1, 1, 1, 2, 2, 2], [1, 2, 1, 2, 1, 2]
    assert along_unpriced(monkeypatch, 1.0, [broken, kept]) == [kept], "no proof makes good what that breaks"
    assert along_unpriced(monkeypatch, 9.0, [broken, kept]) == [broken, kept]
    assert along_unpriced(monkeypatch, 9.0, [kept, broken]) == [kept]
    assert along_unpriced(monkeypatch, 9.0, [kept, [1, 1, 2, 2, 2, 2]]) == [kept], "neither breaks it"
