"""Nests and programs that went wrong once, each with what is right: `tests/metal/cases`."""

from __future__ import annotations

from pathlib import Path

from kerfwise.encoder.readers import read_nest
from kerfwise.jobs.given import Given, common_cuts_not_made
from kerfwise.rules.profile.load import load_profile
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.metal.plant import plant
from kerfwise.tests.metal.simulate import simulate
from kerfwise.tests.metal.test_loose_metal import made

CASES = Path(__file__).parent / "cases"


def test_rounded_plates_in_a_grid_are_cut_by_whole_rounds_and_that_is_said() -> None:
    """Where two neighbours of one are out, its rounded corner between them is apart from the rest."""
    sheet, profile = (
        read_nest(CASES / "13-common-rounded-grid.json"),
        load_profile(CASES / "13-common-rounded-grid.yaml"),
    )
    found = made(sheet, profile)
    assert found.verdict.ok
    assert all(planned.cut.span is None for planned in found.plan.cuts)
    assert simulate(sheet, found.program, **plant(profile)) == []
    assert common_cuts_not_made(Given(sheet, profile)) == (
        "cuts.common: no common cuts for P00.outer, P01.outer, P10.outer, P11.outer: in any order some part would be "
        "left with two stretches to cut, as rounded corners between two neighbours are; these parts are all "
        "cut all round"
    )


def test_a_conflict_with_what_is_out_after_a_stop_ends_with_1(tmp_path: Path) -> None:
    words = [CASES / "17-resume-conflict.json", "-p", CASES / "17-resume-conflict.yaml"]
    words += ["--lock-from", CASES / "17-resume-conflict.nc", "--upto", "3", "--redo-last", "--work", "0.2"]
    words += ["-o", tmp_path / "rest.nc", "--conflict-picture", tmp_path / "conflict.svg"]
    result = kerfwise("solve", *words)
    assert result.code == 1
    assert (tmp_path / "conflict.svg").exists()
    assert not (tmp_path / "rest.nc").exists()
