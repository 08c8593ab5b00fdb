"""docs/first-changes.md: its changes are made in a copy of the package, and its commands print what stands there."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import kerfwise as package

ROOT = Path(package.__file__).resolve().parent
PAGE = (ROOT / "docs" / "first-changes.md").read_text(encoding="utf-8")
SECTIONS = re.split(r"^## ", PAGE, flags=re.MULTILINE)[1:]
LEFT_OUT = ("tests", "docs", "benchmarks", ".*", "build", "*.egg-info", "__pycache__", "*.nc")
_BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)


def changes(diff: str) -> list[tuple[str, str, str]]:
    """File, lines before, lines after, of each hunk."""
    found = []
    for file in re.split(r"^--- ", diff, flags=re.MULTILINE)[1:]:
        name, *hunks = re.split(r"\n@@\n", file)
        for hunk in hunks:
            rows = [row or " " for row in hunk.rstrip("\n").split("\n")]
            old, new = ("\n".join(row[1:] for row in rows if row[0] in kept) for kept in (" -", " +"))
            found.append((name, old, new))
    return found


def change(root: Path, diff: str) -> list[str]:
    """Make a change in that copy; the files touched."""
    files = []
    for name, old, new in changes(diff):
        text = (root / name).read_text(encoding="utf-8") if old or (root / name).exists() else ""
        assert text.count(old) == 1 or not (old or text), f"{name} has these lines {text.count(old)} times:\n{old}"
        (root / name).write_text(text.replace(old, new), encoding="utf-8")
        files.append(name)
    return list(dict.fromkeys(files))


def block(section: str, kind: str) -> str:
    return next(text for name, text in _BLOCK.findall(section) if name == kind)


def copy_of_package(folder: Path) -> Path:
    return Path(shutil.copytree(ROOT, folder / "kerfwise", ignore=shutil.ignore_patterns(*LEFT_OUT)))


def printed(command: str, folder: Path) -> str:
    """What a command of the page prints, run by the copy that lies in `folder/code`."""
    script = f'kerfwise() {{ "{sys.executable}" -m kerfwise "$@"; }}\n{command}\n'
    env = {**os.environ, "PYTHONPATH": str(folder / "code")}
    ran = subprocess.run(["sh", "-c", script], cwd=folder, env=env, capture_output=True, text=True, check=False)
    return ran.stdout + ran.stderr


@pytest.mark.parametrize("section", SECTIONS, ids=["an option", "an objective term", "a control's word"])
def test_the_lines_that_change_stand_in_the_files_and_the_table_counts_them(section: str, tmp_path: Path) -> None:
    files = {name for name, _, _ in changes(block(section, "diff"))}
    for name in files:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        if (ROOT / name).exists():
            shutil.copy(ROOT / name, tmp_path / name)
    assert set(change(tmp_path, block(section, "diff"))) == files
    for name in files:
        if name.endswith(".py"):
            compile((tmp_path / name).read_text(encoding="utf-8"), name, "exec")
    counts = [int(row) for row in re.findall(r"^\| an? .*? \| (\d):", PAGE, re.MULTILINE)]
    assert counts[SECTIONS.index(section)] == len(files)


@pytest.mark.slow
@pytest.mark.full
@pytest.mark.minizinc
def test_each_change_does_what_the_page_shows(tmp_path: Path) -> None:
    copy = copy_of_package(tmp_path / "code")
    (tmp_path / "mouth.json").write_text(block(PAGE, "json"), encoding="utf-8")
    for number, section in enumerate(SECTIONS):
        before, _, after = section.partition("```diff")
        run_and_compare(before, tmp_path)
        diff = block(section, "diff")
        if number == 0:  # the first file alone is noticed
            change(copy, re.split(r"^(?=--- )", diff, flags=re.MULTILINE)[1])
            assert "its text in MiniZinc does not" in printed("kerfwise rules test hull-before", tmp_path)
            diff = "".join(re.split(r"^(?=--- )", diff, flags=re.MULTILINE)[2:])
        change(copy, diff)
        run_and_compare(after, tmp_path)


def run_and_compare(text: str, folder: Path) -> None:
    """Each command of a piece of the page prints the lines below it, in their order, among others."""
    for kind, console in _BLOCK.findall(text):
        if kind != "console":
            continue
        for part in re.split(r"^\$ ", console, flags=re.MULTILINE)[1:]:
            command, _, shown = part.partition("\n")
            lines = iter(printed(command, folder).split("\n"))
            for row in shown.splitlines():
                assert any(row == line for line in lines), f"{command}: {row!r} is not printed"
