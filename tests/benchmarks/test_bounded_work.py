"""The table of inputs that ask for too much, tried on its quick rows; the page holds a row for every input."""

from __future__ import annotations

from pathlib import Path

import pytest

from kerfwise.benchmarks.bounded_work import CASES, HEAD, Case, grid, row, run

PAGE = (Path(__file__).parents[2] / "docs" / "safety.md").read_text(encoding="utf-8")


@pytest.mark.full
def test_inputs_are_read_or_refused_and_what_they_take_is_told() -> None:
    read = run(Case("six parts", grid(6), ("facts", "nest.json", "-o", "facts.json")))
    assert (read.code, read.said) == (0, "")
    assert read.cpu_s > 0
    assert 50 < read.memory_mb < 3000
    (waits,) = (case for case in CASES if "G4 P99999999" in case.name)
    refused = run(waits)
    assert refused.code == 2
    assert "P99999999 is not supported here" in refused.said
    assert row(waits, refused).startswith(f"| {waits.name} | `heat` | ")


def test_the_page_has_every_input_none_over_three_gigabytes_and_none_that_ends_in_a_fault() -> None:
    assert HEAD in PAGE
    for case in CASES:
        (line,) = [line for line in PAGE.splitlines() if line.startswith(f"| {case.name} | `{case.words[0]}` |")]
        cpu_s, memory_mb, code = (float(cell) for cell in line.split("|")[3:6])
        assert memory_mb < 3000
        assert cpu_s < 60
        assert code in (0, 2)
