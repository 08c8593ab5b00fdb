"""Follows a page to the letter: saves the files that it shows, and runs its commands, in an empty folder."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import kerfwise

ROOT = Path(kerfwise.__file__).resolve().parent
STEP = re.compile(
    r"^Save this as `(?P<file>[^`]+)`:\n\n```\w*\n(?P<content>.*?)^```$|^```console\n(?P<console>.*?)^```$",
    re.MULTILINE | re.DOTALL,
)
INSTALLING = "pip install "
"""What `tests/test_installing.py` does."""


@dataclass(frozen=True)
class Command:
    """A command of a page, and the lines that the page shows of what it says."""

    words: str
    shown: tuple[str, ...]


def steps(page: str) -> list[tuple[str, str] | Command]:
    """The steps of a page in order: files with what they hold, and commands."""
    found: list[tuple[str, str] | Command] = []
    for step in STEP.finditer(page):
        if step["file"]:
            found.append((step["file"], step["content"]))
            continue
        for block in re.split(r"^\$ ", step["console"], flags=re.MULTILINE)[1:]:
            words, *shown = block.splitlines()
            found.append(Command(words, tuple(line for line in shown if line not in ("", "…"))))
    return found


def follow(page: str, folder: Path) -> dict[str, str]:
    """Command → what it said; each must end well and say the lines that the page shows."""
    said: dict[str, str] = {}
    for step in steps(page):
        if isinstance(step, tuple):
            (folder / step[0]).parent.mkdir(parents=True, exist_ok=True)
            (folder / step[0]).write_text(step[1], encoding="utf-8")
        elif not step.words.startswith(INSTALLING):
            said[step.words] = _run(step, folder)
    return said


def _run(command: Command, folder: Path) -> str:
    assert command.words.startswith("kerfwise "), f"a page for people who have no checkout says {command.words!r}"
    words = command.words.replace("kerfwise ", f'"{sys.executable}" -m kerfwise ', 1)
    home = {"XDG_CONFIG_HOME": str(folder), "APPDATA": str(folder), "PYTHONPATH": str(ROOT.parent), "PYTHONUTF8": "1"}
    ended = subprocess.run(words, shell=True, cwd=folder, env=os.environ | home, capture_output=True, text=True)
    assert ended.returncode == 0, (command.words, ended.stdout, ended.stderr)
    lines = {" ".join(line.split()) for line in ended.stdout.splitlines()}
    missing = [line for line in command.shown if " ".join(line.split()) not in lines]
    assert missing == [], (command.words, ended.stdout)
    return ended.stdout
