"""The page of what older kerfs cost: both plans of a nest are made, and counted by the check."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from kerfwise.benchmarks.older_kerfs import grid, main, planned
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.readers import ReadOptions
from kerfwise.encoder.readers.json_nest import read_json
from kerfwise.rules.profile.load import load_profile


def test_a_grid_with_narrow_streets_is_planned_both_ways() -> None:
    made = grid(4.0)
    parts = made["parts"]
    assert isinstance(parts, list)
    nest = read_json(json.dumps(made | {"parts": [*parts[:3], *parts[8:11]]}).encode(), ReadOptions())
    before, now = (planned(nest, load_profile(), 1.0, minding) for minding in (False, True))
    assert before.over > 0
    assert now.over == 0
    assert before.proven
    assert now.proven


def test_a_nest_that_is_missing_is_told_before_any_plan(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr("sys.argv", ["older_kerfs", "--nests", str(tmp_path / "none.json")])
    monkeypatch.setattr("kerfwise.benchmarks.older_kerfs.planned", lambda *_: pytest.fail("a plan was made"))
    with pytest.raises(InputError, match="none"):
        main()
