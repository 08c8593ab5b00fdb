"""What stands at the top of a program for whoever runs it, and what papers and drawings say of orders and dates."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from kerfwise.tests.commands.run_cli import kerfwise

JOB = "order: A-17\ndue: 2026-12-24\ndate: 2026-12-01\nnumber: 4711\n"


def plate(folder: Path, **attributes: dict[str, object]) -> Path:
    """Two plates, each with what is said of it."""
    parts = [
        {"id": name, **attributes.get(name, {}), "outer": [[x, 20], [x + 80, 20], [x + 80, 80], [x, 80]]}
        for name, x in (("A", 20), ("B", 140))
    ]
    made = {"format": "kerfwise-nest/1", "units": "mm", "sheet": {"width": 240, "height": 100}, "parts": parts}
    path = folder / "plate.json"
    path.write_text(json.dumps(made), encoding="utf-8")
    return path


def head(folder: Path, *words: object) -> str:
    done = kerfwise("solve", folder / "plate.json", "--work", "0.1", "-o", folder / "out.nc", *words)
    assert done.code == 0, done.err
    return (folder / "out.nc").read_text(encoding="utf-8")


def test_a_job_says_order_day_and_number(tmp_path: Path) -> None:
    nest = plate(tmp_path)
    assert "DATE" not in head(tmp_path)
    (tmp_path / "plate.job.yaml").write_text(JOB, encoding="utf-8")
    text = head(tmp_path)
    for said in ("(DATE 2026-12-01)", "(ORDER A-17)", "(DUE 2026-12-24)", "(SHEET 240 X 100 MM, PARTS 2)"):
        assert said in text
    assert "(MATERIAL " in text
    assert "(ESTIMATED TIME " in text
    assert "PROGRAM" not in text  # this control calls programs by no number
    assert text == head(tmp_path)
    assert kerfwise("check", nest, tmp_path / "out.nc").code == 0
    fanuc = tmp_path / "plant.yaml"
    fanuc.write_text("based_on: laser-st10kp-2mm\nmachine: {dialect: fanuc, accept_dialect: true}\n", encoding="utf-8")
    numbered = head(tmp_path, "-p", fanuc)
    assert "(PROGRAM 4711)" in numbered
    assert "\nO4711\n" in numbered
    assert kerfwise("check", nest, tmp_path / "out.nc", "-p", fanuc).code == 0


def test_a_day_may_be_given_for_one_program(tmp_path: Path) -> None:
    plate(tmp_path)
    assert "(DATE 2026-11-30)" in head(tmp_path, "--date", "2026-11-30")
    done = kerfwise("solve", tmp_path / "plate.json", "--date", "30.11.2026", "-o", tmp_path / "out.nc")
    assert done.code == 2
    assert "expected a day such as 2026-12-24 (year-month-day), got '30.11.2026'" in done.err


def test_parts_of_which_more_are_wanted_are_told(tmp_path: Path) -> None:
    """A plan cuts what is drawn, however many a part says."""
    wanted = {"A": {"quantity": 4}, "B": {"quantity": 2}}  # both are the same, so that there are two of B
    nest = plate(tmp_path, **wanted)
    words = ("solve", nest, "--work", "0.1", "-o", tmp_path / "out.nc")
    assert "more parts are wanted than are cut: A (4 wanted, 2 cut); a plan cuts what" in kerfwise(*words).err
    (tmp_path / "plate.job.yaml").write_text("quantity: 2\n", encoding="utf-8")
    assert "wanted" not in kerfwise(*words).err


@pytest.mark.parametrize(
    ("said", "noted"),
    [
        ({"A": {"due": "2026-12-24"}}, "1 part has a due date or a priority"),
        ({"A": {"priority": 1}, "B": {"priority": 2}}, "2 parts have a due date or a priority"),
        ({"A": {"due": "2026-12-24"}, "B": {"due": "2026-12-24"}}, ""),
        ({}, ""),
    ],
)
def test_dates_that_change_nothing_are_noted(said: dict[str, dict[str, object]], noted: str, tmp_path: Path) -> None:
    nest = plate(tmp_path, **said)
    done = kerfwise("solve", nest, "--work", "0.1", "-o", tmp_path / "out.nc")
    told = "objective.completion is 0: the order of cutting does not follow it"
    assert (noted in done.err, told in done.err) == (True, bool(noted))
    done = kerfwise("solve", nest, "--work", "0.1", "-o", tmp_path / "out.nc", "--set", "objective.completion=1")
    assert told not in done.err
