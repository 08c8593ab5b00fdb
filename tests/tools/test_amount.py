"""Tests marked full are left out unless somebody asks for them, and properties draw few examples until then."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from kerfwise.tests.tools.amount import few, full, rows

ROOT = Path(__file__).parents[2]
HERE = "tests/tools/test_amount.py"


@pytest.mark.full
def test_only_with_all() -> None:
    """Stands for every test that is marked."""


@pytest.mark.parametrize("seed", few([1, 2, 3], 2))
def test_two_of_three_always(seed: int) -> None:
    """Stands for every family of which some members run always."""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("asked", "found"),
    rows([([HERE], 0), ([HERE, "--all"], 2), ([HERE, "-m", "full"], 2), ([f"{HERE}::test_only_with_all"], 1)]),
)
def test_they_run_when_asked_for(asked: list[str], found: int) -> None:
    command = [sys.executable, "-m", "pytest", "--collect-only", "-q", *asked]
    listed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout.splitlines()
    assert (
        len([line for line in listed if line.endswith(("test_only_with_all", "test_two_of_three_always[3]"))]) == found
    )


def test_rows_keep_their_names_and_marks() -> None:
    first, second = rows([(1, "a"), (2, "b")])
    assert (first.values, list(first.marks)) == ((1, "a"), [])
    assert (second.values, second.marks[0].name) == ((2, "b"), "full")
    marked = full(pytest.param(3, id="three", marks=pytest.mark.minizinc))
    assert (marked.id, [mark.name for mark in marked.marks]) == ("three", ["minizinc", "full"])
