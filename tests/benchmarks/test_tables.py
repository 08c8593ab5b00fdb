"""Rows that a benchmark sets into a page."""

from __future__ import annotations

from pathlib import Path

import pytest

from kerfwise import benchmarks
from kerfwise.benchmarks import drops, page
from kerfwise.benchmarks.tables import put_row

DOCS = Path(benchmarks.__path__[0]).parent / "docs"


def test_a_row_takes_the_place_of_the_one_for_the_same(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "page.md"
    file.write_text("# A\n\n| n | s |\n|---:|---:|\n| 1 | 9 |\n| 2 | 9 |\n\nafter\n", encoding="utf-8")
    for row in ("| 2 | 5 |", "| 3 | 6 |"):
        put_row(row, "| n | s |", file)
    assert (
        file.read_text(encoding="utf-8") == "# A\n\n| n | s |\n|---:|---:|\n| 1 | 9 |\n| 2 | 5 |\n| 3 | 6 |\n\nafter\n"
    )
    assert capsys.readouterr().out == "| 2 | 5 |\n| 3 | 6 |\n"
    with pytest.raises(SystemExit, match="no table"):
        put_row("| 2 | 5 |", "| n | minutes |", file)


def test_the_page_has_the_tables_of_its_two_benchmarks() -> None:
    lines = (DOCS / "page.md").read_text(encoding="utf-8").splitlines()
    assert {drops.HEAD, page.HEAD} <= set(lines)
