"""Kernels are there before a clock starts."""

from __future__ import annotations

from pathlib import Path

import pytest

import kerfwise as package
from kerfwise.models.engines import warm_up as ready
from kerfwise.models.engines.ideals import kernels
from kerfwise.models.engines.warm_up import load_kernels
from kerfwise.tests.commands.run_cli import kerfwise

NEST = Path(package.__file__).parent / "examples" / "nests" / "e1x_6.json"


def test_the_sweep_is_loaded_for_cheap_plans_and_dear_ones_with_a_bound_and_without() -> None:
    load_kernels()
    loaded = len(kernels.sweep.signatures)
    assert loaded >= 4
    load_kernels()
    assert len(kernels.sweep.signatures) == loaded


@pytest.mark.parametrize(
    ("limit", "calls"),
    [(("--time-limit", "5"), 1), (("--no-improvement", "5", "--work", "1"), 1), (("--work", "1"), 0)],
)
def test_kernels_are_loaded_where_seconds_are_counted(
    limit: tuple[str, ...], calls: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    called: list[None] = []
    monkeypatch.setattr(ready, "load_kernels", lambda: called.append(None))
    assert kerfwise("solve", NEST, *limit, "-o", tmp_path / "cut.nc").code == 0
    assert len(called) == calls
