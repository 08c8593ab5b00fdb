"""`kerfwise solve` killed with all that belongs to it, or twice at once: program, plan and picture are of one run.

Every moment of the writing is tried in `tests/postproc/test_killed_writes.py`.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import time
from pathlib import Path

import pytest

from kerfwise.encoder import swap
from kerfwise.encoder.contents import contents
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.commands.test_boundary import PLAIN
from kerfwise.tests.tools.amount import few, full
from kerfwise.tests.tools.killing import COUNTED

OUT = ("plain.nc", "plain.plan.json", "plain.svg")
ORIGINS = ("drawing", "sheet-corner")
SOLVE = ("solve", "plain.json", "-o", OUT[0], "--plan", OUT[1], "--picture", OUT[2], "--work", "0.1", "--origin")
KILLED = f"""
{COUNTED}
from kerfwise.cli import main
from kerfwise.postproc import files
real = files.write_files
sys.executable = ""  # no process beside it goes on: a kill ends all, as a power cut does
def write(contents):
    for name in ("open", "fsync", "link", "replace", "unlink"):
        setattr(os, name, counted(getattr(os, name)))
    real(contents)
files.write_files = write
main()
"""
pytestmark = [pytest.mark.slow, pytest.mark.skipif(os.name != "posix", reason="SIGKILL")]


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plain.json").write_text(json.dumps(PLAIN).replace('"width": 400', '"width": 400.5'))
    return tmp_path


def origin_of_all() -> str:
    """The one origin that program and plan are written for; the check finds the program right there."""
    if Path(swap.LIST).exists():  # as if some time had gone by
        os.utime(swap.LIST, (time.time() - 100, time.time() - 100))
    plan = json.loads(contents(OUT[1])).get("origin", "drawing")
    program = contents(OUT[0]).decode()
    found = re.search(r"\((?:ORIGIN|ZERO)[^)]*\)", program)
    assert found is not None, program[:500]
    assert ("CORNER" in found.group()) == (plan == "sheet-corner"), (plan, found.group())
    assert kerfwise("check", "plain.json", OUT[0], "--origin", plan).code == 0
    assert kerfwise("check", "plain.json", OUT[1], "--origin", plan).code == 0
    assert contents(OUT[2]).endswith(b"</svg>\n")
    return str(plan)


@pytest.mark.parametrize("moments", [(10, 20), full((1, 14, 17, 99))], ids=["two", "others"])
def test_killed_at_some_moments_of_the_writing(folder: Path, moments: tuple[int, ...]) -> None:
    found = []
    for moment in moments:
        assert kerfwise(*SOLVE, ORIGINS[0]).code == 0
        command = [sys.executable, "-c", KILLED, str(moment), *SOLVE, ORIGINS[1]]
        ended = subprocess.run(command, capture_output=True, text=True, check=False)
        assert ended.returncode == (-9 if moment < 99 else 0), (moment, ended.stderr)
        found.append(origin_of_all())
        for left in folder.glob(f"{swap.BESIDE}*"):
            left.unlink()
    assert set(found) == set(ORIGINS)


@pytest.mark.parametrize("late_s", few([0.0, 0.1]))
def test_two_at_once(folder: Path, late_s: float) -> None:
    started = []
    for origin in ORIGINS:
        started.append(subprocess.Popen([sys.executable, "-m", "kerfwise.cli", *SOLVE, origin]))
        time.sleep(late_s)
    assert [process.wait(120) for process in started] == [0, 0]
    assert origin_of_all() in ORIGINS
    assert sorted(path.name for path in folder.iterdir()) == sorted([*OUT, "plain.json"])
