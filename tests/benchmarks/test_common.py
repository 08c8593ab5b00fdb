"""The page on what common cuts save, tried on a small grid."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from kerfwise import InputError
from kerfwise.benchmarks.common import STAGGERED, WEB_MM, Row, in_rows, mixed, plant, row, widths_of
from kerfwise.benchmarks.older_kerfs import grid, main, planned
from kerfwise.encoder.readers import ReadOptions
from kerfwise.encoder.readers.json_nest import read_json
from kerfwise.rules.profile.load import load_profile


def test_a_row_tells_plans_and_gaps_apart() -> None:
    plain = Row("3 × 4", False, 12, 20_500.0, 4_250.0, 512.3, 0.0, 1.4)
    assert str(plain) == "| 3 × 4 | plain | 12 | 20.50 | 4.25 | 512 | 0 | 1 |"
    assert str(Row("3 × 4", True, 1, 1.0, 1.0, 1.0, 0.0123, 1.0)).endswith("| 1.23% | 1 |")


@pytest.mark.parametrize("widths_mm", [widths_of("2x2"), [row[:2] for row in STAGGERED[:2]]], ids=["grid", "staggered"])
def test_common_cuts_save_pierces_lengths_and_time(widths_mm: list[tuple[float, ...]]) -> None:
    kerf_mm = plant(common=True).material.kerf_mm
    plain, common = (row("", in_rows(widths_mm, kerf_mm if on else WEB_MM), on, 0.5) for on in (False, True))
    assert plain.gap == common.gap == 0
    assert (plain.pierces, common.pierces) == (4, 1)
    assert common.cut_mm < 0.8 * plain.cut_mm
    assert common.program_s < plain.program_s


def test_common_cuts_save_pierces_and_time_among_all_kinds_of_parts() -> None:
    kerf_mm = plant(common=True).material.kerf_mm
    plain, common = (row("", mixed(12, kerf_mm if on else WEB_MM), on, 0.5) for on in (False, True))
    assert plain.gap == common.gap == 0
    assert common.pierces < plain.pierces
    assert common.cut_mm < plain.cut_mm
    assert common.program_s < plain.program_s


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
