"""The page on what zones cost, tried on a small plate."""

from __future__ import annotations

import pytest

from kerfwise.benchmarks.zones import Row, row
from kerfwise.encoder.facts import zones
from kerfwise.rules.statements import EXEMPTION_MM


def test_a_row_counts_excuses_apart() -> None:
    told = str(Row("plate", (4, 3), EXEMPTION_MM + 11_000.0, 10_500.0, True, 7.0, 10_000.0, "so much"))
    assert told == "| plate | 4 | 11.00 + 1 | 3 | 10.50 | yes | 7 | 10.00 | 5.0% | so much |"


@pytest.mark.slow
def test_moved_zones_cost_no_more(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(zones, "MOST_OF_ONE", 100)
    made = row(30, 1, 2.0, 1.0)
    assert made.proven
    assert made.without_mm <= made.moved_mm <= made.by_geometry_mm
