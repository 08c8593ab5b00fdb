"""Stopped anywhere and gone on: nothing is burnt twice, or left, and nothing is pierced over what was burnt before.

The old program burns as far as it has come, then the new one, in the simulation that knows neither planner nor check.
"""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given
from hypothesis import strategies as st

from kerfwise import load_profile, read_nest
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.metal.simulate import simulate
from kerfwise.tests.tools.amount import examples

PROFILE = "plasma-carbon-steel"
STREET_MM = 9.0


def plate(columns: int, rows: int, holes: list[bool]) -> str:
    """Squares of 60 mm in a grid, with streets as wide as old and new pierces want, some with a hole."""
    pitch = 60 + STREET_MM
    parts = []
    for k in range(columns * rows):
        x, y = 15 + k % columns * pitch, 15 + k // columns * pitch
        square = [[x, y], [x + 60, y], [x + 60, y + 60], [x, y + 60]]
        hole = [[x + 18, y + 30, 1], [x + 42, y + 30, 1]]
        parts.append({"id": f"P{k}", "outer": square, "holes": [hole] if holes[k] else []})
    sheet = {"width": 30 + columns * pitch, "height": 30 + rows * pitch}
    return json.dumps({"format": "kerfwise-nest/1", "units": "mm", "sheet": sheet, "parts": parts})


@pytest.mark.slow
@pytest.mark.scrap("judged here, by more than other tests")
@examples(6, suppress_health_check=list(HealthCheck))
@given(st.integers(1, 3), st.integers(1, 2), st.data())
def test_the_rest_is_burnt_once_and_on_metal(
    tmp_path_factory: pytest.TempPathFactory, columns: int, rows: int, data: st.DataObject
) -> None:
    holes = data.draw(st.lists(st.booleans(), min_size=columns * rows, max_size=columns * rows))
    folder = tmp_path_factory.mktemp("rest")
    drawn, old, new = folder / "nest.json", folder / "old.nc", folder / "new.nc"
    drawn.write_text(plate(columns, rows, holes))
    assert kerfwise("solve", drawn, "-p", PROFILE, "-o", old, "--work", "1").code == 0
    count = len(re.findall(r"^\(CUT \d+ \S+ ZONE", old.read_text(), re.MULTILINE))
    redo = data.draw(st.booleans())
    upto = data.draw(st.integers(1, count if redo else max(count - 1, 1)))
    if upto == count and not redo:
        return
    again = ["--redo-last"] if redo else []
    done = kerfwise(
        "solve", drawn, "-p", PROFILE, "--lock-from", old, "--upto", upto, *again, "-o", new, "--plan",
        folder / "new.plan.json", "--work", "1",
    )  # fmt: skip
    assert done.code == 0, done.err + done.out
    for made in (new, folder / "new.plan.json"):
        assert kerfwise("check", drawn, made, "-p", PROFILE).code == 0
    profile = load_profile(PROFILE)
    nest = read_nest(drawn, profile)
    text = new.read_text()
    found = simulate(nest, text, profile.material.kerf_mm, before=old.read_text())
    first = upto - redo
    past = [f for f in found if (of := re.search(r"kerf of cut (\d+)", str(f))) and int(of[1]) <= first]
    rest = [f for f in found if f.kind not in ("pierce-over-void", "lead-over-void", "part-eroded", "left-uncut")]
    assert not past
    assert not rest


def test_the_comparison_can_fail(tmp_path: Path) -> None:
    """The old way, all cuts again with the torch lit, is seen."""
    drawn, old = tmp_path / "nest.json", tmp_path / "old.nc"
    drawn.write_text(plate(2, 1, [True, False]))
    assert kerfwise("solve", drawn, "-p", PROFILE, "-o", old, "--work", "1").code == 0
    text = old.read_text()
    profile = load_profile(PROFILE)
    nest = read_nest(drawn, profile)
    scrap = text.replace("(MATERIAL", "(RESUME AFTER CUT 1)\n(MATERIAL", 1)
    kinds = {f.kind for f in simulate(nest, scrap, profile.material.kerf_mm, before=text)}
    assert {"resumed-wrong", "cut-twice"} & kinds
