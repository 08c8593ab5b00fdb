"""Parts nearer than the kerf: every pair is named, and --relax lets exactly these go."""

from __future__ import annotations

import pytest

from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.validate import validated
from kerfwise.jobs.request import facts_of
from kerfwise.models.engines.minizinc_engine import solve_minizinc
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.plan.conflict import find_conflict, state_relaxed
from kerfwise.postproc.check import check_program
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.check_plan import check_plan
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.lock import Lock
from kerfwise.rules.statements import RELAXED_MM
from kerfwise.rules.stating.state_rules import state_rules
from kerfwise.tests.models.solved import plant, proven_plan

TIGHT = nest(
    400,
    100,
    part("P1", rect(10, 10, 80, 80)),
    part("P2", rect(90.5, 10, 80, 80)),
    part("P3", rect(171, 10, 80, 80)),
    part("P4", rect(260, 10, 80, 80)),
)
PAIRS = ("P1.outer", "P2.outer"), ("P2.outer", "P3.outer")
PROFILE = plant()


def test_every_pair_is_named() -> None:
    conflict = find_conflict(facts_of(TIGHT, PROFILE), PROFILE)
    assert conflict is not None
    assert "\n".join(conflict.lines()) == (
        "these hard rules cannot hold in any order: 2 of shared-metal:\n"
        "  - shared-metal: P1.outer and P2.outer are 0.500 mm apart at (90.2, 10.0): "
        "the kerf of 1.5 mm reaches 1.000 mm into the other part\n"
        "  - shared-metal: P2.outer and P3.outer are 0.500 mm apart at (170.8, 10.0): "
        "the kerf of 1.5 mm reaches 1.000 mm into the other part\n"
        "the cheapest way out:\n"
        "  relax shared-metal: 2 statements about P1.outer, P2.outer, P3.outer"
    )


def row(count: int, gap_mm: float) -> Nest:
    """Long bars one above the other, each with room for leads at its ends."""
    bars = [part(f"P{k}", rect(20, 20 + k * (10 + gap_mm), 100, 10)) for k in range(count)]
    return nest(140, 50 + count * (10 + gap_mm), *bars)


@pytest.mark.slow
def test_a_hundred_pairs_are_all_named() -> None:
    conflict = find_conflict(facts_of(row(101, 0.7), PROFILE), PROFILE)
    assert conflict is not None
    lines = list(conflict.lines())
    assert lines[0] == "these hard rules cannot hold in any order: 100 of shared-metal:"
    assert len([line for line in lines if line.startswith("  - shared-metal: ")]) == 100
    assert len({about.contours for about in conflict.clash}) == 100


@pytest.mark.slow
def test_pairs_are_named_where_contours_have_no_room_for_leads_either() -> None:
    grid = nest(
        180, 180, *(part(f"P{x}{y}", rect(20 + 41 * x, 20 + 41 * y, 40, 40)) for x in range(3) for y in range(3))
    )
    with pytest.raises(RulesConflict, match="cannot hold in any order") as error:
        facts_of(grid, PROFILE)
    assert len([reason for reason in error.value.reasons if "mm apart" in reason]) == 3 * 2 * 2 + 2 * 2 * 2
    assert (
        "besides, a contour of the nest cannot be cut as the options ask, and --relax (in Python: relax=True) does not "
        "help there:"
    ) in error.value.reasons


def test_no_engine_is_asked_in_vain() -> None:
    with pytest.raises(RulesConflict, match="cannot hold in any order") as error:
        state_rules(facts_of(TIGHT, PROFILE), PROFILE)
    assert len(error.value.reasons) == 2


def test_relaxed_pairs_are_seen_in_plan_program_and_check() -> None:
    facts = facts_of(TIGHT, PROFILE)
    stated = state_relaxed(facts, PROFILE)
    assert [(d.rule, d.contours) for d in stated.dropped] == [("shared-metal", pair) for pair in PAIRS]
    *_, plan = proven_plan(TIGHT, PROFILE, stated)
    assert plan.solve.objective < RELAXED_MM, "what no plan can meet is no part of what plans cost"
    assert [d.contours for d in plan.dropped if d.relaxed] == list(PAIRS)
    program = write_program(plan, TIGHT, PROFILE)
    assert "(RELAXED 2 shared-metal P2.outer P3.outer)" in program
    for verdict in (check_plan(TIGHT, plan, PROFILE), check_program(TIGHT, program, PROFILE)):
        assert verdict.broken() == ()
        assert verdict.rule("shared-metal").verdict == "excused"
        assert "relaxed: shared-metal about P1.outer, P2.outer" in verdict.warnings
    silent = program.replace("(RELAXED 2 shared-metal P2.outer P3.outer)\n", "")
    assert check_program(TIGHT, silent, PROFILE).broken() == ("no-gouging", "shared-metal")


@pytest.mark.slow
def test_locks_that_contradict_each_other_are_let_go_besides() -> None:
    profile = plant(Lock(contour="P1.outer", before="P4.outer"), Lock(contour="P4.outer", before="P1.outer"))
    relax = [d.rule for d in state_relaxed(facts_of(TIGHT, profile), profile).dropped]
    assert sorted(relax) == ["locks", "shared-metal", "shared-metal"]


@pytest.mark.minizinc
def test_minizinc_refuses_the_same_pairs() -> None:
    facts = facts_of(TIGHT, PROFILE)
    relaxed = state_relaxed(facts, PROFILE)
    options = SolveOptions(work=20)
    assert len(solve_minizinc(facts, PROFILE, relaxed, options).route) == 4
    strict = type(relaxed)(relaxed.statements, ())
    with pytest.raises(RulesConflict, match="no plan meets every hard rule"):
        solve_minizinc(facts, PROFILE, strict, options)


@pytest.mark.minizinc
def test_one_line_of_two_parts_is_refused_and_let_go_likewise() -> None:
    host = part("H", rect(10, 10, 100, 80), [rect(20, 20, 80, 60), rect(40, 30, 30, 30)])
    both = validated(nest(200, 100, host, part("G", rect(40, 30, 30, 30))))
    facts = facts_of(both, PROFILE)
    conflict = find_conflict(facts, PROFILE)
    assert conflict is not None
    (about,) = conflict.clash
    assert about.contours == ("G.outer",)
    assert about.sentence.startswith("G.outer and H.hole2 are one line at (40.0, 30.0), given to two parts: ")
    stated = state_relaxed(facts, PROFILE)
    *_, plan = proven_plan(both, PROFILE, stated)
    program = write_program(plan, both, PROFILE)
    assert "(RELAXED 1 shared-metal G.outer)" in program
    assert check_program(both, program, PROFILE).broken() == ()
    silent = program.replace("(RELAXED 1 shared-metal G.outer)\n", "")
    assert check_program(both, silent, PROFILE).broken() == ("shared-metal",)
    with pytest.raises(RulesConflict, match="no plan meets every hard rule"):
        solve_minizinc(facts, PROFILE, type(stated)(stated.statements, ()), SolveOptions(work=20))
