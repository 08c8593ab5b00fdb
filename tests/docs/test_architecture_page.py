"""docs/architecture.md: the files and functions of its walk are there, in at most 25 files."""

from __future__ import annotations

import re
from pathlib import Path

import kerfwise as package

ROOT = Path(package.__file__).resolve().parent
WALK = re.findall(
    r"^\| (\d+) \| `([\w/]+\.py)` \| `(\w+)` \|", (ROOT / "docs" / "architecture.md").read_text("utf-8"), re.MULTILINE
)


def test_the_walk_names_files_and_functions_that_are_there_in_at_most_25_steps() -> None:
    assert [int(number) for number, _, _ in WALK] == list(range(1, len(WALK) + 1))
    assert 15 < len(WALK) <= 25
    for _, file, name in WALK:
        assert re.search(rf"^ *(?:def|class) {name}\b", (ROOT / file).read_text("utf-8"), re.MULTILINE), (file, name)
