"""Parts a kerf apart, or that touch: it is asked whether one cut is for both, and with that they are cut."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.nest_file import nest_file
from kerfwise.tests.tools.amount import rows

APART = {"plasma-carbon-steel": (1.5, 0.0), "laser-st10kp-2mm": (0.2, 0.0)}


def _plate(name: str, x: float, y: float) -> dict[str, Any]:
    return {"id": name, "outer": [[x, y], [x + 100, y], [x + 100, y + 60], [x, y + 60]]}


@pytest.mark.slow
@pytest.mark.parametrize(("name", "gap_mm"), rows([(name, gap) for name, gaps in APART.items() for gap in gaps], 1))
def test_common_cuts_are_asked_for_and_do(name: str, gap_mm: float, tmp_path: Path) -> None:
    w, h = 100 + gap_mm, 60 + gap_mm
    parts = [_plate(f"P{i}{j}", 30 + i * w, 30 + j * h) for i in range(3) for j in range(3)]
    file = nest_file(tmp_path / "grid.json", parts, (400, 300))
    solve = "solve", file, "--work", "0.05", "-o", tmp_path / "out.nc"
    asks = kerfwise(*solve, "-p", name)
    assert asks.code == 3
    (line,) = [line for line in asks.err.splitlines() if "both parts by one cut" in line]
    keys = line[line.index("(") + 1 : line.rindex(")")].replace(", machine:", "\nmachine:")
    plant = tmp_path / "plant.yaml"
    plant.write_text(f"based_on: {name}\n{keys}\n", encoding="utf-8")
    assert kerfwise("profile", "check", plant).code == 0
    by_profile = kerfwise(*solve, "-p", plant)
    assert (by_profile.code, (tmp_path / "out.nc").exists()) == (0, True), by_profile.err
    done = kerfwise(*solve, "-p", name, "--answer", line.split()[1])
    assert done.code == 0, done.err
    assert kerfwise(*solve, "-p", name).code == 0  # nobody is asked twice
    refused = kerfwise(*solve, "-p", name, "--no-job", "--answer", "shared-edges=refuse")
    assert refused.code == (1 if gap_mm == 0 else 2)


def test_where_common_cuts_do_not_help_nothing_is_said_of_them(tmp_path: Path) -> None:
    parts = [_plate(f"P{i}{j}", 30 + i * 100.8, 30 + j * 60.8) for i in range(3) for j in range(3)]
    file = nest_file(tmp_path / "grid.json", parts, (400, 300))
    refused = kerfwise("solve", file, "--work", "0.05", "-o", tmp_path / "out.nc")
    assert "shared-edges" not in refused.err
    assert refused.code == 1
