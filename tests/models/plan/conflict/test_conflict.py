"""Conflicts of a nest and its profile: what is said of them, and plans made once the way out is taken."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Literal

import pytest

from kerfwise import Conflict, Lock, Nest, Profile, RulesConflict
from kerfwise.jobs.request import facts_of, make_request, options_for
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.physics.time_and_cost import feeds_of
from kerfwise.models.plan.conflict import find_conflict, state_relaxed
from kerfwise.models.plan.conflict.core import Engines, find_whole_core
from kerfwise.models.plan.conflict.groups import Group, NotAnswered, hard_groups
from kerfwise.models.problem.compile import make_problem
from kerfwise.pipeline import solve_and_verify
from kerfwise.postproc.check import check_program
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.check_plan import check_plan
from kerfwise.rule_kit import circle, nest, part, rect
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.stating.state_rules import every_statement, state_rules
from kerfwise.tests.models.brute import lawful
from kerfwise.tests.models.solved import plant, proven_plan

PLATE = nest(
    400,
    100,
    part("P1", rect(10, 10, 80, 80), [circle(50, 50, 15)]),
    part("P2", rect(110, 10, 80, 80)),
    part("P3", rect(210, 10, 80, 80)),
)


def conflict_of(profile: Profile) -> Conflict | None:
    return find_conflict(facts_of(PLATE, profile), profile)


def told(*locks: Lock) -> str:
    conflict = conflict_of(plant(*locks))
    assert conflict is not None
    return "\n".join(conflict.lines())


def test_no_conflict() -> None:
    assert conflict_of(plant()) is None
    assert conflict_of(plant(Lock(contour="P2.outer", before="P1.outer"))) is None  # level-ahead gives way


def test_locks_against_each_other_through_a_run() -> None:
    locks = Lock(contour="P1.hole1", before="P2.outer"), Lock(contour="P2.outer", before="P1.outer")
    assert told(*locks) == (
        "these hard rules cannot all hold; without any one of them the others can:\n"
        "  - locks: P1.hole1 is cut before P2.outer: locked by the operator\n"
        "  - locks: P2.outer is cut before P1.outer: locked by the operator\n"
        "  - part-contiguous: P1 is cut in one go: P1.hole1, P1.outer follow each other\n"
        "the cheapest way out:\n"
        "  relax part-contiguous: 1 statement about P1.hole1, P1.outer"
    )


def test_a_position_against_rules_that_may_not_give_way() -> None:
    locks = (Lock(contour="P3.outer", position=2), Lock(contour="P1.outer", before="P3.outer"))
    assert told(*locks) == (
        "these hard rules cannot all hold; without any one of them the others can:\n"
        "  - inner-before-outer: P1.hole1 is cut before P1.outer: it lies inside it, and cutting P1.outer frees the "
        "metal it is in\n"
        "  - locks: P3.outer is cut 2 in order: locked by the operator\n"
        "  - locks: P1.outer is cut before P3.outer: locked by the operator\n"
        "the cheapest way out:\n"
        "  relax locks: 1 statement about P3.outer"
    )


@pytest.mark.parametrize("position", [1, "first", 2, 3, 4, "last"])
def test_level_ahead_gives_way_to_a_position(position: Literal["first", "last"] | int) -> None:
    """P3 is ahead of nothing and behind two: at 1 and 2 it is cut too early for level-ahead, and that is told."""
    profile = plant(Lock(contour="P3.outer", position=position))
    _, stated, plan = proven_plan(PLATE, profile)
    order = [p.cut.contour for p in plan.cuts]
    assert order.index("P3.outer") + 1 == {"first": 1, "last": 4}.get(position, position)
    assert {d.rule for d in stated.dropped} <= {"level-ahead"}
    program = write_program(plan, PLATE, profile)
    for verdict in (check_plan(PLATE, plan, profile), check_program(PLATE, program, profile)):
        assert verdict.broken() == ()
    assert len(stated.dropped) == {1: 2, "first": 2, 2: 2, 3: 1, 4: 0, "last": 0}[position]


def test_a_direction_that_no_candidate_has() -> None:
    assert told(Lock(contour="P2.outer", direction="ccw")) == (
        "this hard rule cannot hold, whichever of the offered ways to cut is taken:\n"
        "  - locks: P2.outer is cut ccw: locked by the operator\n"
        "  note: cut-direction offers no other way round P2.outer than cw\n"
        "the cheapest way out:\n"
        "  relax locks: 1 statement about P2.outer"
    )


def test_what_may_never_give_way() -> None:
    """A lock gives way only because inner-before-outer cannot."""
    locks = (Lock(contour="P1.outer", before="P1.hole1"),)
    with pytest.raises(RulesConflict):
        state_rules(facts_of(PLATE, plant(*locks)), plant(*locks))
    conflict = conflict_of(plant(*locks))
    assert conflict is not None
    assert conflict.contours == ("P1.hole1", "P1.outer")
    assert [about.rule for about in conflict.relax or ()] == ["locks"]


def test_relaxed_statements_are_seen_in_plan_program_and_check() -> None:
    locks = Lock(contour="P1.hole1", before="P2.outer"), Lock(contour="P2.outer", before="P1.outer")
    profile = plant(*locks)
    facts = facts_of(PLATE, profile)
    _, _, plan = proven_plan(PLATE, profile, state_relaxed(facts, profile))
    assert [p.cut.contour for p in plan.cuts] == ["P1.hole1", "P2.outer", "P1.outer", "P3.outer"]
    relaxed = [(d.rule, d.contours, d.why) for d in plan.dropped if d.relaxed]
    assert relaxed == [
        (
            "part-contiguous",
            ("P1.hole1", "P1.outer"),
            "relaxed: P1 is cut in one go: P1.hole1, P1.outer follow each other",
        )
    ]
    program = write_program(plan, PLATE, profile)
    assert "(RELAXED 1 part-contiguous P1.hole1 P1.outer)" in program
    for verdict in (check_plan(PLATE, plan, profile), check_program(PLATE, program, profile)):
        assert verdict.broken() == ()
        assert verdict.rule("part-contiguous").verdict == "excused"
        assert "relaxed: part-contiguous about P1.hole1, P1.outer" in verdict.warnings
    silent = program.replace("(RELAXED 1 part-contiguous P1.hole1 P1.outer)\n", "")
    assert check_program(PLATE, silent, profile).broken() == ("part-contiguous",)
    other = program.replace("part-contiguous P1.hole1 P1.outer", "part-contiguous P2.outer P3.outer")
    assert check_program(PLATE, other, profile).broken() == ("part-contiguous",)


def test_nothing_is_relaxed_without_need() -> None:
    profile = plant()
    facts = facts_of(PLATE, profile)
    assert state_relaxed(facts, profile) == state_rules(facts, profile)


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


@pytest.mark.full
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


def test_without_a_way_out_it_names_the_rules_that_can_be_made_soft(tmp_path: Path) -> None:
    """Metal that falls out keeps a hole before its outline, whatever inner-before-outer says: it is not named."""
    odd = "own_rules: [{name: odd, select: {kind: outer}, before: {kind: hole}, strength: %s}]\nrules: {%s: off}\n"

    def found(strength: str, off: str = "t-max") -> Conflict | None:
        (tmp_path / "odd.yaml").write_text(odd % (strength, off))
        profile = load_profile(tmp_path / "odd.yaml")
        return find_conflict(facts_of(PLATE, profile), profile, Deadline(0.0))

    conflict = found("hard")
    assert conflict is not None
    assert {about.rule for about in conflict.clash} == {"inner-before-outer", "own:odd"}
    assert str(conflict).endswith(
        "try a longer limit, such as --work 60 (in Python work=60), or make own:odd soft or off"
    )
    assert found("hard", "inner-before-outer") is not None
    assert found("soft") is None


EARLY = """
name: early
based_on: plasma-carbon-steel
own_rules:
  - {name: early A, strength: hard, select: {part: A}, within_time: 55 %}
  - {name: early B, strength: hard, select: {part: B}, within_time: 55 %}
"""


def two_parts_of_nine() -> Nest:
    """Each with holes in two rows of four."""
    holes = [(20 + 60 * (k % 4), 30 + 80 * (k // 4), 30, 30) for k in range(8)]
    inside = [[rect(x + u, v, w, h) for u, v, w, h in holes] for x in (20, 360)]
    parts = [part("A", rect(20, 10, 280, 190), inside[0]), part("B", rect(360, 10, 280, 190), inside[1])]
    return nest(700, 260, *parts)


@pytest.mark.slow
def test_of_many_equal_conditions_the_fewest_give_way_at_once_and_the_advice_works(tmp_path: Path) -> None:
    """Nine sums contradict nine others in hundreds of ways, each shown by a solver: there was no way out in 20 s."""
    (path := tmp_path / "early.yaml").write_text(EARLY, encoding="utf-8")
    made, profile = two_parts_of_nine(), load_profile(path)
    facts = facts_of(made, profile)
    conflict = find_conflict(facts, profile, Deadline(work=5.0))
    assert conflict is not None
    assert conflict.relax is not None
    assert len(conflict.relax) == 3
    assert "a way out (which one costs least was not compared):" in list(conflict.lines())
    assert "a way out (fewer may do):" in list(replace(conflict, fewest=False).lines())
    limits = options_for(made, profile, work=0.5)
    followed = solve_and_verify(make_request(facts, profile, relax=True), profile, limits)
    assert len([dropped for dropped in followed.plan.dropped if dropped.relaxed]) == 3
    assert followed.verdict.ok


@pytest.mark.parametrize("names", [("Früh P2", "Früh P3"), ("Größe", "Grö(e"), ("первый", "сначала")])
def test_a_program_says_which_of_a_plants_own_rules_gave_way_whatever_their_names(
    names: tuple[str, str], tmp_path: Path
) -> None:
    """A comment holds no accents, and a name in it no spaces: the check read `own:first` in place of `own:first P2`."""
    rule = '  - {{name: "{name}", strength: hard, select: {{part: {part}}}, first: true}}\n'
    rules = [rule.format(name=name, part=part) for name, part in zip(names, ("P2", "P3"), strict=True)]
    text = "based_on: plasma-carbon-steel\nown_rules:\n" + "".join(rules)
    (path := tmp_path / "first.yaml").write_text(text, encoding="utf-8")
    profile = load_profile(path)
    limits = options_for(PLATE, profile, work=0.5)
    made = solve_and_verify(make_request(facts_of(PLATE, profile), profile, relax=True), profile, limits)
    (relaxed,) = [dropped for dropped in made.plan.dropped if dropped.relaxed]
    assert made.verdict.ok
    assert check_program(PLATE, made.program, profile).rule(relaxed.rule).verdict == "excused"


def test_a_move_that_a_relaxed_rule_forbids_is_excused(tmp_path: Path) -> None:
    """The rule is about all contours at one height and those at others; the check names the two cuts."""
    rows = nest(400, 300, *(part(name, rect(10 + 110 * k, 10 + 60 * k, 80, 50)) for k, name in enumerate("ABC")))
    rule = "  - {name: rows, strength: hard, next: {same: y_mm, within: 5 mm}}\n"
    (path := tmp_path / "rows.yaml").write_text(f"based_on: plasma-carbon-steel\nown_rules:\n{rule}", encoding="utf-8")
    profile = load_profile(path)
    limits = options_for(rows, profile, work=0.5)
    made = solve_and_verify(make_request(facts_of(rows, profile), profile, relax=True), profile, limits)
    assert len([dropped for dropped in made.plan.dropped if dropped.relaxed]) == 2
    assert made.verdict.rule("own:rows").verdict == "excused"
    assert made.verdict.ok
