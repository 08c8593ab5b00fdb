"""The commands of docs/snake.md and docs/bevel.md print what these pages say."""

from __future__ import annotations

import re
import shlex
import shutil
from pathlib import Path

import pytest

import kerfwise as package
from kerfwise.tests.commands.run_cli import kerfwise

ROOT = Path(package.__file__).resolve().parent
PAGES = "".join((ROOT / "docs" / name).read_text("utf-8") for name in ("snake.md", "bevel.md"))
SHOWN = re.findall(r"```console\n\$ kerfwise (.*)\n((?:.*\n)+?)```", PAGES)


@pytest.mark.parametrize(("words", "said"), SHOWN, ids=[words.split()[1] for words, _ in SHOWN])
def test_each_command_prints_what_the_page_says(
    words: str, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for part in ("docs/*.nest.json", "examples/profiles/*.yaml"):
        for file in ROOT.glob(part):
            (tmp_path / file.relative_to(ROOT)).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(file, tmp_path / file.relative_to(ROOT))
    monkeypatch.chdir(tmp_path)
    done = kerfwise(*shlex.split(words))
    assert done.code == 0, done.err
    assert done.out.startswith(said) or said in done.out
