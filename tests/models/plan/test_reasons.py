"""Why the cuts of a plan are where they are: true by counterfactual, and what the objective is made of."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import pytest

from kerfwise.encoder.facts.facts import Facts
from kerfwise.jobs.request import facts_of, make_request, options_for
from kerfwise.models.engines.solve import solve
from kerfwise.models.plan.explain.context import PlanContext, solved_context
from kerfwise.models.plan.explain.other_places import MATTERS_UM, OtherPlace, OtherPlaces
from kerfwise.models.plan.explain.reasons import with_reasons
from kerfwise.models.plan.make_plan import make_plan
from kerfwise.models.plan.plan import Plan
from kerfwise.models.plan.read_plan import plan_in, validator
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.pipeline import solve_and_verify
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.registry import RULES
from kerfwise.rules.statements import About, AtLeast, Before, Contiguous, Lag, Precede, Statement
from kerfwise.rules.stating.state_rules import Stated
from kerfwise.tests.models.plan.test_reader import TEXT
from kerfwise.tests.models.solved import plant, proven_plan
from kerfwise.tests.reasons.judge import Judge, Verdict, kind

PLATE = nest(400, 100, *(part(f"P{k}", rect(100 * k - 90, 10, 80, 80)) for k in (1, 2, 3)))
CORNERS = [(10, 10), (150, 30), (320, 10), (300, 160), (120, 170)]
RING = nest(420, 270, *(part(f"P{k}", rect(x, y, 80, 80)) for k, (x, y) in enumerate(CORNERS, 1)))
NOTHING = plant(off=tuple(load_profile().settings()))


def planned(profile: Profile, *further: Statement, on: object = RING) -> tuple[Facts, PlanContext, Plan]:
    """The best plan of the row of parts, with its reasons."""
    facts = facts_of(on, profile)  # type: ignore[arg-type]
    stated = make_request(facts, profile).stated
    stated = replace(stated, statements=(*stated.statements, *further))
    solution = solve(facts, stated.statements, options_for(facts.nest, profile, work=2.0))
    assert solution.status == "optimal"
    setting = solved_context(facts, profile, stated, solution)
    return facts, setting, with_reasons(make_plan(facts, profile, stated, solution, "portfolio", 1), setting)


def verdicts(setting: PlanContext, plan: Plan) -> list[Verdict]:
    facts = setting.facts
    judge = Judge(facts, setting.stated.statements, setting.candidates, setting.profile.home_on(facts.nest))
    return [v for cut in plan.cuts for v in judge.verdicts(facts.nest.index[cut.cut.contour], cut.because)]


def of(plan: Plan, contour: str) -> str:
    return next(cut.because[0] for cut in plan.cuts if cut.cut.contour == contour)


def own(rule: str, *names: str) -> About:
    return About(f"own:{rule}", names, f"{rule} wants it of {' and '.join(names)}")


def test_an_order_that_travel_would_keep_anyway_is_no_reason() -> None:
    _, _, plan = proven_plan(PLATE, plant())
    assert [p.cut.contour for p in plan.cuts] == ["P1.outer", "P2.outer", "P3.outer"]
    x, y = plan.cuts[1].cut.entry
    assert plan.cuts[1].because == (
        "no rule decides where P2.outer is cut: with these entries no other place, nor a stretch turned round, makes "
        "the plan cheaper, not even against a rule",
        f"entered at ({x:.1f}, {y:.1f}): the shortest lawful way from P1.outer to P3.outer",
    )


def test_once_time_is_over_no_reason_is_told_that_was_not_worked_out() -> None:
    """Each cut has the reason that it has with all the time there is, or the order that it keeps."""
    _, setting, plan = planned(plant())
    ways = ("entered at ", "kept: ", "what decides where ")
    for much in (0, 1, 5, 9, 14, 10_000):
        left = iter([True] * much)
        short = with_reasons(plan_without(plan), setting, lambda left=left: next(left, False))
        told = [(cut.because, whole.because) for cut, whole in zip(short.cuts, plan.cuts, strict=True)]
        assert all(because == whole or because[0].startswith(ways[1:]) for because, whole in told)
        assert all(because != whole for because, whole in told) == (much < 5)
    assert all(because == whole for because, whole in told)


def plan_without(plan: Plan) -> Plan:
    """The plan before reasons are told."""
    entered = [next(k for k, text in enumerate(cut.because) if text.startswith("entered at ")) for cut in plan.cuts]
    return plan.with_items([replace(c, because=c.because[k:]) for c, k in zip(plan.cuts, entered, strict=True)])


def test_only_where_nothing_is_asked_travel_alone_decides() -> None:
    _facts, setting, plan = planned(NOTHING)
    told = of(plan, "P3.outer")
    assert told.startswith("no rule asks anything of where P3.outer is cut, and every other place is longer, by ")
    assert told.endswith(" mm at least: it is cut here for the shortest travel")
    assert {kind(v.sentence) for v in verdicts(setting, plan)} == {"for the travel", "shortest entry"}
    assert not [v for v in verdicts(setting, plan) if v.wrong]


@pytest.mark.parametrize("price_mm", [None, 900.0])
@pytest.mark.parametrize("what", ["order", "sum", "run", "lag"])
def test_each_kind_of_statement_is_named_where_it_decides(what: str, price_mm: float | None) -> None:
    about, again = own(what, "P3.outer", "P2.outer"), own(what, "P3.outer", "P4.outer")
    asked: dict[str, list[Statement]] = {
        "order": [Precede(2, 1, about, price_mm), Precede(2, 3, again, price_mm)],
        "sum": [AtLeast((Before(2, 1), Before(2, 3)), (1, 1), 2, about, None, price_mm)],
        "run": [Contiguous((0, 2), about, price_mm)],
        "lag": [Lag(2, 1, about, cuts=1, weight=price_mm), Lag(2, 3, again, cuts=1, weight=price_mm)],
    }
    _facts, setting, plan = planned(NOTHING, *asked[what])
    said = " ".join(because for cut in plan.cuts for because in cut.because)
    assert about.sentence in said or again.sentence in said
    told = verdicts(setting, plan)
    assert len(told) >= len(plan.cuts)
    assert [v for v in told if v.wrong] == []


def test_a_soft_rule_is_named_and_what_is_broken_has_its_price() -> None:
    cheap = own("kit", "P1.outer", "P3.outer")
    _facts, _setting, plan = planned(NOTHING, Contiguous((0, 2), cheap, 2.0))
    assert plan.prices is not None
    assert plan.prices.breaches == (("own:kit", ("P1.outer", "P3.outer"), cheap.sentence, 2.0),)
    assert plan.prices.travel_mm + 2.0 == pytest.approx(plan.solve.objective)
    assert plan_in(plan.to_json()).prices == plan.prices
    assert not any("own:kit" in because for cut in plan.cuts for because in cut.because)


@pytest.mark.parametrize("profile", ["plasma-carbon-steel", "oxyfuel-thick-plate", "laser-wood"])
def test_the_prices_sum_to_the_objective(profile: str) -> None:
    plate = nest(
        520,
        220,
        *(part(f"P{k}", rect(100 * k - 90, 10, 80, 80), [rect(100 * k - 60, 40, 20, 20)]) for k in (1, 2, 3)),
        *(part(f"Q{k}", rect(100 * k - 90, 110, 80, 80)) for k in (1, 2, 3)),
    )
    given = load_profile(profile)
    asked = make_request(facts_of(plate, given), given)
    made = solve_and_verify(asked, given, options_for(plate, given, work=0.5))
    prices = made.plan.prices
    assert prices is not None
    total = prices.travel_mm + sum(mm for _, _, _, mm in prices.breaches)
    assert total == pytest.approx(made.plan.solve.objective, abs=0.01)
    assert prices.by_rule


def test_the_judge_finds_a_false_reason() -> None:
    """The comparison can fail: reasons of another plan, and travel where a rule decides."""
    order = AtLeast((Before(2, 1), Before(2, 3)), (1, 1), 2, own("order", "P3.outer"))
    facts, setting, _ = planned(NOTHING, order)
    judge = Judge(facts, setting.stated.statements, setting.candidates, (0.0, 0.0))
    travel = "no rule asks anything of where P3.outer is cut, …: it is cut here for the shortest travel"
    none = "no rule decides where P3.outer is cut: with these entries no other place makes the plan cheaper"
    assert [v.wrong for v in judge.verdicts(2, [travel])] != [""]
    assert [v.wrong for v in judge.verdicts(2, [none])] != [""]
    free, setting, _plan = planned(NOTHING)
    idle = AtLeast((Before(0, 4),), (1,), 1, own("idle", "P1.outer", "P5.outer"))
    judge = Judge(free, (*setting.stated.statements, idle), setting.candidates, (0.0, 0.0))
    assert [v.wrong for v in judge.verdicts(0, [idle.about.sentence])] == ["no other place costs less without it"]


@pytest.mark.parametrize("seed", range(3))
def test_every_other_place_costs_what_the_plain_reference_says(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    profile = load_profile()
    plate = nest(
        420,
        320,
        *(
            part(
                f"P{3 * i + j}",
                rect(130 * i + 10, 100 * j + 10, 90 + 7 * seed, 80),
                [rect(130 * i + 40, 100 * j + 35, 25, 25)],
            )
            for i in range(3)
            for j in range(3)
        ),
    )
    facts = facts_of(plate, profile)
    stated = make_request(facts, profile).stated
    wish = Contiguous((1, 5, 9), own("kit", *(facts.nest.contours[k].id for k in (1, 5, 9))), 40.0)
    lag = Lag(1, 9, own("wait", *(facts.nest.contours[k].id for k in (1, 9))), cuts=3, weight=11.0)
    stated = Stated((*stated.statements, wish, lag), (), ())
    solution = solve(facts, stated.statements, options_for(plate, profile, work=0.05))
    setting = solved_context(facts, profile, stated, solution)
    places = OtherPlaces(setting)
    tried = 0
    for contour in setting.order:
        every = list(places.of(contour, every=True))
        assert named(places.of(contour)) == named(every)
        for place in every[seed::3]:
            route = [int(places.site[c]) for c in place.order]
            wrong = broken(setting.problem, route)
            assert bool(wrong) == bool(place.hard)
            if not wrong:  # of unlawful moves the problem does not know what they cross
                assert route_cost(setting.problem, route) - setting.cost == place.more_um
            tried += 1
    assert tried > 80
    turned = [place for _, place in places.turned()]
    monkeypatch.setattr(places._paid, "by_turned", lambda units, _: [1 << 60] * len(units))
    assert turned == [place for _, place in places.turned()] != []


def named(places: Iterable[OtherPlace]) -> list[OtherPlace]:
    """Those that would make the plan cheaper if what they break did not count."""
    return [place for place in places if place.more_um - sum(um for _, um in place.soft) < -MATTERS_UM]


def test_own_rules_and_model_files_are_named(tmp_path: Path) -> None:
    (tmp_path / "late.mzn").write_text(
        "% late: heavy parts come last\n% Crane.\n"
        'array[int] of var bool: late_holds = [before(i, j) | i, j in CONTOUR where contour_id[i] = "P3.outer" '
        '/\\ contour_id[j] = "P2.outer"];\n'
        'array[int] of string: late_says = [contour_id[i] ++ " before " ++ contour_id[j] | i, j in CONTOUR where '
        'contour_id[i] = "P3.outer" /\\ contour_id[j] = "P2.outer"];\n',
        encoding="utf-8",
    )
    off = "\n".join(f"  {name}: off" for name, rule in RULES.items() if "off" in rule.strengths)
    (tmp_path / "p.yaml").write_text(
        f"based_on: plasma-carbon-steel\nmodels: [late.mzn]\nrules:\n{off}\n"
        "own_rules:\n  - {name: third, select: {part: P3}, before: {part: P4}, strength: soft, weight: 5000 mm}\n",
        encoding="utf-8",
    )
    profile = load_profile(tmp_path / "p.yaml")
    _, setting, plan = planned(profile)
    assert "P3.outer before P2.outer" in " ".join(because for cut in plan.cuts for because in cut.because)
    assert [v for v in verdicts(setting, plan) if v.wrong] == []


def test_the_entry_is_the_shortest_where_it_is_said() -> None:
    facts, _, plan = proven_plan(PLATE, plant())
    cuts = [p.cut for p in plan.cuts]
    said = 0
    for k, planned in enumerate(plan.cuts):
        leave = cuts[k - 1].end if k else (0.0, 0.0)
        reach = cuts[k + 1].pierce if k + 1 < len(cuts) else (0.0, 0.0)
        span = facts.candidates_of(facts.nest.index[planned.cut.contour])
        ways = [
            math.dist(leave, c.pierce) + math.dist(c.end, reach) for c in (facts.candidates[number] for number in span)
        ]
        here = math.dist(leave, planned.cut.pierce) + math.dist(planned.cut.end, reach)
        told = planned.because[-1].startswith("entered at")
        said += told
        assert told == (here <= min(ways) + 1e-6)
    assert said


def test_plans_keep_to_their_schema() -> None:
    validator().check_schema(validator().schema)
    assert list(validator().iter_errors(json.loads(TEXT))) == []
