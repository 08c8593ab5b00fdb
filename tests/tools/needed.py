"""Programs that some tests need beside Python. A test that uses one has its marker; it fails where there is none."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from kerfwise import InputError
from kerfwise.apps.batch import run
from kerfwise.tests.tools import browser, canon, typescript
from kerfwise.tests.tools.outside import gcode_toolpath

LEFT_OUT = "leaves these tests out"


def without_linuxcnc() -> str | None:
    """How to get LinuxCNC's interpreter, where it is missing."""
    try:
        canon.find_rs274()
    except canon.MissingInterpreter as missing:
        return f"{missing}; -m 'not linuxcnc' {LEFT_OUT}"
    return None


def without_minizinc() -> str | None:
    """How to get MiniZinc, where it is missing."""
    from kerfwise.rules.minizinc.installation import driver

    try:
        driver()
    except InputError as missing:
        return f"{missing}; -m 'not minizinc' {LEFT_OUT}"
    return None


def without_node() -> str | None:
    """How to get gcode-toolpath, where it is missing."""
    try:
        gcode_toolpath.modules()
    except gcode_toolpath.MissingNodeReader as missing:
        return f"{missing}; -m 'not node' {LEFT_OUT}"
    return None


def without_typescript() -> str | None:
    """How to get TypeScript, where it is missing."""
    try:
        typescript.compiler()
    except typescript.MissingTypeScript as missing:
        return f"{missing}; -m 'not typescript' {LEFT_OUT}"
    return None


def without_browser() -> str | None:
    """How to get Chromium, where it is missing."""
    try:
        browser.chromium()
    except browser.MissingBrowser as missing:
        return f"{missing}; -m 'not browser' {LEFT_OUT}"
    return None


def without_dask() -> str | None:
    """How to get Dask, where it is missing."""
    try:
        run.dask()
    except InputError as missing:
        return f"{missing}; -m 'not dask' {LEFT_OUT}"
    return None


WITHOUT: dict[str, Callable[[], str | None]] = {
    "browser": without_browser,
    "dask": without_dask,
    "linuxcnc": without_linuxcnc,
    "minizinc": without_minizinc,
    "node": without_node,
    "typescript": without_typescript,
}
"""Marker → how to get the program, or None where it is there."""


class Unmarked:
    """Stands in the place of a program in a test that has not its marker: whatever is asked of it fails."""

    def __init__(self, marker: str) -> None:
        self.marker = marker

    def __getattr__(self, name: str) -> Any:
        raise AssertionError(f"this test uses a program that not everybody has: mark it @pytest.mark.{self.marker}")


def keep_from(marker: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the program of a marker refuse its service until the test is done."""
    import minizinc

    if marker == "node":
        monkeypatch.setattr(gcode_toolpath, "modules", lambda: Unmarked(marker).path)
    elif marker == "browser":
        monkeypatch.setattr(browser, "chromium", lambda: Unmarked(marker).path)
    elif marker == "typescript":
        monkeypatch.setattr(typescript, "compiler", lambda: Unmarked(marker).path)
    elif marker == "linuxcnc":
        monkeypatch.setattr(canon, "find_rs274", lambda: Unmarked(marker).path)
    elif marker == "dask":
        monkeypatch.setattr(run, "dask", lambda: Unmarked(marker).module)
    else:
        monkeypatch.setattr(minizinc, "default_driver", Unmarked(marker))
