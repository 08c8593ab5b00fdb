from __future__ import annotations

import sys

import pytest

from kerfwise.benchmarks import facts as benchmark
from kerfwise.benchmarks.plates import made_plate
from kerfwise.encoder.facts import FactOptions, compute, compute_facts


def test_prints_a_row_for_every_family(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(sys, "argv", ["facts.py", "--contours", "30", "60", "--candidates", "2"])
    benchmark.main()
    printed = capsys.readouterr().out
    rows = [[cell.strip() for cell in line.split("│")[1:-1]] for line in printed.splitlines() if line.startswith("│")]
    assert [row[0] for row in rows] == [*benchmark.FAMILIES, "all"]
    assert all(len(row) == 4 and float(row[1]) >= 0 <= float(row[2]) for row in rows)


def test_the_exponent_is_fitted_to_large_sizes_only() -> None:
    assert benchmark.exponent([100, 1000, 10_000], [9.0, 1.0, 100.0]) == "2.00"
    assert benchmark.exponent([100, 1000], [1.0, 2.0]) == ""


def test_measuring_leaves_compute_facts_as_it_was() -> None:
    nest = made_plate(20, seed=1)
    before = {name: getattr(compute, name) for names in benchmark.FAMILIES.values() for name in names}
    spent = benchmark.seconds_by_family(nest, benchmark.plain_candidates(nest, 2))
    assert {name: getattr(compute, name) for name in before} == before
    assert set(spent) == {*benchmark.FAMILIES, "all"}
    assert compute_facts(nest, FactOptions()).n == len(nest.contours)
