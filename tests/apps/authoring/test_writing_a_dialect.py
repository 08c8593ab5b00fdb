"""docs/writing-a-dialect.md: its first part is followed to the letter, its list of files is complete."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import kerfwise
from kerfwise.tests.apps.authoring.test_proposed_dialect import programs

ROOT = Path(kerfwise.__file__).parent
PAGE = (ROOT / "docs" / "writing-a-dialect.md").read_text(encoding="utf-8")
OWN, OTHER = PAGE.split("## A control with other torch words")
STEP = re.compile(r"^\$ (.+)\n((?:(?!\$ |```).+\n)*)", re.MULTILINE)


@pytest.mark.slow
def test_a_file_of_your_own(tmp_path: Path) -> None:
    (tmp_path / "postproc").symlink_to(ROOT / "postproc")
    env = os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT.parent), os.environ.get("PYTHONPATH", "")])}
    steps = STEP.findall(OWN)
    assert len(steps) == 7
    for name, text in zip(("old1", "old2"), programs("eia", {})[0], strict=True):
        (tmp_path / f"{name}.nc").write_text(text)
    for command, said in steps:
        real = re.sub("^kerfwise ", f'"{sys.executable}" -m kerfwise ', command)
        done = subprocess.run(real, shell=True, cwd=tmp_path, env=env, capture_output=True, text=True)
        assert (done.returncode, done.stderr) == ((2, said) if said else (0, "")), command


def test_each_file_that_lists_controls_or_dialects_is_on_the_page() -> None:
    code = [*(ROOT / "postproc").rglob("*.py"), *(ROOT / "rules").rglob("*.py")]
    naming = {f.relative_to(ROOT).as_posix() for f in code if '"linuxcnc"' in f.read_text(encoding="utf-8")}
    assert naming
    assert {file for file in naming if f"`{file}`" not in OTHER} == set()
