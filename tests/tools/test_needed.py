"""Without a program that a test needs, the test fails in one line; a test without the marker cannot use it."""

from __future__ import annotations

import sys
from pathlib import Path

import minizinc
import pytest

from kerfwise.apps.batch import run
from kerfwise.tests.tools import browser, canon, typescript
from kerfwise.tests.tools.needed import WITHOUT, keep_from, without_linuxcnc, without_minizinc
from kerfwise.tests.tools.outside import gcode_toolpath

FIND, DRIVER, MODULES = canon.find_rs274, minizinc.default_driver, gcode_toolpath.modules
DASK, CHROMIUM, COMPILER = run.dask, browser.chromium, typescript.compiler


@pytest.fixture
def bare(monkeypatch: pytest.MonkeyPatch) -> None:
    """A machine without any of these programs."""
    monkeypatch.setattr(canon, "find_rs274", FIND)
    monkeypatch.setattr(canon, "ROOT", Path("nowhere"))
    monkeypatch.setattr(minizinc, "default_driver", None)
    monkeypatch.setattr(gcode_toolpath, "modules", MODULES)
    monkeypatch.setattr(gcode_toolpath, "ROOT", Path("nowhere"))
    monkeypatch.setattr(typescript, "compiler", COMPILER)
    monkeypatch.setattr(typescript, "ROOT", Path("nowhere"))
    monkeypatch.setattr(browser, "chromium", CHROMIUM)
    monkeypatch.setattr(run, "dask", DASK)
    monkeypatch.setitem(sys.modules, "distributed", None)
    monkeypatch.delenv("NODE_READERS", raising=False)
    monkeypatch.delenv("RS274", raising=False)
    monkeypatch.setenv("PATH", "")


@pytest.mark.usefixtures("bare")
def test_what_is_missing_is_said_in_one_line() -> None:
    said = {marker: without() or "" for marker, without in WITHOUT.items()}
    assert "sh tests/tools/get_rs274.sh .tools/rs274" in said["linuxcnc"]
    assert "apt-get install minizinc" in said["minizinc"]
    assert "pip install 'kerfwise[cluster]'" in said["dask"]
    assert "sh tests/tools/get_node_readers.sh .tools/node" in said["node"]
    assert "sh tests/tools/get_node_readers.sh .tools/node" in said["typescript"]
    assert "apt-get install chromium" in said["browser"]
    for marker, text in said.items():
        assert "\n" not in text
        assert f"-m 'not {marker}'" in text


@pytest.mark.linuxcnc
def test_nothing_is_said_of_an_interpreter_that_is_there() -> None:
    assert without_linuxcnc() is None


@pytest.mark.minizinc
def test_nothing_is_said_of_a_minizinc_that_is_there() -> None:
    assert without_minizinc() is None


@pytest.mark.parametrize("marker", WITHOUT)
def test_a_test_that_is_not_marked_cannot_use_it(marker: str, monkeypatch: pytest.MonkeyPatch) -> None:
    keep_from(marker, monkeypatch)
    with pytest.raises(AssertionError, match=rf"mark it @pytest\.mark\.{marker}"):
        minizinc.default_driver.available_solvers() if marker == "minizinc" else WITHOUT[marker]()
