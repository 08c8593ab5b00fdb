"""The page of limits: every row is a run of the command itself."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

import kerfwise
from kerfwise.benchmarks.limits import HEAD, run
from kerfwise.tests.tools.amount import few

NEST = Path(kerfwise.__file__).parent / "examples" / "nests" / "e1x_6.json"


@pytest.mark.slow
@pytest.mark.parametrize("processor", few([False, True]))
def test_a_row_is_what_a_run_of_the_command_took(processor: bool, tmp_path: Path) -> None:
    nest = tmp_path / NEST.name
    shutil.copy(NEST, nest)
    kept = run(nest, "16 contours", 60.0, ["--memory", "1"], processor)
    assert 0.0 < kept.planned_s < kept.command_s
    assert kept.gap == 0.0
    assert 50 < kept.memory_mb < 3000
    assert str(kept).count("|") == HEAD.splitlines()[0].count("|")
    assert str(kept).split(" | ")[3] == f"{kept.command_s - 60.0:+.1f}"
    assert {path.name for path in tmp_path.iterdir()} >= {"e1x_6.nc", "e1x_6.plan.json", "e1x_6.svg"}


@pytest.mark.slow
def test_a_run_that_ends_without_a_plan_is_no_row(tmp_path: Path) -> None:
    nest = tmp_path / "broken.json"
    nest.write_text("{}", encoding="utf-8")
    with pytest.raises(RuntimeError, match="ended with 2"):
        run(nest, "broken", 1.0, [])
