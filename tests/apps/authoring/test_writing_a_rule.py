"""The part of docs/writing-a-rule.md about the catalogue, followed to the letter in a copy of the checkout."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import kerfwise
from kerfwise import read_plan

ROOT = Path(kerfwise.__file__).parent
WHOLE = (ROOT / "docs" / "writing-a-rule.md").read_text(encoding="utf-8")
PAGE = WHOLE.partition("\n## A rule of the catalogue\n")[2]
COMMANDS = re.findall(r"^\$ (.+)$", PAGE, re.MULTILINE)
PYTHON = f'"{sys.executable}"'
WORDS = {
    "kerfwise ": f"{PYTHON} -m kerfwise ",
    "pytest ": f"{PYTHON} -m pytest ",
    "python ": f"{PYTHON} ",
}


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("checkout") / "kerfwise"
    # with what numba has compiled, which is kept beside the modules
    shutil.copytree(ROOT, root, ignore=shutil.ignore_patterns(".*", "*.pyc", "*.egg-info", "build"))
    return root


def run(command: str, root: Path) -> subprocess.CompletedProcess[str]:
    for word, real in WORDS.items():
        if command.startswith(word):
            command = real + command.removeprefix(word)
            break
    env = os.environ | {"PYTHONPATH": str(root.parent), "PYTHONDONTWRITEBYTECODE": "1"}
    return subprocess.run(command, shell=True, cwd=root, env=env, capture_output=True, text=True)


def follow(commands: list[str], copy: Path) -> dict[str, str]:
    """What each of some commands of the page says in the copy."""
    said = {}
    for command in commands:
        result = run(command, copy)
        assert result.returncode == 0, (command, result.stdout, result.stderr)
        said[command] = result.stdout
    return said


@pytest.mark.slow
def test_a_rule_is_begun_as_the_page_says(copy: Path) -> None:
    begun = [COMMANDS[0], "kerfwise rules test long-parts-begun --cases"]
    said = follow([command.replace("long-parts-last", "long-parts-begun") for command in begun], copy)
    assert [*said.values()][-1].endswith(" 0 failed\n")
    shutil.rmtree(copy / "rules" / "catalogue" / "long_parts_begun")


@pytest.mark.full
def test_the_page_works(copy: Path) -> None:
    said = follow(COMMANDS, copy)
    assert "4 cases and 4 comparisons, 0 failed" in said["kerfwise rules test long-parts-last"]
    assert re.search(r"\n\d\d passed", said["pytest -q tests/rules -k long-parts-last"])
    order = [p.cut.contour for p in read_plan(copy / "plan.json").cuts]
    on_the_sheet = [c for c in order if c.endswith(".outer") and c != "G.outer"]
    assert on_the_sheet[-1] == "L.outer"
    verdict = said["kerfwise check docs/own-rules.nest.json plan.json -p plant.yaml"]
    assert re.search(r"^holds +hard +long-parts-last", verdict, re.MULTILINE)
    assert "long-parts-last" in (copy / "rules" / "profile" / "profile.schema.json").read_text(encoding="utf-8")
    assert "<svg" in (copy / "long-parts-last.svg").read_text(encoding="utf-8")
    assert "the file is there already" in run("kerfwise rules new long-parts-final", _taken(copy)).stderr


def _taken(copy: Path) -> Path:
    (copy / "rules/catalogue/long_parts_final").mkdir()
    (copy / "rules/catalogue/long_parts_final/long_parts_final.mzn").write_text("", encoding="utf-8")
    return copy


def test_the_page_has_its_commands() -> None:
    assert len(COMMANDS) == 11
