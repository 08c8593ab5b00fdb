"""Contradictions over moves and seconds: three deliberately contradictory profiles, minimal by trying every plan."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from kerfwise.encoder.nest import Nest
from kerfwise.jobs.request import facts_of, make_request, options_for
from kerfwise.models.physics.time_and_cost import feeds_of
from kerfwise.models.plan.conflict import Conflict, find_conflict, state_relaxed
from kerfwise.models.plan.conflict.core import Engines, find_whole_core
from kerfwise.models.plan.conflict.groups import Group, NotAnswered, hard_groups
from kerfwise.models.problem.compile import make_problem
from kerfwise.pipeline import solve_and_verify
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.stating.state_rules import every_statement
from kerfwise.tests.models.brute import lawful

# A tall plate between two small ones, and a home far below: the way from A to C leads over B.
PLATES = nest(
    520,
    320,
    part("A", rect(10, 100, 150, 100)),
    part("B", rect(180, 10, 150, 300)),
    part("C", rect(350, 100, 150, 100)),
)
# Two small plates 20 mm apart, and a large one.
PAIR = nest(
    700, 320, part("A", rect(10, 10, 60, 60)), part("B", rect(90, 10, 60, 60)), part("C", rect(300, 10, 300, 300))
)
PLAIN = """
name: plant
based_on: laser-wood
machine: {home: [260, -4000]}
leads: {entries: 2}
rules:
  level-ahead: off
  hull-before: off
  zone-order: off
  start-side: off
  part-rigidity: off
  no-islands: off
  no-narrow-strips: off
  heat-lag: %s
  no-tip-travel: %s
locks: %s
"""
HEAD_DOWN = ("off", "hard", "[{contour: B.outer, before: A.outer}, {contour: A.outer, before: C.outer}]")
COOLING = (
    "{strength: hard, heat_radius: 50 mm, lag_cuts: 0, lag: 20 s}",
    "off",
    "[{contour: C.outer, position: last}]",
)
PAUSES = (
    "{strength: hard, heat_radius: 50 mm, lag_cuts: 1}",
    "hard",
    "[]",
)


@pytest.fixture
def profile_of(tmp_path: Path):
    def read(heat: str, tips: str, locks: str) -> Profile:
        (tmp_path / "plant.yaml").write_text(PLAIN % (heat, tips, locks), encoding="utf-8")
        return load_profile(tmp_path / "plant.yaml")

    return read


def clash(sheet: Nest, profile: Profile) -> Conflict:
    """The conflict, seen to be one and minimal by trying every plan of what is said to clash."""
    found = find_conflict(facts_of(sheet, profile), profile)
    assert found is not None
    facts = facts_of(sheet, profile)
    groups = {group.about: group for group in hard_groups(every_statement(facts, profile)[0])}
    core = [groups[about] for about in found.clash]
    assert not _can_hold(sheet, profile, core)
    assert all(_can_hold(sheet, profile, [group for group in core if group is not one]) for one in core)
    assert found.minimal
    return found


def _can_hold(sheet: Nest, profile: Profile, groups: list[Group]) -> bool:
    statements = tuple(s for group in groups for s in group.statements)
    problem = make_problem(facts_of(sheet, profile), statements, profile.machine.home, feeds_of(profile))
    return next(lawful(problem), None) is not None


def test_a_move_that_the_locks_force(profile_of) -> None:
    found = clash(PLATES, profile_of(*HEAD_DOWN))
    said = [re.sub(r" \(.*plant.yaml:.*\)", "", line) for line in found.lines()]
    assert said == [
        "these hard rules cannot all hold; without any one of them the others can:",
        "  - locks: B.outer is cut before A.outer: locked by the operator",
        "  - locks: A.outer is cut before C.outer: locked by the operator",
        "  - no-tip-travel: no travel leads over B once B.outer is cut: it may have tipped up",
        "the cheapest way out:",
        "  relax no-tip-travel: 1 statement about B.outer",
    ]


@pytest.mark.slow
def test_seconds_that_nothing_fills(profile_of) -> None:
    found = clash(PAIR, profile_of(*COOLING))
    assert [(about.rule, about.contours) for about in found.clash] == [
        ("heat-lag", ("A.outer", "B.outer")),
        ("locks", ("A.outer", "C.outer")),
        ("locks", ("B.outer", "C.outer")),
    ]
    assert [about.rule for about in found.relax or ()] == ["heat-lag"]


def test_pauses_that_no_order_has(profile_of) -> None:
    """Of three cuts, that of B comes next to A's or to C's."""
    found = clash(PLATES, profile_of(*PAUSES))
    assert [(about.rule, about.contours) for about in found.clash] == [
        ("heat-lag", ("A.outer", "B.outer")),
        ("heat-lag", ("B.outer", "C.outer")),
    ]


@pytest.mark.slow
def test_the_way_out_is_taken_and_told(profile_of) -> None:
    profile = profile_of(*HEAD_DOWN)
    limits = options_for(PLATES, profile, work=2)
    made = solve_and_verify(make_request(facts_of(PLATES, profile), profile, relax=True), profile, limits)
    assert made.verdict.ok
    assert [(d.rule, d.contours) for d in made.plan.dropped if d.relaxed] == [("no-tip-travel", ("B.outer",))]
    assert made.verdict.rule("no-tip-travel").verdict == "excused"
    assert [p.cut.contour for p in made.plan.cuts] == ["B.outer", "A.outer", "C.outer"]


def test_what_can_hold_is_no_conflict(profile_of) -> None:
    profile = profile_of("{strength: hard, heat_radius: 50 mm, lag_cuts: 0, lag: 20 s}", "hard", "[]")
    facts = facts_of(PAIR, profile)
    assert find_conflict(facts, profile) is None
    assert not any("relaxed" in d.why for d in state_relaxed(facts, profile).dropped)


def test_without_work_nothing_is_claimed(profile_of) -> None:
    profile = profile_of(*HEAD_DOWN)
    facts = facts_of(PLATES, profile)
    groups = hard_groups(every_statement(facts, profile)[0])
    with pytest.raises(NotAnswered):
        find_whole_core(Engines(facts, profile.machine.home, feeds_of(profile), work=0.0), groups, {})
    first = Engines(facts, profile.machine.home, feeds_of(profile), work=1e-9)
    core = find_whole_core(first, groups, {})
    assert core is not None
    assert not core.minimal
    told = Conflict(tuple(group.about for group in core.groups), core.minimal, None, "stuck")
    assert "it was not shown that each of them has a part" in next(iter(told.lines()))
