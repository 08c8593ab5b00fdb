"""Chains on the command line: planned, explained, locked out, gone on with after a stop, and drawn."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from kerfwise.tests.commands.run_cli import Ended, kerfwise

LINKS = "based_on: plasma-carbon-steel\nmachine: {pierce_time: 2 s}\ncuts: {links: {longest: 60 mm}}\n"


def rect(x: float, y: float, w: float, h: float) -> list[list[float]]:
    return [[x, y], [x + w, y], [x + w, y + h], [x, y + h]]


NEST = {
    "format": "kerfwise-nest/1",
    "units": "mm",
    "sheet": {"width": 400, "height": 260},
    "parts": [
        {"id": "A", "outer": rect(60, 100, 60, 60)},
        {"id": "B", "outer": rect(132, 100, 60, 60)},
        {"id": "C", "outer": rect(204, 100, 60, 60)},
        {"id": "D", "outer": rect(276, 100, 60, 60)},
    ],
}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "nest.json").write_text(json.dumps(NEST), encoding="utf-8")
    (tmp_path / "plant.yaml").write_text(LINKS, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def solve(*more: str, profile: str = "plant.yaml") -> Ended:
    return kerfwise("solve", "nest.json", "-p", profile, "--work", "0.5", "--plan", "plan.json", "-o", "out.nc", *more)


def plan_in(folder: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder / "plan.json").read_text(encoding="utf-8"))
    return found


def linked(folder: Path) -> list[str]:
    return [row["contour"] for row in plan_in(folder)["cuts"] if row.get("linked")]


def test_a_chain_is_planned_and_its_program_follows_its_plan(folder: Path) -> None:
    assert solve().code == 0
    assert linked(folder)
    assert plan_in(folder)["totals"]["pierces"] == 4 - len(linked(folder))
    told = kerfwise("check", "nest.json", "out.nc", "--plan", "plan.json", "-p", "plant.yaml")
    assert told.code == 0, told.out
    assert "holds      hard follows-plan" in told.out


def test_explain_says_that_a_cut_is_linked(folder: Path) -> None:
    solve()
    name = linked(folder)[0]
    told = kerfwise("explain", "nest.json", "plan.json", name, "-p", "plant.yaml").out
    assert f"to {name} the torch may stay on for" in told
    assert ", on the link" in told


def test_a_lock_rules_a_link_out(folder: Path) -> None:
    solve()
    first = linked(folder)
    (folder / "locked.yaml").write_text(
        "based_on: plant.yaml\nlocks:\n" + "".join(f"  - {{contour: {name}, linked: false}}\n" for name in first),
        encoding="utf-8",
    )
    assert solve(profile="locked.yaml").code == 0
    assert not set(first) & set(linked(folder))
    assert kerfwise("check", "nest.json", "plan.json", "-p", "locked.yaml").code == 0


def test_no_link_can_be_asked_for(folder: Path) -> None:
    (folder / "wrong.yaml").write_text("based_on: plant.yaml\nlocks: [{contour: A.outer, linked: true}]\n")
    told = solve(profile="wrong.yaml")
    assert told.code == 2
    assert "a link can be ruled out, not asked for" in told.err
    assert not (folder / "out.nc").exists()


@pytest.mark.slow
def test_work_goes_on_in_the_middle_of_a_chain(folder: Path) -> None:
    solve()
    row = next(row for row in plan_in(folder)["cuts"] if row.get("linked"))
    (folder / "old.nc").write_text((folder / "out.nc").read_text(encoding="utf-8"), encoding="utf-8")
    for upto in (row["order"] - 1, row["order"]):
        rest = ("--lock-from", "old.nc", "--upto", str(upto))
        assert solve(*rest).code == 0
        cuts = plan_in(folder)["cuts"]
        assert len(cuts) == 4 - upto
        assert not cuts[0].get("linked")
        told = kerfwise("check", "nest.json", "out.nc", "-p", "plant.yaml")
        assert told.code == 0, told.out
    assert "LINK IN" in (folder / "out.nc").read_text(encoding="utf-8")


def test_pictures_and_times_know_chains(folder: Path) -> None:
    solve()
    assert kerfwise("plot", "nest.json", "plan.json", "-p", "plant.yaml", "-o", "plan.svg").code == 0
    assert (folder / "plan.svg").read_text(encoding="utf-8").count("<circle") >= 1
    assert f"{4 - len(linked(folder))} pierces" in kerfwise("time", "nest.json", "out.nc", "-p", "plant.yaml").out


def test_waits_for_metal_to_cool_leave_no_links(folder: Path) -> None:
    text = LINKS + "rules:\n  t-max: {strength: hard, limit: 900 °C, dwells: true}\n"
    (folder / "cool.yaml").write_text(text, encoding="utf-8")
    told = solve(profile="cool.yaml")
    assert told.code == 0, told.err
    assert linked(folder) == []


def test_a_length_below_nothing_is_refused(folder: Path) -> None:
    (folder / "wrong.yaml").write_text("cuts: {links: {longest: -3 mm}}\n", encoding="utf-8")
    told = solve(profile="wrong.yaml")
    assert (told.code, told.err.count("\n")) == (2, 1)
    assert "cuts.links.longest" in told.err


@pytest.mark.parametrize(
    "lag", ["{strength: hard, heat_radius: 61.6 mm}", "{strength: soft, heat_radius: 80 mm, lag: 5 s}"]
)
def test_links_that_a_lag_of_heat_leaves_none_of_are_refused(folder: Path, lag: str) -> None:
    (folder / "plant.yaml").write_text(f"{LINKS}rules: {{heat-lag: {lag}}}\n", encoding="utf-8")
    told = solve()
    assert (told.code, told.err.count("\n")) == (2, 1)
    assert told.err.startswith("kerfwise: plant.yaml:4:")
    assert "rules.heat-lag.heat_radius: links of up to 60 mm join parts nearer than" in told.err
    assert sorted(file.name for file in folder.iterdir()) == ["nest.json", "plant.yaml"]


def test_links_that_just_reach_beyond_a_lag_of_heat_are_found(folder: Path) -> None:
    """A link begins and ends half a kerf from a contour, so that it is a kerf shorter than the way between two."""
    plant = LINKS.replace("60 mm", "30 mm") + "rules: {heat-lag: {strength: hard, heat_radius: 30 mm}}\n"
    (folder / "plant.yaml").write_text(plant, encoding="utf-8")
    parts = [{"id": name, "outer": rect(x, 100, 60, 60)} for name, x in (("A", 60), ("B", 151))]
    (folder / "nest.json").write_text(json.dumps(NEST | {"parts": parts}), encoding="utf-8")
    told = solve()
    assert told.code == 0, told.err
    assert len(linked(folder)) == 1


def test_links_and_a_hard_lag_of_heat_are_a_named_conflict_where_no_order_keeps_it(folder: Path) -> None:
    """Links may be longer than heat reaches; the parts of this row are nearer than that."""
    (folder / "plant.yaml").write_text(LINKS + "rules: {heat-lag: {strength: hard}}\n", encoding="utf-8")
    told = solve()
    assert told.code == 1
    assert "heat-lag: between A.outer and B.outer there must be at least 1 other cut: they heat each other" in told.err
    assert not (folder / "out.nc").exists()


@pytest.mark.parametrize(
    ("more", "why"),
    [
        ("rules: {t-max: {strength: hard, limit: 1300 °C, dwells: true}}\n", "the rule t-max lets metal cool"),
        ("corners: {corner_feed: 0.5}\n", "corners are cut more slowly"),
        ("", "links would cut metal off the skeleton"),
    ],
)
def test_why_there_are_no_links_is_said(folder: Path, more: str, why: str) -> None:
    (folder / "plant.yaml").write_text(LINKS + more, encoding="utf-8")
    if not more:
        drawn = NEST | {"scrap": [[[20, 0], [20, 260]]]}
        (folder / "nest.json").write_text(json.dumps(drawn), encoding="utf-8")
    told = solve()
    assert told.code == 0, told.err
    assert f"note: cuts.links: the torch stays on nowhere: {why}" in told.err
    assert linked(folder) == []
