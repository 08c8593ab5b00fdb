"""Common cuts on the command line: planned, checked against their plan, explained, drawn, and refused."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from kerfwise.tests.commands.run_cli import Ended, kerfwise

COMMON = "cuts: {common: {shortest: 20 mm, good_side: any}}\n"
LASER = f"based_on: laser-st10kp-2mm\n{COMMON}"


def rect(x: float, y: float, w: float, h: float) -> list[list[float]]:
    return [[x, y], [x + w, y], [x + w, y + h], [x, y + h]]


def nest_of(kerf_mm: float, gap_mm: float | None = None) -> dict[str, Any]:
    step = 60 + (kerf_mm if gap_mm is None else gap_mm)
    corners = [(40 + step * k, 40 + step * row) for row in range(2) for k in range(2)]
    parts = [{"id": name, "outer": rect(x, y, 60, 60)} for name, (x, y) in zip("ABCD", corners, strict=True)]
    return {"format": "kerfwise-nest/1", "units": "mm", "sheet": {"width": 220, "height": 220}, "parts": parts}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "nest.json").write_text(json.dumps(nest_of(0.2)), encoding="utf-8")
    (tmp_path / "plant.yaml").write_text(LASER, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def solve(*more: str) -> Ended:
    return kerfwise("solve", "nest.json", "-p", "plant.yaml", "--work", "0.5", *more)


def rows(folder: Path) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = json.loads((folder / "plan.json").read_text(encoding="utf-8"))["cuts"]
    return found


def test_a_grid_is_cut_with_one_pierce_and_its_program_follows_its_plan(folder: Path) -> None:
    assert solve("--plan", "plan.json", "-o", "out.nc", "--picture", "grid.svg").code == 0
    assert [("span" in row) for row in rows(folder)] == [False, True, True, True]
    assert json.loads((folder / "plan.json").read_text(encoding="utf-8"))["totals"]["pierces"] == 1
    assert "begins in an older kerf" in (folder / "grid.svg").read_text(encoding="utf-8")
    told = kerfwise("check", "nest.json", "out.nc", "--plan", "plan.json", "-p", "plant.yaml")
    assert told.code == 0, told.out
    assert "holds      hard follows-plan" in told.out
    assert kerfwise("check", "nest.json", "plan.json", "-p", "plant.yaml").code == 0


def test_explain_says_where_a_cut_begins(folder: Path) -> None:
    solve("--plan", "plan.json")
    name = rows(folder)[1]["contour"]
    told = kerfwise("explain", "nest.json", "plan.json", name, "-p", "plant.yaml")
    assert told.code == 0, told.err
    assert f"cut the rest of {name}, which begins in its kerf" in told.out
    assert "begun in a neighbour's kerf at (" in told.out


def test_explain_by_another_profile_names_that_of_the_plan(folder: Path) -> None:
    solve("--plan", "plan.json")
    told = kerfwise("explain", "nest.json", "plan.json", "A.outer")
    assert (told.code, told.out) == (2, "")
    sha256 = json.loads((folder / "plan.json").read_text(encoding="utf-8"))["profile"]["sha256"]
    assert (
        "nest.json: the profile is not the one the plan was made with (its sha256 differs): this is "
        f"'plasma-carbon-steel', that was 'plant', whose sha256 begins {sha256[:12]}: give it with -p (in Python "
        "profile=); by this one it cannot be explained: "
    ) in told.err
    assert "A.outer and B.outer" in told.err


TABS = "rules: {hold-small-parts: {strength: hard, tabs: nest}}\n"


@pytest.mark.parametrize("tabbed", [True, False])
def test_groups_that_tabs_hold_are_named(folder: Path, tabbed: bool) -> None:
    nest = nest_of(0.2)
    nest["sheet"]["width"] = 400
    nest["parts"] += [{"id": name, "outer": rect(x, 40, 60, 60)} for name, x in (("E", 250), ("F", 310.2))]
    if tabbed:
        nest["parts"][1]["tabs"] = [{"at": [130.2, 40]}]
    (folder / "nest.json").write_text(json.dumps(nest), encoding="utf-8")
    (folder / "plant.yaml").write_text(LASER + TABS, encoding="utf-8")
    told = solve("--plan", "plan.json")
    assert told.code == 0, told.err
    notes = [line for line in told.err.splitlines() if line.startswith("note: cuts.common")]
    along_edges = {row["contour"][0] for row in rows(folder) if "span" in row}
    assert bool(along_edges & set("ABCD")) != tabbed
    assert along_edges & set("EF")
    assert notes == (
        [
            "note: cuts.common: no common cuts for A.outer, B.outer, C.outer, D.outer: tabs hold B.outer, and parts "
            "that hang together by common edges are all cut all round where tabs hold one of them; without tabs on "
            "these their edges are cut once"
        ]
        if tabbed
        else []
    )


def test_a_program_pierces_as_often_as_its_plan_by_the_clock(folder: Path) -> None:
    """Where cuts begin in older kerfs nothing is pierced, and no consumables are worn."""
    solve("--plan", "plan.json", "-o", "out.nc")
    told = [kerfwise("time", "nest.json", what, "-p", "plant.yaml") for what in ("plan.json", "out.nc")]
    pierces = [[line.split() for line in one.out.splitlines() if line.startswith("pierce")] for one in told]
    assert pierces[0] == pierces[1]
    assert pierces[0][0][-2:] == ["1", "pierces"]
    assert "by its own words" not in told[1].err


def test_time_and_heat_read_plan_and_program(folder: Path) -> None:
    solve("--plan", "plan.json", "-o", "out.nc")
    for verb in ("time", "heat"):
        for what in ("plan.json", "out.nc"):
            told = kerfwise(verb, "nest.json", what, "-p", "plant.yaml")
            assert told.code == 0, told.err


def test_a_direction_is_locked(folder: Path) -> None:
    (folder / "plant.yaml").write_text(f"{LASER}locks: [{{contour: C.outer, direction: ccw}}]\n", encoding="utf-8")
    assert solve("--plan", "plan.json").code == 0
    assert [row["direction"] for row in rows(folder) if row["contour"] == "C.outer"] == ["ccw"]


PLASMA = "based_on: plasma-carbon-steel\n"


@pytest.mark.parametrize(
    ("profile", "kerf_mm", "gap_mm", "said"),
    [
        (
            f"{PLASMA}machine: {{kerf_start: false}}\ncuts: {{common: {{shortest: 20}}}}\n",
            1.5,
            None,
            "leaves outer contours one direction",
        ),
        (f"{PLASMA}{COMMON}", 1.5, None, "machine.kerf_start: a control that holds the pierce delay itself"),
        (
            "based_on: laser-st10kp-2mm\ncuts: {common: {shortest: 20, gap_tolerance: 0.2}}\n",
            0.2,
            None,
            "cuts.common.gap_tolerance: 0.2 mm is more than a torch may be off at this kerf, 0.05 mm",
        ),
        (f"based_on: oxyfuel-thick-plate\n{COMMON}", 1.5, None, "a flame has to heat the edge of a kerf"),
        ("based_on: laser-st10kp-2mm\ncuts: {common: {shortest: yes}}\n", 0.2, None, "or the word 'off'"),
        (f"{LASER}corners: {{feed: 50%}}\n", 0.2, None, "corner"),
        (LASER, 0.2, 0.0, "touch"),
        (LASER, 0.2, 0.1, "0.100 mm apart"),
    ],
)
def test_what_cannot_be_cut_so_is_said_in_one_message(
    folder: Path, profile: str, kerf_mm: float, gap_mm: float | None, said: str
) -> None:
    (folder / "nest.json").write_text(json.dumps(nest_of(kerf_mm, gap_mm)), encoding="utf-8")
    (folder / "plant.yaml").write_text(profile, encoding="utf-8")
    ended = solve("--plan", "plan.json", "-o", "out.nc")
    assert ended.code in (1, 2)
    assert said in ended.err, ended.err
    assert "Traceback" not in ended.err
    assert not (folder / "plan.json").exists()


@pytest.mark.parametrize("more", [(), ("--redo-last",)])
@pytest.mark.parametrize("old", ["old.json", "old.nc"])
def test_a_program_with_common_cuts_is_gone_on_with(folder: Path, old: str, more: tuple[str, ...]) -> None:
    solve("--plan", "old.json", "-o", "old.nc")
    ended = solve("--lock-from", old, "--upto", "2", *more, "--plan", "plan.json", "-o", "out.nc")
    assert ended.code == 0, ended.err
    assert all("span" in row for row in rows(folder))
    assert len(rows(folder)) == (3 if more else 2)
    assert kerfwise("check", "nest.json", "out.nc", "--plan", "plan.json", "-p", "plant.yaml").code == 0


@pytest.mark.slow
@pytest.mark.minizinc
def test_minizinc_goes_on_at_the_same_cost(folder: Path) -> None:
    """MiniZinc takes work for seconds by the clock: it is given far more than it needs, and ends with its proof."""
    solve("--plan", "old.json")
    costs = []
    for engine in ("portfolio", "minizinc"):
        more = ("--engine", engine, "--work", "600", "--plan", "plan.json")
        assert solve("--lock-from", "old.json", "--upto", "1", *more).code == 0
        costs.append(json.loads((folder / "plan.json").read_text(encoding="utf-8"))["solve"]["objective"])
    assert costs[0] == pytest.approx(costs[1], abs=0.01)


def test_what_neighbours_that_are_out_leave_in_pieces_is_said(folder: Path) -> None:
    """A and B, to the left and to the right of L, were cut by an old program, one by one; now edges are common."""
    apart = nest_of(0.2)
    boxes = {"A": rect(40, 40, 50, 60), "L": rect(90.2, 30, 40, 90), "B": rect(130.4, 40, 50, 60)}
    apart["parts"] = [{"id": name, "outer": outer} for name, outer in boxes.items()]
    (folder / "nest.json").write_text(json.dumps(apart), encoding="utf-8")
    (folder / "plant.yaml").write_text("based_on: laser-st10kp-2mm\nlocks: [{contour: L.outer, position: 3}]\n")
    assert solve("--plan", "old.json").code == 0
    (folder / "plant.yaml").write_text(LASER, encoding="utf-8")
    ended = solve("--lock-from", "old.json", "--upto", "2", "-o", "out.nc")
    assert ended.code == 2
    assert "L.outer: neighbours with common edges are out, and leave several stretches of it" in ended.err
    assert not (folder / "out.nc").exists()


def test_an_order_that_leaves_two_stretches_is_a_conflict_with_a_way_out(folder: Path) -> None:
    """A and B stand apart on the left, and come before L on the right by a hard rule; L is beside both."""
    apart = nest_of(0.2)
    boxes = {"A": rect(40, 40, 60, 60), "B": rect(40, 110, 60, 60), "L": rect(100.2, 40, 60, 130)}
    apart["parts"] = [{"id": name, "outer": outer} for name, outer in boxes.items()]
    (folder / "nest.json").write_text(json.dumps(apart), encoding="utf-8")
    ended = solve("--plan", "plan.json")
    assert ended.code == 1
    assert "common-cuts: L.outer is cut all round with A.outer, B.outer still in" in ended.err
    assert "relax level-ahead: 1 statement" in ended.err
    assert "note: cuts.common asks for common cuts; without them (cuts: {common: {shortest: off}})" in ended.err
    assert kerfwise("solve", "nest.json", "-p", "laser-st10kp-2mm", "--set", "cuts.common.shortest=off").code == 0
    assert solve("--plan", "plan.json", "--relax").code == 0
    assert sum("span" in row for row in rows(folder)) == 2


def test_a_part_that_fills_a_hook_is_cut_all_round_and_so_is_the_hook(folder: Path) -> None:
    """The hook comes after what it holds, and would have its round inner corners left; D and E share their edge."""
    hook = [[40, 40], [120, 40], [120, 50], [50, 50], [50, 90], [120, 90], [120, 100], [40, 100]]
    apart = nest_of(1.5)
    boxes = {"G": rect(51.5, 51.5, 68.5, 37), "D": rect(140, 40, 30, 60), "E": rect(171.5, 40, 20, 60)}
    (folder / "plant.yaml").write_text(f"{LASER}material: {{kerf: 1.5 mm}}\n", encoding="utf-8")
    apart["parts"] = [{"id": "C", "outer": hook}, *({"id": k, "outer": outer} for k, outer in boxes.items())]
    (folder / "nest.json").write_text(json.dumps(apart), encoding="utf-8")
    ended = solve("--plan", "plan.json")
    assert ended.code == 0, ended.err
    assert "no common cuts for C.outer, G.outer: in any order that cuts parts in the concavity of another" in ended.err
    spans = {row["contour"]: "span" in row for row in rows(folder)}
    assert [name for name in ("C.outer", "G.outer") if spans[name]] == []
    assert spans["D.outer"] != spans["E.outer"]
    free = ("--set", "rules.hull-before=off", "--set", "rules.level-ahead=off")
    loose = solve("--plan", "plan.json", *free)
    assert loose.code == 0, loose.err
    assert sum("span" in row for row in rows(folder)) == 2
