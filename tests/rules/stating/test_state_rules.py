"""From facts and a profile to statements: strengths, cycles, what gives way and what may not."""

from __future__ import annotations

from dataclasses import replace

import pytest

from kerfwise.encoder.candidates import build_candidates
from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.facts import compute_facts
from kerfwise.encoder.nest import Nest
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.rules.catalogue.start_side import StartSideOptions
from kerfwise.rules.lock import Lock
from kerfwise.rules.options.option import NoOptions
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.sections import LeadsSection, Objective, RuleSetting, default_settings
from kerfwise.rules.statements import About, Contiguous, Forbid, IdleTravel, Precede
from kerfwise.rules.stating.state_rules import Stated, resolve, state_rules
from kerfwise.tests.rules.hooks import HOOKS


def plant(*locks: Lock, side: str = "left", **strengths: RuleSetting) -> Profile:
    rules = default_settings() | {"start-side": RuleSetting("hard", None, StartSideOptions(side=side))}  # type: ignore[arg-type]
    return Profile("plant", rules=rules | {name.replace("_", "-"): s for name, s in strengths.items()}, locks=locks)


def stated(sheet: Nest, profile: Profile) -> Stated:
    return state_rules(compute_facts(sheet, profile.fact_options(), ()), profile)


PLATE = nest(300, 100, part("P1", rect(10, 10, 80, 80), [circle(50, 50, 9)]), part("P2", rect(110, 10, 80, 80)))


def test_rules_that_are_on_are_stated() -> None:
    found = stated(PLATE, plant())
    assert [s.about.rule for s in found.statements] == [
        "heat-lag",
        "inner-before-outer",
        "level-ahead",
        "no-tip-travel",
        "no-tip-travel",
        "part-contiguous",
        "part-contiguous",
        "objective",
    ]
    assert found.dropped == ()


def test_rule_that_is_off_is_not() -> None:
    off = RuleSetting("off", None, NoOptions())
    found = stated(PLATE, plant(level_ahead=off, inner_before_outer=off))
    assert {s.about.rule for s in found.statements} == {"heat-lag", "no-tip-travel", "part-contiguous", "objective"}


def test_soft_rule_keeps_its_weight() -> None:
    found = stated(PLATE, plant(level_ahead=RuleSetting("soft", 250.0, NoOptions())))
    weights = {s.about.rule: s.weight for s in found.statements}
    assert weights == {
        "heat-lag": 50.0,
        "inner-before-outer": None,
        "level-ahead": 250.0,
        "no-tip-travel": 50.0,
        "part-contiguous": None,
        "objective": 1.0,
    }


def test_idle_travel_costs_its_time_too() -> None:
    profile = replace(plant(), objective=Objective(idle=2.0, time=50.0))
    found = [s for s in stated(PLATE, profile).statements if isinstance(s, IdleTravel)]
    assert [(s.weight, s.about.sentence) for s in found] == [(2.2, "a millimetre of idle travel costs 2.2")]


def test_slower_ways_cost_the_seconds_they_add() -> None:
    """P1 lies at the edge: where it is not pierced it is quicker, and nothing else tells its ways apart but leads."""
    profile = replace(plant(), objective=Objective(time=50.0), leads=LeadsSection(edge_start=True))
    profile = replace(profile, machine=replace(profile.machine, travel_x_mm=(-9, 300), travel_y_mm=(-9, 300)))
    machine = profile.machine
    sheet = nest(200, 100, part("P1", rect(4, 20, 60, 60)), part("P2", rect(110, 20, 60, 60)))
    facts = compute_facts(sheet, profile.fact_options(), build_candidates(sheet, profile.lead_options(sheet)))
    found = {s.candidate: s for s in state_rules(facts, profile).statements if isinstance(s, Forbid)}
    edge = [k for k, c in enumerate(facts.candidates) if c.edge_start]
    assert edge
    assert {facts.candidates[k].contour for k in edge} == {0}
    quickest_s = min(facts.candidates[k].cut_mm for k in edge) / machine.cut_feed_mm_s
    for k in facts.candidates_of(0):
        candidate = facts.candidates[k]
        seconds = candidate.cut_mm / machine.cut_feed_mm_s + (0 if candidate.edge_start else machine.pierce_time_s)
        more = seconds - quickest_s
        assert (k in found) == (more >= 1e-3)
        if k in found:
            assert found[k].weight == pytest.approx(50 * more)
            assert found[k].about == About(
                "objective", ("P1.outer",), f"P1.outer takes {more:.2f} s more to cut this way than the quickest way"
            )
    assert all(k in found for k in facts.candidates_of(0) if k not in edge)
    assert not any(isinstance(s, Forbid) for s in state_rules(facts, plant()).statements)


def test_hooks_drop_one_order_of_the_weakest_rule() -> None:
    found = stated(HOOKS, plant(side="left"))
    assert [(d.rule, d.contours, d.why) for d in found.dropped] == [
        ("hull-before", ("B.outer", "A.outer"), "cycle: A.outer before B.outer (level-ahead)")
    ]
    kept = {(s.about.rule, s.about.contours) for s in found.statements}
    assert {("hull-before", ("A.outer", "B.outer")), ("level-ahead", ("A.outer", "B.outer"))} <= kept
    assert ("hull-before", ("B.outer", "A.outer")) not in kept


def test_hooks_from_the_other_side_drop_the_other_order() -> None:
    found = stated(HOOKS, plant(side="right"))
    assert [(d.rule, d.contours) for d in found.dropped] == [("hull-before", ("A.outer", "B.outer"))]


def test_soft_orders_may_contradict_each_other() -> None:
    found = stated(HOOKS, plant(hull_before=RuleSetting("soft", 10.0, NoOptions())))
    assert found.dropped == ()
    assert sum(s.about.rule == "hull-before" for s in found.statements) == 2


def test_level_ahead_gives_way_to_a_lock() -> None:
    found = stated(PLATE, plant(Lock(contour="P2.outer", before="P1.outer")))
    assert [(d.rule, d.contours, d.why) for d in found.dropped] == [
        ("level-ahead", ("P1.outer", "P2.outer"), "cycle: P2.outer before P1.outer (locks)")
    ]


def test_lock_against_inner_before_outer_is_a_conflict() -> None:
    with pytest.raises(RulesConflict) as caught:
        stated(PLATE, plant(Lock(contour="P1.outer", before="P1.hole1")))
    assert str(caught.value).splitlines()[0] == "these hard rules contradict each other; one must give way"
    assert set(caught.value.reasons) == {
        "P1.outer is cut before P1.hole1: locked by the operator",
        "P1.hole1 is cut before P1.outer: it lies inside it, and cutting P1.outer frees the metal it is in",
    }


def test_conflict_over_a_run_names_the_run() -> None:
    locks = (Lock(contour="P1.hole1", before="P2.outer"), Lock(contour="P2.outer", before="P1.outer"))
    with pytest.raises(RulesConflict) as caught:
        stated(PLATE, plant(*locks))
    assert set(caught.value.reasons) == {
        "P1.hole1 is cut before P2.outer: locked by the operator",
        "P2.outer is cut before P1.outer: locked by the operator",
        "P1 is cut in one go: P1.hole1, P1.outer follow each other",
    }


def order(rule: str, before: int, after: int) -> Precede:
    return Precede(before, after, About(rule, (f"c{before}", f"c{after}"), f"c{before} before c{after}"))


RANKS = {"firm": 0, "strong": 1, "weak": 2}


def test_weak_orders_go_before_a_strong_one() -> None:
    """Two weak orders go rather than the one strong order that would do."""
    statements = [
        order("strong", 0, 1),
        order("weak", 1, 2),
        order("weak", 1, 3),
        order("firm", 2, 0),
        order("firm", 3, 0),
    ]
    found = resolve(statements, 4, RANKS)
    assert [d.contours for d in found.dropped] == [("c1", "c2"), ("c1", "c3")]
    assert found.dropped[0].why == "cycle: c2 before c0 (firm), c0 before c1 (strong)"


def test_fewest_of_one_rule_go() -> None:
    statements = [
        order("weak", 0, 1),
        order("weak", 1, 2),
        order("weak", 1, 3),
        order("firm", 2, 0),
        order("firm", 3, 0),
    ]
    assert [d.contours for d in resolve(statements, 4, RANKS).dropped] == [("c0", "c1")]


def test_strong_order_goes_where_no_weak_one_can() -> None:
    statements = [order("strong", 0, 1), order("firm", 1, 0), order("weak", 2, 3)]
    found = resolve(statements, 4, RANKS)
    assert [d.rule for d in found.dropped] == ["strong"]
    assert found.statements == (statements[1], statements[2])


def test_order_into_a_run_is_an_order_of_the_whole_run() -> None:
    run = Contiguous((0, 1), About("firm", ("c0", "c1"), "c0 and c1 in one go"))
    statements = [run, order("strong", 0, 2), order("weak", 2, 1)]
    assert [d.contours for d in resolve(statements, 3, RANKS).dropped] == [("c2", "c1")]
    assert resolve(statements[1:], 3, RANKS).dropped == ()


def test_order_asked_for_by_a_firm_rule_stays() -> None:
    statements = [order("weak", 0, 1), order("firm", 0, 1), order("weak", 1, 0)]
    assert [d.contours for d in resolve(statements, 2, RANKS).dropped] == [("c1", "c0")]


def test_empty_nest_states_idle_travel_only() -> None:
    assert [s.about.rule for s in stated(nest(100, 100), Profile("plant")).statements] == ["objective"]
