"""Controls that count in tenths of a millimetre: our own programs are read back, tabs and all, and re-ordered."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.nest_file import nest_file
from kerfwise.tests.tools.amount import few

pytestmark = pytest.mark.scrap("steps of 0.1 mm take up to 0.08 mm of a round part, and the simulation allows 0.05 mm")
NESTS = Path(__file__).parents[2] / "examples/nests"
TABS = "rules: {hold-small-parts: {strength: hard, tabs: all}}"
ASKED = {
    "plain": "",
    "corners": "corners: {corner_feed: 0.7, corner_reach: 3 mm}",
    "tabs": TABS,
    "tabs and arcs": f"{TABS}\nleads: {{lead: arc, lead_out: line}}",
    "tabs and corners": f"{TABS}\ncorners: {{corner_feed: 0.7, corner_reach: 3 mm}}",
    "tabs and links": f"{TABS}\ncuts: {{links: {{longest: 60 mm}}}}",
}


def disc(x: float, y: float, radius: float) -> list[list[float]]:
    return [[x - radius, y, 1], [x + radius, y, 1]]


def small_parts() -> list[dict[str, Any]]:
    """Houses and rings at places that are no tenths of a millimetre."""
    houses = [
        {
            "id": f"S{k}",
            "outer": [[x + 20, 23.37], [x + 60.03, 23.37], [x + 60.03, 55.21], [x + 40, 70.77], [x + 20, 55.2]],
        }
        for k, x in ((k, 70 * k) for k in range(3))
    ]
    rings = [
        {"id": f"D{k}", "outer": disc(x, 120.07, 22.13), "holes": [disc(x, 120.07, 9.01)]}
        for k, x in ((k, 45.03 + 70 * k) for k in range(3))
    ]
    return [*houses, *rings]


@pytest.mark.slow
@pytest.mark.parametrize("base", few(["plasma-carbon-steel", "oxyfuel-thick-plate"]))
@pytest.mark.parametrize("asked", few(sorted(ASKED, key=len, reverse=True), 3))
def test_what_is_written_is_read_back_and_put_in_order(asked: str, base: str, tmp_path: Path) -> None:
    nest = nest_file(tmp_path / "small.json", small_parts(), (400, 180))
    plant = tmp_path / "plant.yaml"
    head = f"based_on: {base}\nmachine: {{dialect: essi, accept_dialect: true}}\nsmall_holes: {{min_hole: 1 mm}}\n"
    plant.write_text(head + ASKED[asked], encoding="utf-8")
    program, plan = tmp_path / "out.nc", tmp_path / "out.plan.json"
    made = kerfwise("solve", nest, "-p", plant, "--work", "0.05", "-o", program, "--plan", plan)
    assert made.code == 0, made.out[-1500:]
    tabs = [cut for cut in json.loads(plan.read_text())["cuts"] if cut.get("tabs")]
    assert len(tabs) == (6 if "tabs" in asked else 0)
    for words in ((), ("--plan", plan)):
        assert kerfwise("check", nest, program, "-p", plant, *words).code == 0
    again = kerfwise("resequence", program, "-p", plant, "-o", tmp_path / "new.nc", "--work", "0.05")
    assert again.code == 0, again.err
    assert "would break" not in again.out
    assert kerfwise("check", nest, tmp_path / "new.nc", "-p", plant).code == 0


def test_a_drawing_in_thousandths_is_put_in_order_by_rules(tmp_path: Path) -> None:
    plant = tmp_path / "plant.yaml"
    plant.write_text("based_on: plasma-carbon-steel\nmachine: {dialect: essi}\n", encoding="utf-8")
    program = tmp_path / "out.nc"
    assert kerfwise("solve", NESTS / "e1x_6.json", "-p", plant, "--work", "0.05", "-o", program).code == 0
    again = kerfwise("resequence", program, "-p", plant, "-o", tmp_path / "new.nc", "--work", "0.05")
    assert (again.code, "would break" in again.out) == (0, False), again.err


@pytest.mark.parametrize("dialect", ["essi", "burny"])
def test_tabs_that_nobody_could_tell_from_ends_of_cuts_are_refused(dialect: str, tmp_path: Path) -> None:
    plant = tmp_path / "plant.yaml"
    text = f"based_on: laser-st10kp-2mm\nmachine: {{dialect: {dialect}, accept_dialect: true}}\n{TABS}\n"
    plant.write_text(text, encoding="utf-8")
    ended = kerfwise("profile", "check", plant)
    assert ended.code == 2
    assert "so that nobody could tell tabs from ends of cuts" in ended.err
