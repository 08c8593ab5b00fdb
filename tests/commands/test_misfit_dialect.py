"""A plan is not judged for a machine whose programs would not run."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from kerfwise.tests.commands.run_cli import kerfwise

NEST = {
    "format": "kerfwise-nest/1",
    "sheet": {"width": 200, "height": 120},
    "parts": [{"id": "A", "outer": [[20, 30], [80, 30], [80, 90], [20, 90]]}],
}


@pytest.mark.parametrize("made", ["a.plan.json", "a.nc"])
def test_check_refuses_what_solve_refuses(made: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("a.json").write_text(json.dumps(NEST))
    done = kerfwise("solve", "a.json", "--work", 1, "-o", "a.nc", "--plan", "a.plan.json")
    assert done.code == 0, done.err
    Path("shop.yaml").write_text("machine: {process: laser}\n")
    asked = kerfwise("check", "a.json", made, "-p", "shop.yaml")
    solved = kerfwise("solve", "a.json", "-p", "shop.yaml")
    assert (asked.code, solved.code) == (2, 2)
    assert asked.err == solved.err
    assert "would not run" in asked.err
