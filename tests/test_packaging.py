"""What the wheel holds, and what may import what."""

from __future__ import annotations

import doctest
import importlib
import pkgutil
import tomllib
from pathlib import Path

import pytest

import kerfwise

ROOT = Path(kerfwise.__file__).parent
OUTSIDE = {"tests", "examples", "benchmarks", "docs", "build", "dist"}


def modules() -> list[str]:
    found = pkgutil.walk_packages([str(ROOT)], "kerfwise.")
    return [m.name for m in found if m.name.split(".")[1] not in OUTSIDE and not m.name.endswith("__main__")]


def test_every_package_folder_is_in_the_wheel() -> None:
    listed = set(tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["packages"])
    folders = {
        ".".join(["kerfwise", *path.parent.relative_to(ROOT).parts])
        for path in ROOT.rglob("__init__.py")
        if path.relative_to(ROOT).parts[0] not in OUTSIDE and not path.relative_to(ROOT).parts[0].startswith(".")
    }
    assert folders == listed


def test_nothing_that_is_shipped_needs_the_tests() -> None:
    shipped = [
        p for p in ROOT.rglob("*") if p.suffix in (".py", ".txt") and p.relative_to(ROOT).parts[0] not in OUTSIDE
    ]
    shipped = [p for p in shipped if not p.relative_to(ROOT).parts[0].startswith(".")]
    assert len(shipped) > 300
    assert [str(p) for p in shipped if "kerfwise.tests" in p.read_text(encoding="utf-8")] == []


@pytest.mark.parametrize("name", modules())
def test_examples_in_docstrings_run(name: str) -> None:
    result = doctest.testmod(importlib.import_module(name))
    assert result.failed == 0
