"""MiniZinc ends with who has begun it, and with its limits, and so does what it has begun itself."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from kerfwise.rules.minizinc import installation

pytestmark = pytest.mark.skipif(os.name != "posix", reason="Windows ends no children of others")

CHILDREN = "echo $$ > {0}/one; sh -c 'echo $$ > {0}/two; exec sleep 100' & wait"


def running(folder: Path) -> list[int]:
    """The numbers of the processes that are there."""
    found = []
    for name in ("one", "two"):
        path = folder / name
        if path.is_file() and (text := path.read_text(encoding="ascii").strip()):
            try:
                os.kill(int(text), 0)
            except ProcessLookupError:
                continue
            found.append(int(text))
    return found


def wait_until(count: int, folder: Path) -> None:
    ends_s = time.monotonic() + 120
    while len(running(folder)) != count:
        assert time.monotonic() < ends_s, running(folder)
        time.sleep(0.02)


def test_a_limit_ends_its_children_too(tmp_path: Path) -> None:
    ran = installation.run("/bin/sh", ["-c", CHILDREN.format(tmp_path)], 1.0)
    assert ran.code is None
    wait_until(0, tmp_path)


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGTERM])
def test_the_death_of_who_runs_it_ends_its_children_too(tmp_path: Path, how: signal.Signals) -> None:
    begun = f"['-c', {CHILDREN.format(tmp_path)!r}]"
    text = f"from kerfwise.rules.minizinc import installation as i; i.run('/bin/sh', {begun}, 90)"
    with subprocess.Popen([sys.executable, "-c", text]) as process:
        wait_until(2, tmp_path)
        process.send_signal(how)
    wait_until(0, tmp_path)


def test_what_it_says_and_ends_with_is_told() -> None:
    ran = installation.run("/bin/sh", ["-c", "echo said; echo wrong >&2; exit 3"], 10.0)
    assert (ran.code, ran.said, ran.complaint, ran.endless) == (3, "said\n", "wrong\n", False)


def test_it_is_held_to_its_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(installation, "MOST_GB", 0.2)
    ran = installation.run(sys.executable, ["-c", "x = bytearray(400_000_000)"], 20.0)
    assert ran.code == 1
    assert "MemoryError" in ran.complaint
