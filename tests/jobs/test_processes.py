"""Processes that work side by side: each has its share of the cores, and one that dies takes nothing else with it."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from kerfwise.jobs.process_pool import Died, Workers
from kerfwise.models.jit import machine_cores
from kerfwise.tests.jobs.pieces import doubled, shares

WARNED = """
from kerfwise.jobs.process_pool import Workers
from kerfwise.tests.jobs.pieces import warns
if __name__ == "__main__":
    with Workers(warns, jobs=1) as workers:
        list(workers.run(["measuring plate.dxf, still going"]))
"""


@pytest.mark.slow
def test_warnings_are_notes_without_a_line_of_python(tmp_path: Path) -> None:
    (script := tmp_path / "warned.py").write_text(WARNED)
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, check=True)
    assert done.stderr.splitlines() == ["note: measuring plate.dxf, still going", "note: RuntimeWarning: overflow"]


LEFT_BEHIND = """
import os, sys
from kerfwise.jobs.process_pool import Workers
from kerfwise.tests.jobs.pieces import sleeps
with Workers(sleeps, jobs=1) as workers:
    for _ in workers.run([sys.argv[1]]):
        pass
"""


@pytest.mark.slow
def test_one_that_dies_takes_only_its_own_piece_with_it() -> None:
    begun: list[int] = []
    with Workers(doubled, jobs=2) as workers:
        made = dict(workers.run([1, 13, 7, 2, 8, 3, 13, 4], begun.append))
        assert {piece: answer for piece, answer in made.items() if piece not in (13, 7, 8)} == {1: 2, 2: 4, 3: 6, 4: 8}
        assert isinstance(made[13], Died)
        assert "exit code 3" in str(made[13])
        assert isinstance(made[7], ZeroDivisionError)
        assert "in doubled" in made[7].__notes__[0], "it knows where it came from"
        assert str(made[8]) == "Unsendable: eight8"
        assert begun == [1, 13, 7, 2, 8, 3, 13, 4]
        assert dict(workers.run([5, 6])) == {5: 10, 6: 12}, "the same processes serve again"


@pytest.mark.slow
def test_threads_of_all_are_no_more_than_cores() -> None:
    there = len(machine_cores())
    with Workers(shares, jobs=1000) as workers:
        assert workers.jobs == there
        made = list(workers.run(range(there)))
    assert [answer for _, answer in made] == [(1, 1)] * there
    with Workers(shares, jobs=1) as workers:
        ((_, answer),) = workers.run([0])
    assert answer == (there, there)


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="SIGKILL")
def test_nobody_works_on_for_one_that_was_killed(tmp_path: Path) -> None:
    said = tmp_path / "who"
    first = subprocess.Popen([sys.executable, "-c", LEFT_BEHIND, str(said)])
    until_s = time.monotonic() + 300
    while not (said.exists() and said.read_text()) and time.monotonic() < until_s:
        time.sleep(0.05)
    worker = int(said.read_text())
    first.kill()
    first.wait()
    while time.monotonic() < until_s:
        try:
            os.kill(worker, 0)
        except ProcessLookupError:
            return
        if Path(f"/proc/{worker}/stat").exists() and Path(f"/proc/{worker}/stat").read_text().split()[2] == "Z":
            return  # dead, and not yet buried
        time.sleep(0.05)
    pytest.fail("the process works on")
