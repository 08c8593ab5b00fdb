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


def planned(folder: Path, split: str, nest: dict[str, Any] = NEST, plant: str = PLASMA) -> dict[str, Any]:
    (folder / "nest.json").write_text(json.dumps(nest), encoding="utf-8")
    (folder / "plant.yaml").write_text(f"{plant}cuts: {{split: {{{split}}}}}\n", encoding="utf-8")
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


LASER = "based_on: laser-st10kp-2mm\n"
PAIR = {
    "format": "kerfwise-nest/1",
    "sheet": {"width": 360, "height": 160},
    "parts": [
        {"id": "A", "outer": rect(20, 40, 100, 80)},
        {"id": "B", "outer": rect(120.2, 40, 100, 80)},
        {"id": "C", "outer": rect(260, 40, 60, 60)},
    ],
}


def test_the_edge_that_two_parts_share_is_cut_when_both_hang_by_a_last_stretch(folder: Path) -> None:
    made = planned(folder, "last: 15 mm, shared_last: true", PAIR, LASER)
    way = [row for row in made["cuts"] if row.get("stretch", {}).get("way") == "A.pair"]
    assert {row["contour"] for row in way} == {"A.outer", "B.outer"}
    orders = [row["order"] for row in made["cuts"] if "stretch" in row]
    assert orders == [1, 1, 1], "all that hangs comes before all that is cut last"
    last = {row["contour"]: row for row in made["cuts"] if "stretch" not in row and row["contour"] != "C.outer"}
    begun_mm = sum(row["length_mm"] for row in way) - math.dist(*way[0]["lead_in"])
    rest_mm = sum(row["length_mm"] for row in last.values())
    # two sides of 200.2 mm, three of 80 mm, and a round of half a kerf at each of six corners, give or take two more
    around_mm = 2 * 200.2 + 3 * 80 + 6 * math.pi / 2 * 0.1
    assert begun_mm + rest_mm == pytest.approx(around_mm, abs=0.5)
    first, second = sorted(last.values(), key=lambda row: row["order"])
    assert first["length_mm"] > 80 > second["length_mm"], (
        "whichever is cut first has the shared edge in its last stretch"
    )
    assert made["totals"]["pierces"] == 2


def test_parts_whose_shared_edge_comes_last_must_hang_by_something(folder: Path) -> None:
    (folder / "nest.json").write_text(json.dumps(PAIR), encoding="utf-8")
    (folder / "plant.yaml").write_text(LASER + "cuts: {split: {shared_last: true}}\n", encoding="utf-8")
    done = kerfwise("solve", "nest.json", "-p", "plant.yaml", "-o", "out.nc")
    assert done.code == 2
    assert "hang by a last stretch each (shared_last): say cuts: {split: {last: 25 mm}}" in done.err


def test_a_last_stretch_no_longer_than_the_lead_is_not_taken_for_cut(folder: Path) -> None:
    """The lead of the flame makes up the length that is left: the check took the first burn for the whole round."""
    alone = {"format": "kerfwise-nest/1", "sheet": {"width": 300, "height": 200}, "parts": [NEST["parts"][2]]}  # type: ignore[index]
    alone["parts"][0] = {"id": "E", "outer": rect(80, 60, 50, 50)}  # type: ignore[index]
    made = planned(folder, "last: 12 mm", alone, "based_on: oxyfuel-thick-plate\nmachine: {edge_preheat: 1 s}\n")
    assert [("stretch" in row) for row in made["cuts"]] == [True, False]


def test_a_price_may_be_that_of_a_way(folder: Path) -> None:
    """A plan that says what a way costs was taken for one of another nest."""
    made = planned(folder, "last: 25 mm}, common: {good_side: any")
    names = {name for row in made["prices"]["breaches"] for name in row["contours"]}
    assert any(name.endswith(".most") for name in names)
