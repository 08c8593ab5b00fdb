"""Ctrl-C keeps the best plan so far."""

from __future__ import annotations

import signal
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
