"""The table of wheels: pip is asked with the right words, and the page names every dependency. No network is used."""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import Any

import pytest

from kerfwise.benchmarks import wheels

MISSING = "ERROR: No matching distribution found for numpy>=2.0\n"


def pip(monkeypatch: pytest.MonkeyPatch, wheel: str, stderr: str = "") -> list[list[str]]:
    """Stands in the place of pip, and downloads this wheel, or fails with these words; what it was asked."""
    asked: list[list[str]] = []

    def run(command: list[str], **_: Any) -> subprocess.CompletedProcess[str]:
        asked.append(command)
        if wheel:
            Path(command[command.index("--dest") + 1], wheel).touch()
        return subprocess.CompletedProcess(command, 0 if wheel else 1, "", stderr)

    monkeypatch.setattr(subprocess, "run", run)
    return asked


def test_the_version_is_that_of_the_wheel(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = pip(monkeypatch, "numpy-2.4.6-cp311-cp311-win_amd64.whl")
    assert wheels.wheel_of("numpy>=2.0", ("win_amd64",)) == "2.4.6"
    (command,) = asked
    assert {"download", "--only-binary=:all:", "--no-deps", "win_amd64", "numpy>=2.0"} <= set(command)


def test_a_missing_wheel_is_told_from_a_pip_that_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    pip(monkeypatch, "", MISSING)
    assert wheels.wheel_of("numpy>=2.0", ("win_amd64",)) is None
    assert wheels.main() == 1
    pip(monkeypatch, "", "ERROR: no network\n")
    with pytest.raises(RuntimeError, match="no network"):
        wheels.wheel_of("numpy>=2.0", ("win_amd64",))


def test_the_page_names_every_dependency() -> None:
    page = (wheels.ROOT / "docs" / "systems.md").read_text(encoding="utf-8")
    rows = [
        line.split("|")[1].strip().strip("`") for line in page.splitlines() if line.startswith("| `") and ">=" in line
    ]
    assert rows == wheels.dependencies(), (
        "make the table of docs/systems.md again: python -m kerfwise.benchmarks.wheels"
    )
