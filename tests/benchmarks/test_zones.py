"""The page on what zones cost, tried on a small plate."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

import pytest

from kerfwise.benchmarks import zones as page
from kerfwise.benchmarks.zones import Job, Row, Sized, moved, row_of, sized
from kerfwise.encoder.facts import zones
from kerfwise.rules.statements import EXEMPTION_MM

ROW = Row("plate", (4, 3), 55, EXEMPTION_MM + 11_000.0, 10_500.0, True, 7.0, 400.0, 10_000.0, "so much")


def test_a_row_counts_excuses_apart() -> None:
    assert str(ROW) == "| plate | 4 | 11.00 + 1 | 3 | 55 | 10.50 | yes | 7 | 400 | 10.00 | 5.0% | so much |"
    small = Sized("plate", 50, 6, 55, EXEMPTION_MM + 11_000.0, None, False, 7.0, 400.0)
    assert str(small) == "| plate | 50 | 6 | 55 | 11.00 + 1 |  | no | 7 | 400 |"


def test_a_row_that_is_kept_is_not_made_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(page, "run", None)
    job = Job(30, 1, 2.0, 0.03)
    kept = json.loads(json.dumps({json.dumps(asdict(job)): asdict(ROW)}))
    assert str(row_of(job, kept, tmp_path / "kept.json")) == str(ROW)


@pytest.mark.full
def test_moved_zones_cost_no_more(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(zones, "MOST_OF_ONE", 100)
    made = moved(Job(30, 1, 2.0, 0.03))
    assert made.proven
    assert made.without_mm <= made.moved_mm <= made.by_geometry_mm


@pytest.mark.slow
def test_zones_of_so_many_contours() -> None:
    made = sized(Job(30, 1, 2.0, 0.03, size=8))
    assert made.proven
    assert made.bound_mm == made.cost_mm
    assert 8 <= made.largest < 30
