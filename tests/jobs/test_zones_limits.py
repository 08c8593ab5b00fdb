"""How long plans without zones, and by other zones, may take: within what is documented, and not begun in vain."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import count
from pathlib import Path

import numpy as np
import pytest

from kerfwise import pipeline
from kerfwise.arrays import Ints
from kerfwise.benchmarks.plates import planned_by_zones
from kerfwise.encoder.facts import zones, zones_along_route
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.readers import ReadOptions
from kerfwise.encoder.readers.json_nest import read_json
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.jobs import adaptive_zones, plan_without_zones
from kerfwise.jobs.adaptive_zones import better_zones
from kerfwise.jobs.plan_without_zones import Free, is_look_worthwhile, look_for
from kerfwise.jobs.request import Request, facts_of, make_request, options_for
from kerfwise.models.engines.solution import Solution, SolveOptions
from kerfwise.models.engines.solve import solve
from kerfwise.models.engines.tuning import LARGE_NEST as FEW
from kerfwise.models.engines.tuning import MOST_CONTOURS
from kerfwise.pipeline import solve_and_verify
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.tests.tools.amount import rows

ROW = nest(600, 100, *(part(str(k), rect(10 + 100 * k, 10, 80, 80)) for k in range(6)))
"""Six plates in a row."""
MOST_TIMES = 1.8
"""Of the work, as docs/limits.md says."""


def planned(seconds: float, status: str = "optimal") -> Solution:
    return Solution((0,), 100.0, None, status, "ideals", "ideals", seconds)  # type: ignore[arg-type]


def test_few_contours_have_their_share_whatever_the_first_plan_took() -> None:
    for first in (0.1, 5.0, 10.0):
        found = look_for(1000, SolveOptions(work=10.0), None, planned(first))
        assert found is not None
        assert found.work == pytest.approx(plan_without_zones.SHARE * 10.0)
        assert is_look_worthwhile(FEW, SolveOptions(work=0.01))


def test_many_contours_have_what_two_proofs_leave() -> None:
    found = look_for(10_000, SolveOptions(work=10.0), None, planned(1.0))
    assert found is not None
    assert found.work == pytest.approx(10.0 - 1.0 - plan_without_zones.PROOF * 1.0)
    slow = look_for(10_000, SolveOptions(work=10.0), None, planned(6.0))
    assert slow is not None
    assert slow.work == pytest.approx(2.0), "half of what is left"


def test_what_cannot_get_anywhere_is_not_begun() -> None:
    assert not is_look_worthwhile(10_000, SolveOptions(work=0.1))
    assert not is_look_worthwhile(3000, SolveOptions(work=0.1))
    assert not is_look_worthwhile(10_000, SolveOptions(time_s=20.0))
    assert not is_look_worthwhile(MOST_CONTOURS + 1, SolveOptions(work=1000.0))
    assert is_look_worthwhile(10_000, SolveOptions(work=10.0))
    assert is_look_worthwhile(10_000, SolveOptions(time_s=300.0))
    assert look_for(10_000, SolveOptions(work=3.0), None, planned(3.0)) is None


def test_a_limit_in_seconds_keeps_what_other_zones_take(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(plan_without_zones, "running_s", lambda: 1000.0)
    limits = SolveOptions(time_s=300.0)
    found = look_for(10_000, limits, 1200.0, planned(20.0))
    assert found is not None
    assert found.time_s == pytest.approx(200.0 - plan_without_zones.PROOF * 20.0)
    assert look_for(10_000, limits, 1015.0, planned(100.0)) is None
    slow = look_for(10_000, limits, 1100.0, planned(100.0), 20.0)
    assert slow is not None
    beside_s = plan_without_zones.STATED * 20.0 + plan_without_zones.PROVEN_S * 10_000
    assert slow.time_s == pytest.approx(100.0 - beside_s)
    in_vain = look_for(10_000, limits, 1050.0, planned(100.0), 20.0)
    assert in_vain is not None
    assert in_vain.time_s == pytest.approx(25.0), "zones have no time to move, but the plan says what they cost"


@pytest.fixture
def _all_are_many(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (adaptive_zones, plan_without_zones, pipeline):
        monkeypatch.setattr(module, "FEW", 3)


@pytest.mark.usefixtures("_all_are_many")
@pytest.mark.parametrize("first", [0.5, 3.0, 6.0, 9.9, 10.0])
@pytest.mark.parametrize("found", [True, False])
def test_all_together_keep_to_what_is_documented(first: float, found: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whoever looks spends all that it is given: the work comes to no more than docs/limits.md says."""
    profile, spent = load_profile(), [first]
    asked = make_request(replace(facts_of(ROW, profile), zone=np.array([1, 1, 1, 2, 2, 2])), profile)
    solution = replace(solve(asked.facts, asked.stated.statements, SolveOptions(work=1.0)), seconds=first)
    routes = iter((solution.route, solution.route[::-1]))

    def without_zones(*given: SolveOptions) -> Free:
        spent.append(given[4].work)
        better = replace(solution, objective=solution.objective - 1.0, route=next(routes))
        return Free(asked.stated, better, given[4].work)

    def by_zones(facts: Facts, profile: object, start: Solution, limits: SolveOptions, *_: object) -> object:
        spent.append(limits.work)
        worse = replace(solution, objective=solution.objective + 1.0, seconds=limits.work, status="feasible")
        return (Request(facts, asked.stated), worse) if found else None

    def along(facts: Facts, order: Sequence[int], *, any_shape: bool = False) -> Iterator[Ints]:
        yield from (np.minimum(np.arange(1, 7), k) for k in count(2))

    monkeypatch.setattr(adaptive_zones, "without_zones", without_zones)
    monkeypatch.setattr(adaptive_zones, "zones_along", along)
    monkeypatch.setattr(adaptive_zones, "_by_zones", by_zones)
    best = better_zones(asked, (), profile, solution, SolveOptions(work=10.0)).solution  # type: ignore[arg-type]
    assert best is solution
    assert len(spent) == 6, "the plan, a look, two tries, zones of any shape, and a single one"
    assert sum(spent) <= MOST_TIMES * 10.0


@pytest.mark.usefixtures("_all_are_many")
@pytest.mark.parametrize("first", [0.5, 6.0, 9.9])
def test_a_plan_by_other_zones_says_what_it_took(first: float, monkeypatch: pytest.MonkeyPatch) -> None:
    profile, spent = load_profile(), [first]
    asked = make_request(replace(facts_of(ROW, profile), zone=np.array([1, 1, 1, 2, 2, 2])), profile)
    solution = replace(solve(asked.facts, asked.stated.statements, SolveOptions(work=1.0)), seconds=first)

    def without_zones(*given: SolveOptions) -> Free:
        spent.append(given[4].work)
        return Free(asked.stated, replace(solution, objective=solution.objective - 2.0), given[4].work)

    def by_zones(facts: Facts, profile: object, start: Solution, limits: SolveOptions, *_: object) -> object:
        spent.append(0.5 * limits.work)
        return Request(facts, asked.stated), replace(solution, objective=solution.objective - 2.0, seconds=spent[-1])

    monkeypatch.setattr(adaptive_zones, "without_zones", without_zones)
    monkeypatch.setattr(adaptive_zones, "zones_along", lambda *_, **__: iter([np.minimum(np.arange(1, 7), 2)]))
    monkeypatch.setattr(adaptive_zones, "_by_zones", by_zones)
    best = better_zones(asked, (), profile, solution, SolveOptions(work=10.0)).solution  # type: ignore[arg-type]
    assert best.seconds == pytest.approx(sum(spent))
    assert len(spent) == 3


def zoned(contours: int) -> Profile:
    profile = load_profile()
    rule = profile.rules["zone-order"]
    changed = replace(rule, options=replace(rule.options, zone_contours=contours))
    return replace(profile, rules={**profile.rules, "zone-order": changed})


@pytest.mark.slow
@pytest.mark.usefixtures("_all_are_many")
@pytest.mark.parametrize(("work", "told"), [(1e-4, False), (1.0, True)])
def test_with_little_work_nothing_is_looked_for(work: float, told: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    looked: list[int] = []
    plain = adaptive_zones.without_zones

    def without_zones(*given: object, **named: object) -> Free | None:
        looked.append(1)
        return plain(*given, **named)  # type: ignore[arg-type]

    monkeypatch.setattr(adaptive_zones, "without_zones", without_zones)
    profile = zoned(2)
    asked = make_request(facts_of(ROW, profile), profile)
    made = solve_and_verify(asked, profile, options_for(ROW, profile, work=work), move_zones=True)
    assert made.verdict.ok
    assert bool(looked) == told
    assert (made.plan.zones_cost is not None) == told
    assert bool(planned_by_zones(asked, profile, options_for(ROW, profile, work=work)).free) == told


@pytest.mark.slow
@pytest.mark.usefixtures("_all_are_many")
@pytest.mark.parametrize(("contours", "work"), rows([(30, 2.0), (40, 5.0)]))
def test_zones_of_many_contours_move_and_the_check_agrees(
    contours: int, work: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Statements are taken over, a part that is gone back to is cut where it is cut last, and all is judged."""
    monkeypatch.setattr(zones, "MOST_OF_ONE", 100)
    monkeypatch.setattr(zones_along_route, "MIDDLES", 0)
    sheet, profile = read_json(json.dumps(make_sheet(2, contours)).encode(), ReadOptions()), load_profile()
    asked, limits = make_request(facts_of(sheet, profile), profile), options_for(sheet, profile, work=work)
    stayed, moved = (solve_and_verify(asked, profile, limits, move_zones=also) for also in (False, True))
    assert moved.facts.zone.tolist() != stayed.facts.zone.tolist()
    assert moved.plan.solve.objective < stayed.plan.solve.objective
    assert moved.plan.solve.status == "optimal"
    assert moved.plan.zones_cost is not None
    assert moved.verdict.ok
    if contours == 40:
        again = solve_and_verify(asked, profile, limits, move_zones=True)
        assert moved.plan.to_json() == again.plan.to_json()


def test_the_pages_on_zones_and_on_limits_tell_them() -> None:
    root = Path(__file__).parents[2]
    texts = ((root / page).read_text(encoding="utf-8") for page in ("docs/limits.md", "docs/scale.md"))
    page, scale = (" ".join(text.split()) for text in texts)
    assert f"With more than {FEW} contours, that look has what two proofs leave" in page
    assert f"{MOST_TIMES} times the work at the most" in page
    assert f"beyond {MOST_CONTOURS:,} contours" in scale
    assert plan_without_zones.MOST_CONTOURS == MOST_CONTOURS
