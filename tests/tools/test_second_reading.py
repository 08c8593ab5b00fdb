"""The second reading agrees with the first on the case drawings, and can tell when it does not."""

from __future__ import annotations

from pathlib import Path

import pytest

from kerfwise.encoder.readers.options import ReadOptions
from kerfwise.tests.tools.second_reading import Judged, judged

CASES = Path(__file__).parents[1] / "encoder" / "readers" / "cases"
CLOSED_BY_US = "01-svg-clippath.svg"
"""What is seen of its rectangle is closed along the clipping path, where nothing is drawn."""
OVERRUN = "27-dxf-overlapping-collinear.dxf"
"""20 mm of a line that overruns its corner are not listed as a line of their own."""
REFUSED = ("63-dxf-comma-decimals.dxf",)


@pytest.mark.parametrize("file", sorted(CASES.glob("*.*")), ids=lambda file: file.name)
def test_cases_are_read_as_other_programs_show_them(file: Path) -> None:
    row = judged(file, ReadOptions(kerf_mm=1.5))
    if file.name in REFUSED:
        assert row.ended == "refused"
    elif file.name not in (CLOSED_BY_US, OVERRUN):
        assert row == Judged(file, row.ended)


@pytest.mark.parametrize("name", [CLOSED_BY_US, OVERRUN])
def test_the_comparison_can_fail(name: str) -> None:
    assert judged(CASES / name, ReadOptions(kerf_mm=1.5)).differs
