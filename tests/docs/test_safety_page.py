"""The promises of docs/safety.md: each finding of the second judge stands there, with rules of the check and tests."""

from __future__ import annotations

import re
from pathlib import Path

import kerfwise as package
from kerfwise.tests.metal.findings import KINDS

ROOT = Path(package.__file__).parent
_NAME = re.compile(r"`([\w-]+)`")


def promises() -> list[list[str]]:
    """The cells of the table, row by row."""
    lines = (ROOT / "docs" / "safety.md").read_text(encoding="utf-8").splitlines()
    begin = next(k for k, line in enumerate(lines) if line.startswith("| promise | the second judge's finding"))
    rows = lines[begin + 2 : lines.index("", begin)]
    return [[cell.strip() for cell in row.strip("|").split(" | ")] for row in rows]


def test_every_finding_stands_in_the_table() -> None:
    found = [name for _, kinds, _, _ in promises() for name in _NAME.findall(kinds)]
    assert sorted(found) == sorted(KINDS)


def test_every_test_is_there_and_tells_of_metal() -> None:
    for _, _, _, names in promises():
        files = [ROOT / "tests" / "metal" / f"test_{name}.py" for name in _NAME.findall(names)]
        assert files
        assert all(file.is_file() for file in files)


def test_every_finding_is_found_by_one_of_its_tests() -> None:
    for _, kinds, _, names in promises():
        texts = [(ROOT / "tests" / "metal" / f"test_{name}.py").read_text() for name in _NAME.findall(names)]
        for kind in _NAME.findall(kinds):
            assert any(kind in text for text in texts), kind
