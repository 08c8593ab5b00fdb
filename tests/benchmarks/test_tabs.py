"""The table on what tabs cost, tried on three parts."""

from __future__ import annotations

import pytest

from kerfwise.benchmarks.tabs import CHOICES, HEAD, Row, row
from kerfwise.rules.case import nest, part, rect

SHEET = nest(
    500, 300, part("Wide", rect(40, 40, 200, 160)), part("A", rect(280, 40, 60, 60)), part("B", rect(280, 140, 60, 60))
)


def test_a_row_stands_under_its_heads() -> None:
    told = str(Row("laser", 115, "tipping", 80, 30, 60, 115, 79_900.0, 14_010.0, 1234.5, 0.0123, 21.4))
    assert told.split() == [
        "laser",
        "115",
        "tipping",
        "80",
        "30",
        "60",
        "115",
        "79.90",
        "14.01",
        "1234.5",
        "1.2%",
        "21",
    ]
    assert len(told) == len(HEAD)


@pytest.mark.slow
def test_tabs_of_a_laser_add_time_and_no_pierce() -> None:
    none, tipping, every = (row(SHEET, "laser-st10kp-2mm", choice, 0.2) for choice in CHOICES)
    assert [(one.held, one.tabs, one.pierces) for one in (none, tipping, every)] == [(0, 0, 3), (2, 4, 3), (3, 6, 3)]
    assert none.cut_mm > tipping.cut_mm > every.cut_mm
    assert none.program_s < tipping.program_s < every.program_s


def test_a_torch_that_pierces_leaves_one_tab_a_part() -> None:
    every = row(SHEET, "plasma-carbon-steel", "all", 0.2)
    assert (every.held, every.tabs, every.pierces) == (3, 3, 3)
