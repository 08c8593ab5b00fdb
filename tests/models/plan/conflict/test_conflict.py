"""Conflicts of a nest and its profile: what is said of them, and plans made once the way out is taken."""

from __future__ import annotations

from typing import Literal

import pytest

from kerfwise.encoder.errors import RulesConflict
from kerfwise.jobs.request import facts_of
from kerfwise.models.plan.conflict import Conflict, find_conflict, state_relaxed
from kerfwise.postproc.check import check_program
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.check_plan import check_plan
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.rules.lock import Lock
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.stating.state_rules import state_rules
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
