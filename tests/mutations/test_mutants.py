"""Programs of six dialects, changed word by word: what matters fails the check with the plan."""

from __future__ import annotations

from pathlib import Path

import pytest

import kerfwise
from kerfwise import load_profile, read_nest
from kerfwise.tests.checked import checked
from kerfwise.tests.mutations.judged import DIALECTS, counted, original, passes, words
from kerfwise.tests.mutations.mutants import Mutant, mutants

CASES = Path(__file__).parent.parent / "metal" / "cases"


COARSE = pytest.mark.scrap("ESSI counts in 0.1 mm")
EACH = [pytest.param(name, marks=COARSE) if name == "essi" else name for name in DIALECTS]


@pytest.mark.parametrize("dialect", EACH)
def test_the_program_itself_passes_and_no_mutant_does(dialect: str) -> None:
    of = original(dialect)
    assert passes(of, Mutant("none", 0, of.made.program), with_plan=True)
    made = [m for m in mutants(of.made.program, dialect, 12) if words(m.text) != words(of.made.program)]
    assert len(made) > 8
    assert [(m.kind, m.line) for m in made if passes(of, m, with_plan=True)] == []


@pytest.mark.full
@pytest.mark.slow
@COARSE
def test_so_of_many() -> None:
    rows, _, with_plan = counted(300, seed=2)
    assert [(m.kind, m.line, m.text.split("\n")[m.line - 1]) for m in with_plan] == []
    assert all(count[0] > 250 for count in rows.values())


@pytest.mark.parametrize(
    ("name", "profile", "without_plan"),
    [
        ("05-overcut-other-way", "linuxcnc.yaml", "308.4 mm of them once more along it"),
        ("07-grbl-half-power", "07-grbl-half-power.yaml", "it cuts with S450, the dialect has S1000"),
    ],
)
def test_edited_programs_that_passed_once(name: str, profile: str, without_plan: str) -> None:
    plant = CASES / profile
    alone = kerfwise.check(CASES / f"{name}.json", CASES / f"{name}.nc", plant)
    assert any(without_plan in violation.text for rule in alone.rules for violation in rule.violations)
    held = kerfwise.check(CASES / f"{name}.json", CASES / f"{name}.nc", plant, CASES / f"{name}.plan.json")
    assert "follows-plan" in held.broken()


def test_comments_numbers_spelt_otherwise_and_pauses_change_nothing() -> None:
    of = original("linuxcnc")
    rows = of.made.program.split("\n")
    rows = [
        row.replace("G0 ", "G00 ").replace("N", "n") if not row.startswith("(") else f"{row} (SEEN)" for row in rows
    ]
    text = "\n".join(["(BY HAND)", *rows[:-2], "M0", *rows[-2:]])
    assert checked(of.nest, text, of.profile, of.made.plan).ok


@pytest.mark.parametrize("dialect", ["linuxcnc", "burny"])
def test_an_entry_beside_a_corner_is_read_as_planned(dialect: str, tmp_path: Path) -> None:
    """Several points of the contour are as near to the place where the torch joins its ring."""
    from kerfwise.tests.metal.test_loose_metal import made

    nest, profile = read_nest(CASES / "08-check-plan-refuses-valid.json"), load_profile(CASES / f"08-{dialect}.yaml")
    found = made(nest, profile)
    assert found.verdict.ok
    result = checked(nest, found.program, profile, found.plan)
    assert result.ok, result.broken()


@COARSE
def test_corners_in_steps_of_a_tenth_of_a_millimetre() -> None:
    from kerfwise.tests.metal.test_loose_metal import made

    found = made(read_nest(CASES / "09b-essi-corner-feed.json"), load_profile(CASES / "09b-essi-corner-feed.yaml"))
    assert found.verdict.ok, found.verdict.broken()
