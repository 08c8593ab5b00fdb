"""What plans need is compiled ahead, or half of it by a second process."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
import time
from multiprocessing.process import BaseProcess
from pathlib import Path

import pytest

from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.jobs import process_pool, warm_up
from kerfwise.models import jit, numba_cache
from kerfwise.models.engines.search.anneal import walk

COUNTED = """
import sys, numba.core.event as event
class Counted(event.Listener):
    def on_start(self, told): found.append(told.data["dispatcher"].py_func.__name__)
    def on_end(self, told): pass
found = []
event.register("numba:compile", Counted())
from kerfwise.cli import program
program.main(sys.argv[1:], standalone_mode=False)
print("compiled", *found)
"""


@pytest.mark.full
def test_nothing_is_compiled_after_a_warm_up(tmp_path: Path) -> None:
    nest = tmp_path / "n.json"
    nest.write_text(json.dumps(make_sheet(1, 115)), encoding="utf-8")

    def run(*words: str) -> list[str]:
        done = subprocess.run(
            [sys.executable, "-c", COUNTED, *words],
            env={**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "kept")},
            cwd=tmp_path,
            capture_output=True,
            text=True,
            check=True,
        )
        return done.stdout.splitlines()

    first, told = run("warm-up")
    assert "kernels compiled in" in first
    assert str(tmp_path / "kept") in first
    assert {"walk", "sweep", "look_back"} <= set(told.split())
    assert run("warm-up") == [f"0 kernels compiled in 0 s, kept in {tmp_path / 'kept'}", "compiled"]
    assert run("solve", str(nest), "--work", "1")[-1] == "compiled"


@pytest.mark.parametrize(("contours", "kept", "begun"), [(99, False, 0), (100, True, 0), (100, False, 1)])
def test_the_search_is_compiled_beside_where_it_is_needed(
    contours: int, kept: bool, begun: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    processes: list[object] = []

    def begun_process(process: BaseProcess) -> None:
        processes.append(process)

    monkeypatch.setattr(process_pool, "start_quietly", begun_process)
    monkeypatch.setattr(BaseProcess, "is_alive", lambda process: False)
    monkeypatch.setattr(numba_cache, "is_kept", lambda _: kept)
    monkeypatch.setattr(numba_cache, "_beside", {})
    warm_up.search_beside(contours)
    assert len(processes) == begun
    assert [runs() for runs in numba_cache._beside.values()] == [False] * begun
    assert isinstance(walk, jit.Kernel)


def test_no_second_process_is_no_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*_: object, **__: object) -> None:
        raise OSError("no processes here")

    monkeypatch.setattr(process_pool, "start_quietly", refused)
    monkeypatch.setattr(numba_cache, "is_kept", lambda _: False)
    monkeypatch.setattr(numba_cache, "_beside", {})
    warm_up.search_beside(500)
    assert not numba_cache._beside


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere nothing is forked")
def test_the_process_beside_compiles_with_what_this_one_has_loaded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It stands for the search here, which takes seconds."""
    told = tmp_path / "told"
    monkeypatch.setattr(threading, "active_count", lambda: 1)
    monkeypatch.setattr(warm_up, "_problem", lambda *size: size)
    monkeypatch.setattr(warm_up, "_search", lambda size: told.write_text(str(size), encoding="utf-8"))
    monkeypatch.setattr(numba_cache, "is_kept", lambda _: False)
    monkeypatch.setattr(numba_cache, "_beside", {})
    warm_up.search_beside(100)
    (runs,) = numba_cache._beside.values()
    until = time.monotonic() + 120
    while runs() and time.monotonic() < until:
        time.sleep(0.01)
    assert told.read_text(encoding="utf-8") == str((warm_up.FEW, warm_up.FEW))
