"""Ctrl-C keeps the best plan so far."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import pytest

import kerfwise as package
from kerfwise.commands.progress import ProgressLine
from kerfwise.tests.commands.run_cli import kerfwise

NEST = Path(package.__file__).parent / "examples" / "nests" / "plate40.json"


@pytest.mark.slow
def test_the_best_plan_so_far_is_written_and_the_exit_code_is_130(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    profile = tmp_path / "free.yaml"
    profile.write_text("based_on: plasma-carbon-steel\nname: free\nrules: {zone-order: off}\n")
    heard = ProgressLine.__call__
    presses = []

    def press_once_there_is_a_plan(
        progress: ProgressLine, engine: str, cost_um: int | None, bound_um: int | None
    ) -> bool:
        if cost_um is not None and not presses:
            presses.append(engine)
            signal.raise_signal(signal.SIGINT)
        return heard(progress, engine, cost_um, bound_um)

    monkeypatch.setattr(ProgressLine, "__call__", press_once_there_is_a_plan)
    program = tmp_path / "out.nc"
    ended = kerfwise("solve", NEST, "-p", profile, "-o", program, "--engine", "search")
    assert presses
    assert ended.code == 130
    assert "proven" not in ended.out.splitlines()[1] or "no bound is proven" in ended.out
    assert kerfwise("check", NEST, program, "-p", profile).code == 0


_PRESSED_AFTER_NESTING = """
import signal
from kerfwise.rules.case import part, rect
from kerfwise.encoder.nest import Sheet
from kerfwise.apps.nesting.placement.rounds import Effort, best_layout
from kerfwise.apps.nesting.placement.demand import PartType, Spacing, Stock, Demand as Wanted

heard = []
signal.signal(signal.SIGINT, lambda *pressed: heard.append(pressed))
types = (PartType("plate", part("plate", rect(0, 0, 60, 30)), 5),)
best_layout(Wanted(types, (Stock("sheet", Sheet.rectangle(150, 100)),)), Spacing(5.0, 5.0), Effort(1))
signal.raise_signal(signal.SIGINT)
print(len(heard))
"""


@pytest.mark.slow
def test_ctrl_c_is_heard_after_cp_sat_has_chosen_sheets() -> None:
    ended = subprocess.run([sys.executable, "-c", _PRESSED_AFTER_NESTING], capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stdout.split()) == (0, ["1"]), ended.stderr


def test_no_solver_takes_ctrl_c_from_the_command() -> None:
    """CP-SAT would listen itself, and afterwards leave it to the system, which ends the command at once."""
    root = Path(package.__file__).parent
    files = [path for path in root.rglob("*.py") if path.relative_to(root).parts[0] not in ("tests", ".venv", "venv")]
    sources = {path: path.read_text(encoding="utf-8") for path in files}
    makers = {path: text.count("CpSolver()") for path, text in sources.items() if "CpSolver()" in text}
    assert len(makers) > 1
    for path, count in makers.items():
        assert sources[path].count("catch_sigint_signal = False") == count, path
