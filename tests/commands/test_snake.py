"""Snakes on the command line: rows cut out along one side and back along the other, checked, explained, refused."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest

import kerfwise as package
from kerfwise.tests.commands.run_cli import Ended, kerfwise

ROOT = Path(package.__file__).resolve().parent
PLASMA = "based_on: plasma-carbon-steel\nmachine: {pierce_dwell: program}\n"
LASER = "based_on: laser-st10kp-2mm\n"
SNAKE = "cuts: {snake: {gap: 20 mm}}\n"


def nest_of(gap_mm: float, parts: int = 8, low: tuple[float, ...] = (0.0,)) -> dict[str, Any]:
    """A row of rectangles 80 × 60 mm, each as much lower or higher as its turn in `low` says."""
    rows = []
    for k in range(parts):
        x, y = 20 + (80 + gap_mm) * k, 20 + low[k % len(low)]
        rows.append({"id": f"P{k + 1}", "outer": [[x, y], [x + 80, y], [x + 80, y + 60], [x, y + 60]]})
    return {"format": "kerfwise-nest/1", "units": "mm", "sheet": {"width": 760, "height": 200}, "parts": rows}


def write(folder: Path, nest: dict[str, Any], profile: str) -> None:
    (folder / "nest.json").write_text(json.dumps(nest), encoding="utf-8")
    (folder / "plant.yaml").write_text(profile, encoding="utf-8")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def solve(*more: str) -> Ended:
    return kerfwise("solve", "nest.json", "-p", "plant.yaml", "--work", "0.5", "--plan", "plan.json", *more)


def plan(folder: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder / "plan.json").read_text(encoding="utf-8"))
    return found


def test_a_row_of_eight_takes_one_pierce_and_the_length_known_by_hand(folder: Path) -> None:
    write(folder, nest_of(10.0), PLASMA + SNAKE)
    done = solve("-o", "out.nc", "--picture", "row.svg")
    assert done.code == 0, done.err
    made = plan(folder)
    # each ring once: two sides of 80 and 60 mm and a quarter round of half a kerf at each corner; 7 gaps; the lead
    by_hand = 8 * (2 * (80 + 60) + 2 * math.pi * 0.75) + 7 * 10.0 + 6.0
    assert made["totals"]["pierces"] == 1
    assert made["totals"]["cut_mm"] == pytest.approx(by_hand, abs=0.01)
    begun, cuts = ([row for row in made["cuts"] if ("stretch" in row) == is_begun] for is_begun in (True, False))
    assert [row["order"] for row in begun] == [1] * 8
    assert [row.get("linked", False) for row in begun] == [False] + [True] * 7
    assert {row["stretch"]["way"] for row in begun} == {"snake1"}
    assert [row["order"] for row in cuts] == list(range(1, 9))
    assert all("span" in row for row in cuts)
    assert {row["contour"] for row in begun} == {row["contour"] for row in cuts}
    assert "stretch cut before the rest" in (folder / "row.svg").read_text(encoding="utf-8")
    program = (folder / "out.nc").read_text(encoding="utf-8")
    assert program.count("M3 $0 S1") == 9
    assert program.count("G4 P0.5") == 1
    assert program.index("(STRETCH snake1 P1.outer ZONE 1 CW)") < program.index("(CUT 1 P1.outer ZONE 1 CW)")


def test_program_and_plan_pass_the_check_and_the_program_follows_the_plan(folder: Path) -> None:
    write(folder, nest_of(10.0, 4), LASER + SNAKE)
    assert solve("-o", "out.nc").code == 0
    told = kerfwise("check", "nest.json", "out.nc", "--plan", "plan.json", "-p", "plant.yaml")
    assert told.code == 0, told.out
    assert "holds      hard follows-plan" in told.out
    assert kerfwise("check", "nest.json", "plan.json", "-p", "plant.yaml").code == 0
    other = plan(folder)
    other["cuts"] = [row for row in other["cuts"] if row["contour"] != "P2.outer" or "stretch" not in row]
    (folder / "plan.json").write_text(json.dumps(other), encoding="utf-8")
    assert "P2.outer is not cut all along" in kerfwise("check", "nest.json", "plan.json", "-p", "plant.yaml").out


def test_parts_a_kerf_apart_share_their_edges(folder: Path) -> None:
    write(folder, nest_of(0.2), LASER + SNAKE)
    assert solve("-o", "out.nc").code == 0
    totals = plan(folder)["totals"]
    # both long sides of the row, 9 lines across, the lead, and rounds of a tenth of a millimetre
    assert totals["pierces"] == 1
    assert totals["cut_mm"] == pytest.approx(2 * (8 * 80 + 7 * 0.2) + 9 * 60 + 6.0, abs=2.0)


def test_sides_that_are_not_in_line_are_joined_square_over_the_gap(folder: Path) -> None:
    write(folder, nest_of(12.0, 5, (0.0, 9.0, 3.0)), LASER + SNAKE)
    done = solve("-o", "out.nc")
    assert done.code == 0, done.err
    made = plan(folder)
    links = [row["lead_in"] for row in made["cuts"] if row.get("linked")]
    assert len(links) == 4
    assert all(link[0][1] == pytest.approx(link[1][1], abs=1e-4) for link in links)
    assert made["totals"]["pierces"] == 1


def test_a_grid_takes_one_pierce_and_the_length_known_by_hand(folder: Path) -> None:
    """Out along the outer side of the first row, up at its end, back along the second, and along the third."""
    rows = []
    for k in range(12):
        x, y = 20 + 90 * (k % 4), 20 + 72 * (k // 4)
        rows.append({"id": f"P{k + 1}", "outer": [[x, y], [x + 80, y], [x + 80, y + 60], [x, y + 60]]})
    nest = {"format": "kerfwise-nest/1", "sheet": {"width": 400, "height": 256}, "parts": rows}
    write(folder, nest, PLASMA + SNAKE.replace("20 mm", "20 mm, rows: 3"))
    done = solve("-o", "out.nc")
    assert done.code == 0, done.err
    made = plan(folder)
    begun = [row for row in made["cuts"] if "stretch" in row]
    lead_mm = math.dist(*begun[0]["lead_in"])
    by_hand = 12 * (2 * (80 + 60) + 2 * math.pi * 0.75) + 9 * 10.0 + 2 * 12.0 + lead_mm
    assert made["totals"]["pierces"] == 1
    assert made["totals"]["cut_mm"] == pytest.approx(by_hand, abs=0.01)
    assert len(begun) == 12
    assert {row["stretch"]["way"] for row in begun} == {"snake1"}
    assert len({row["direction"] for row in begun}) == 1, "all the same way round"
    assert kerfwise("check", "nest.json", "out.nc", "--plan", "plan.json", "-p", "plant.yaml").code == 0
    write(folder, nest, PLASMA + SNAKE.replace("20 mm", "20 mm, rows: 2"))
    assert solve().code == 0
    assert plan(folder)["totals"]["pierces"] == 2, "two rows, and one"


def test_a_row_that_no_other_row_s_end_faces_has_a_way_of_its_own(folder: Path) -> None:
    rows = []
    for k, (x, y) in enumerate([(20, 20), (110, 20), (20, 110), (110, 110)]):
        rows.append({"id": f"P{k + 1}", "outer": [[x, y], [x + 80, y], [x + 80, y + 60], [x, y + 60]]})
    nest = {"format": "kerfwise-nest/1", "sheet": {"width": 400, "height": 256}, "parts": rows}
    write(folder, nest, LASER + SNAKE.replace("20 mm", "20 mm, rows: 2"))
    assert solve().code == 0
    assert {row["stretch"]["way"] for row in plan(folder)["cuts"] if "stretch" in row} == {"snake1", "snake2"}


def test_explain_and_pictures_know_stretches(folder: Path) -> None:
    write(folder, nest_of(10.0, 3), LASER + SNAKE)
    solve()
    told = kerfwise("explain", "nest.json", "plan.json", "P2.outer", "-p", "plant.yaml")
    assert told.code == 0, told.err
    assert "snake1 has cut the rest of P2.outer" in told.out
    assert "snake1 is cut before P2.outer" in told.out
    for name in ("row.png", "row.html"):
        assert kerfwise("plot", "nest.json", "plan.json", "-o", name, "-p", "plant.yaml").code == 0


def test_rows_with_wider_gaps_are_cut_as_ever(folder: Path) -> None:
    write(folder, nest_of(25.0, 4), LASER + SNAKE)
    assert solve().code == 0
    assert not any("stretch" in row for row in plan(folder)["cuts"])
    assert plan(folder)["totals"]["pierces"] == 4


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ("rules: {hold-small-parts: {strength: hard, tabs: all}}\n", "a part that tabs hold is cut in one round"),
        ("corners: {corner_feed: 0.5}\n", "slower corners are counted for whole rounds"),
        ("objective: {heat: 5}\nheat: {absorbed_power_w: 500}\n", "the price of heat is simulated for whole rounds"),
        ("rules: {heat-lag: {strength: hard}}\n", "a snake (cuts.snake) runs along its parts one after the other"),
        ("rules: {t-max: {strength: hard}}\n", "t-max simulates whole rounds"),
        ("machine: {torches: {count: 2, spacing: 200 mm}, dialect: linuxcnc}\n", "stretches are planned for one torch"),
    ],
)
def test_what_does_not_go_with_snakes_is_refused_in_one_sentence(folder: Path, more: str, said: str) -> None:
    write(folder, nest_of(10.0, 3), LASER + SNAKE + more)
    done = solve("-o", "out.nc")
    assert done.code == 2, done.out
    assert said in done.err
    assert not (folder / "out.nc").exists()
    assert said in kerfwise("profile", "check", "plant.yaml").err


@pytest.mark.parametrize(
    ("cuts", "said"),
    [
        ("pierce_pass: zone", "what is left of a part begins at no hole"),
        ("scrap: {grid: 200 mm}", "a way over the gaps of a row may cut metal off in which scrap lines are cut"),
    ],
)
def test_cuts_that_do_not_go_together_are_refused(folder: Path, cuts: str, said: str) -> None:
    write(folder, nest_of(10.0, 3), f"{LASER}cuts: {{snake: {{gap: 20 mm}}, {cuts}}}\n")
    done = solve()
    assert done.code == 2
    assert said in done.err


@pytest.mark.parametrize("old", ["plan.json", "out.nc"])
def test_a_stopped_snake_goes_on_along_what_is_left(folder: Path, old: str) -> None:
    write(folder, nest_of(10.0, 4), LASER + SNAKE)
    assert solve("-o", "out.nc").code == 0
    words = ("--work", "0.5", "--lock-from", old, "--upto", "2", "-o", "rest.nc", "--plan", "rest.json")
    done = kerfwise("solve", "nest.json", "-p", "plant.yaml", *words)
    assert done.code == 0, done.err
    rest = json.loads((folder / "rest.json").read_text(encoding="utf-8"))
    assert rest["resumed_after"] == 2
    assert rest["totals"]["pierces"] == 0
    assert [row["order"] for row in rest["already_cut"] if "stretch" not in row] == [1, 2]
    assert len([row for row in rest["already_cut"] if "stretch" in row]) == 4
    assert not any("stretch" in row for row in rest["cuts"])
    assert (folder / "rest.nc").read_text(encoding="utf-8").count("BEFORE 1 ") == 4
    for words in (("rest.nc",), ("rest.nc", "--plan", "rest.json"), ("rest.json",)):
        told = kerfwise("check", "nest.json", *words, "-p", "plant.yaml")
        assert told.code == 0, told.out
    lost = (folder / "rest.nc").read_text(encoding="utf-8").replace("BEGUN 1 BEFORE 1", "LOST")
    (folder / "lost.nc").write_text(lost, encoding="utf-8")
    assert kerfwise("check", "nest.json", "lost.nc", "-p", "plant.yaml").code == 1


def test_a_cut_that_finishes_what_was_begun_cannot_be_made_again(folder: Path) -> None:
    write(folder, nest_of(10.0, 3), LASER + SNAKE)
    solve()
    words = ("--lock-from", "plan.json", "--upto", "2", "--redo-last")
    done = kerfwise("solve", "nest.json", "-p", "plant.yaml", *words)
    assert done.code == 2
    assert "which was begun before, and cannot be made again" in done.err


def test_parts_near_others_that_are_not_in_the_row_are_cut_as_ever(folder: Path) -> None:
    nest = nest_of(10.0, 4)
    nest["parts"].append({"id": "Near", "outer": [[20, 80.39], [360, 80.39], [360, 110], [20, 110]]})
    write(folder, nest, LASER + SNAKE)
    assert solve().code == 0
    assert not any("stretch" in row for row in plan(folder)["cuts"])
