"""Rounds cut in two stretches: strips in halves, and parts that hang by a last stretch until all others do."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest

from kerfwise.tests.commands.run_cli import kerfwise

PLASMA = "based_on: plasma-carbon-steel\nmachine: {pierce_dwell: program}\n"
KERF = 1.5


def rect(x: float, y: float, w: float, h: float) -> list[list[float]]:
    return [[x, y], [x + w, y], [x + w, y + h], [x, y + h]]


NEST = {
    "format": "kerfwise-nest/1",
    "units": "mm",
    "sheet": {"width": 700, "height": 300},
    "parts": [
        {"id": "Strip", "outer": rect(20, 20, 600, 50)},
        {"id": "A", "outer": rect(20, 90, 160, 110), "holes": [rect(60, 130, 40, 40)]},
        {"id": "B", "outer": rect(200, 90, 160, 110)},
    ],
}


def planned(folder: Path, split: str) -> dict[str, Any]:
    (folder / "nest.json").write_text(json.dumps(NEST), encoding="utf-8")
    (folder / "plant.yaml").write_text(f"{PLASMA}cuts: {{split: {{{split}}}}}\n", encoding="utf-8")
    words = ("solve", "nest.json", "-p", "plant.yaml", "--work", "1", "--plan", "plan.json", "-o", "out.nc")
    done = kerfwise(*words)
    assert done.code == 0, done.err
    told = kerfwise("check", "nest.json", "out.nc", "--plan", "plan.json", "-p", "plant.yaml")
    assert told.code == 0, told.out
    found: dict[str, Any] = json.loads((folder / "plan.json").read_text(encoding="utf-8"))
    return found


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_strip_is_cut_in_halves_from_the_middles_of_its_long_sides(folder: Path) -> None:
    made = planned(folder, "halves: 4")
    (begun,) = (row for row in made["cuts"] if "stretch" in row)
    (rest,) = (row for row in made["cuts"] if row["contour"] == "Strip.outer" and "stretch" not in row)
    assert begun["stretch"]["way"] == "Strip.half"
    ends = [begun["stretch"]["from"], begun["stretch"]["to"]]
    assert sorted(y for _, y in ends) == pytest.approx([20 - KERF / 2, 70 + KERF / 2])
    assert all(abs(x - 320) <= 65 for x, _ in ends)
    around = 2 * (600 + 50) + math.pi * KERF
    assert begun["length_mm"] + rest["length_mm"] == pytest.approx(around + 6.0, abs=0.01)
    assert made["totals"]["pierces"] == 4


def test_what_is_cut_last_comes_when_all_parts_of_the_zone_are_begun(folder: Path) -> None:
    made = planned(folder, "last: 25 mm")
    names = [("begun " if "stretch" in row else "") + row["contour"] for row in made["cuts"]]
    begun = [k for k, name in enumerate(names) if name.startswith("begun")]
    last = [k for k, name in enumerate(names) if name in ("Strip.outer", "A.outer", "B.outer")]
    assert len(begun) == len(last) == 3
    assert max(begun) < min(last)
    lengths = [row["length_mm"] for row in made["cuts"] if row["contour"] == "B.outer" and "stretch" not in row]
    assert lengths == pytest.approx([25.0], abs=0.01)


def test_both_can_be_had_at_once_and_explain_says_why_a_last_stretch_waits(folder: Path) -> None:
    planned(folder, "halves: 4, last: 25 mm")
    told = kerfwise("explain", "nest.json", "plan.json", "B.outer", "-p", "plant.yaml", "--all")
    assert told.code == 0, told.err
    assert "B.most has cut the rest of B.outer" in told.out
    assert "last stretches come when all of the zone hang by theirs" in told.out


def test_work_goes_on_where_ways_are_still_to_be_begun(folder: Path) -> None:
    planned(folder, "halves: 4")
    words = ("--work", "1", "--lock-from", "plan.json", "--upto", "1", "-o", "rest.nc")
    done = kerfwise("solve", "nest.json", "-p", "plant.yaml", *words)
    assert done.code == 0, done.err
    assert kerfwise("check", "nest.json", "rest.nc", "-p", "plant.yaml").code == 0
