"""A few of the nests that `many` plans by the hundred, and its counts."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner

from kerfwise.tests.metal import many, one
from kerfwise.tests.metal.findings import Finding
from kerfwise.tests.metal.hand_made import CUTS, around, program, sheet
from kerfwise.tests.metal.made_nests import made
from kerfwise.tests.metal.planned import Tried, nest_of, reason, tried
from kerfwise.tests.metal.simulate import simulate

EFFORT = ("--work", "0.5")


@pytest.mark.parametrize("seed", [9, 12])
def test_a_made_nest_is_planned_and_burnt_without_a_finding(seed: int) -> None:
    (done,) = tried(made(seed), "plasma-carbon-steel", EFFORT)
    assert done.findings == ()
    assert done.cuts == made(seed).contours


@pytest.mark.parametrize(
    ("seed", "profile", "cuts_with", "gap_mm"),
    [
        (15, "laser-st10kp-2mm", "links", 0.2),
        (15, "plasma-carbon-steel", "links", 1.5),
        (29, "plasma-carbon-steel", "common cuts, links", None),
        (0, "laser-st10kp-2mm", "common cuts, pass", None),
        (1, "laser-st10kp-2mm", "edges that touch", None),
    ],
)
def test_parts_a_kerf_apart_make_no_scrap_nor_does_the_rest_after_a_stop(
    seed: int, profile: str, cuts_with: str, gap_mm: float | None
) -> None:
    nest = nest_of(seed, profile, cuts_with) if gap_mm is None else made(seed, gap_mm)
    done = tried(nest, profile, EFFORT, "pass" not in cuts_with, cuts_with)
    assert [(one.refused, one.broken, one.findings) for one in done] == [("", "", ())] * len(done)
    assert done[0].cuts == nest.contours
    assert ("common" in cuts_with or "touch" in cuts_with) == (done[0].along_edges > 0)


def test_a_plan_that_prices_a_way_of_a_snake_is_one_of_its_nest() -> None:
    nest = nest_of(9, "oxyfuel-thick-plate", "snake, links")
    done = tried(nest, "oxyfuel-thick-plate", ("--work", "0.1"), cuts_with="snake, links")
    assert [(one.refused, one.broken, one.findings) for one in done] == [("", "", ())]


def test_a_refusal_is_counted_by_its_reason() -> None:
    (done,) = tried(made(1), "plasma-carbon-steel", EFFORT)
    assert "N mm" in done.refused
    assert not any(letter.isdigit() for letter in done.refused)
    assert done.findings == ()


@pytest.mark.parametrize(
    ("said", "told"),
    [
        ("kerfwise: nest.json: P1.outer and P22.hole3 are 0.5 mm apart\n  - more", "more"),
        ("kerfwise: nest.json:7: there is no rule 'P7' in a.yaml", "N: there is no rule '…' in a.yaml"),
        (
            "kerfwise: refused\n  - 5 holes (A.hole1, A.hole2, A.hole3 and 2 more): `x: 1 mm` frees them",
            "holes: `x: N mm` frees them",
        ),
        ("holds hard pierce x\nbroken     hard no-gouging   y\nbroken hard pierce z", "no-gouging, pierce"),
        ("", "nothing said"),
    ],
)
def test_reasons_are_classes(said: str, told: str) -> None:
    assert reason(said).endswith(told)


def test_findings_are_counted_told_and_saved(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    bad = program([*CUTS[:3], ("B.outer", around(90, 20, 50, 50, (72.5, 45)))])

    def faulty(task: many.Task) -> tuple[Tried, ...]:
        return (Tried(task[0], task[1], cuts=3, findings=tuple(simulate(sheet(), bad, 2.0)), program=bad),)

    monkeypatch.setattr(many, "_one", faulty)
    words = ["--nests", "2", "--processes", "1", "--profiles", "water-jet", "--save", str(tmp_path), "--each"]
    ran = CliRunner().invoke(many.main, words)
    assert ran.exit_code == 1
    assert "programs burnt: 2, cuts: 6, findings: 2" in ran.output
    assert "pierce-over-void       2 in    2 programs; smallest: seed 0 (grid, 4 contours), water-jet" in ran.output
    assert ran.output.count("seed 1, water-jet: pierce-over-void: cut 4, B.outer and A.outer at (72.50, 45.00)") == 1
    assert (tmp_path / "pierce-over-void.nc").read_text() == bad
    assert (tmp_path / "pierce-over-void.json").read_text() == made(0).text


def test_no_finding_is_exit_code_0(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(many, "_one", lambda task: (Tried(task[0], task[1], cuts=3),))
    assert CliRunner().invoke(many.main, ["--nests", "3", "--processes", "1"]).exit_code == 0
    monkeypatch.setattr(many, "_one", lambda task: (Tried(task[0], task[1], broken="exit code 70"),))
    assert CliRunner().invoke(many.main, ["--nests", "3", "--processes", "1"]).exit_code == 1


def test_stopped_before_the_first_plan_no_seeds_are_told() -> None:
    ran = CliRunner().invoke(many.main, ["--first", "9", "--processes", "1", "--minutes", "0"])
    assert (ran.exit_code, ran.stdout.splitlines()[0]) == (0, "nests made: 0")


def test_a_finding_says_what_and_where() -> None:
    found = Finding("left-uncut", 3, ("A.outer",), (1.0, 2.0), 4.5, "mm", "metal stays for")
    assert str(found) == "left-uncut: cut 3, A.outer at (1.00, 2.00): metal stays for 4.50 mm"


def test_one_program_is_judged_by_a_command(tmp_path: Path) -> None:
    (tmp_path / "nest.json").write_text(made(12).text, encoding="utf-8")
    (tmp_path / "none.nc").write_text(program([]), encoding="utf-8")
    ran = CliRunner().invoke(one.main, [str(tmp_path / "nest.json"), str(tmp_path / "none.nc")])
    assert ran.exit_code == 1
    assert ran.output.startswith("left-uncut: Q.outer at")
    assert ran.output.endswith("0 cuts and marks burnt, findings: 1\n")
