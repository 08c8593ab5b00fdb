"""The page of the large nests, tried on a small one."""

from __future__ import annotations

import pytest

from kerfwise.benchmarks.plates import cost
from kerfwise.benchmarks.scale import OTHERS, Job, page, row, run, with_others


@pytest.mark.parametrize("zones", [True, pytest.param(False, marks=pytest.mark.slow)])
def test_a_small_plate_is_proven_and_told(zones: bool) -> None:
    job = Job(20, zones, (2.0, 5.0))
    (seen,) = run(job)  # more work is not tried
    assert seen.proven
    assert seen.bound_mm == seen.cost_mm
    line = row(job, seen)
    assert line.startswith(f"| 20 contours{'' if zones else ', no zones'} | ")
    assert f" | {cost(seen.cost_mm)} | yes | " in line
    text = page([job], [line])
    assert line in text
    assert "--plates 20:2,5 --seed 1" in text


def test_what_another_command_made_of_the_page_stays() -> None:
    assert with_others("new\n\n", f"old\n\n{OTHERS}\n\nphases\n") == f"new\n\n{OTHERS}\n\nphases\n"
    assert with_others("new\n\n", "old\n") == "new\n"
