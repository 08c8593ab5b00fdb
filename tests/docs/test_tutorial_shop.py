"""docs/tutorial-shop.md: each command runs as it stands there, in order, and prints what stands below it.

`python -m kerfwise.tests.docs.test_tutorial_shop` goes through the page in a folder of its own and prints what it does.
"""

from __future__ import annotations

import json
import os
import re
import shlex
import tempfile
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

import pytest

import kerfwise as package
from kerfwise.examples import gen_shop
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.docs.test_tutorial_planner import missing
from kerfwise.tests.tools.amount import few

ROOT = Path(package.__file__).resolve().parent
PAGE = (ROOT / "docs" / "tutorial-shop.md").read_text(encoding="utf-8")
_BLOCK = re.compile(r"^```(csv|console)\n(.*?)^```", re.MULTILINE | re.DOTALL)
_NAMED = re.compile(r"`([\w./]+\.csv)`")


def run(command: str, arguments: list[str]) -> str:
    """What a command of the page prints, with its exit code where that is not 0."""
    if command == "kerfwise":
        ended = kerfwise(*arguments)
        return ended.out + (f"[exit code {ended.code}]\n" if ended.code else "")
    assert (command, arguments[0]) == ("python", "kerfwise/examples/gen_shop.py")
    return f"{gen_shop.draw(Path(arguments[1]))} drawings in {arguments[1]}\n"


def walk() -> Iterator[tuple[str, str, str]]:
    """Go through the page in this folder: each command, what the page shows, and what was printed."""
    for block in _BLOCK.finditer(PAGE):
        if block[1] == "csv":
            name = _NAMED.findall(PAGE[: block.start()])[-1]
            Path(name).write_text(block[2], encoding="utf-8")
            continue
        for part in re.split(r"^(?=\$ )", block[2], flags=re.MULTILINE)[1:]:
            command, _, shown = part.partition("\n")
            verb, *arguments = shlex.split(command[2:])
            yield command, shown, run(verb, arguments)


@pytest.mark.slow
@pytest.mark.parametrize("most", few([6, PAGE.count("\n$ ")]))
def test_the_page_in_order(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, most: int) -> None:
    """Its first commands; what comes after a stop and the work sheet, which other pages show too, with `--all`."""
    monkeypatch.chdir(tmp_path)
    walked = 0
    for command, shown, printed in islice(walk(), most):
        assert missing(shown, printed) == "", f"{command}\n{printed}"
        walked += 1
    assert walked == most
    table = json.loads(Path("week/nests.json").read_text())
    assert [row["part"] for row in table["left_out"]] == ["lid"]
    assert table["groups"] == ["S235-8mm", "S235-6mm"]
    assert not Path("week/S235-6mm/moved.json").exists()
    if most == PAGE.count("\n$ "):
        assert Path("again.pdf").read_bytes().startswith(b"%PDF")
        cut = json.loads(Path("again.plan.json").read_text())["cuts"]
        assert {one["part"] for one in cut} == {"bracket-1"}


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for asked, _, said in walk():
            print(f"{asked}\n{said}", end="")
