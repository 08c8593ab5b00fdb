"""What the wheel holds, and what may import what."""

from __future__ import annotations

import ast
import doctest
import importlib
import re
import shutil
import sys
import tomllib
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest

import kerfwise

ROOT = Path(kerfwise.__file__).parent
OUTSIDE = {"tests", "examples", "benchmarks", "docs", "build", "dist"}


def shipped(pattern: str) -> list[Path]:
    """The files of a pattern in the folders that belong to the package."""
    paths = ((path, path.relative_to(ROOT).parts[0]) for path in ROOT.rglob(pattern))
    return [path for path, first in paths if first not in OUTSIDE and not first.startswith(".")]


def test_every_package_folder_is_in_the_wheel() -> None:
    listed = set(tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["packages"])
    folders = {".".join(["kerfwise", *path.parent.relative_to(ROOT).parts]) for path in shipped("__init__.py")}
    assert folders == listed


def test_every_data_file_is_in_the_wheel() -> None:
    patterns = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["package-data"]
    folders = ((ROOT.joinpath(*package.split(".")[1:]), of_it) for package, of_it in patterns.items())
    listed = {path for folder, of_it in folders for pattern in of_it for path in folder.glob(pattern)}
    data = {
        path for path in shipped("*/*") if path.is_file() and path.suffix != ".py" and "__pycache__" not in path.parts
    }
    missing = sorted(str(path.relative_to(ROOT)) for path in data - listed if ".egg-info" not in str(path))
    assert not missing, f"no pattern of package-data in pyproject.toml covers {', '.join(missing)}"
    assert ROOT / "models" / "plan" / "plan.schema.json" in listed


def test_nothing_that_is_shipped_needs_the_tests() -> None:
    texts = [*shipped("*.py"), *shipped("*.txt")]
    assert len(texts) > 300
    assert [str(path) for path in texts if "kerfwise.tests" in path.read_text(encoding="utf-8")] == []


EXTRAS = ("cluster", "nest", "serve", "sheets")
"""Those of apps: the core needs nothing of them."""
UNDECLARED = {"pandas", "anyio", "_typeshed"}
"""Taken where it is there; what starlette is built on; what type checkers alone know."""


def test_whatever_is_imported_is_declared() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    extras = project["optional-dependencies"]
    of_core, of_apps = project["dependencies"], [line for name in EXTRAS for line in extras[name]]
    core = {re.split(r"[\[<>=!~ ]", line)[0].lower() for line in of_core} | UNDECLARED
    apps = core | {re.split(r"[\[<>=!~ ]", line)[0].lower() for line in of_apps}
    by_module = packages_distributions()
    undeclared = set()
    for path in shipped("*.py"):
        declared = apps if path.relative_to(ROOT).parts[0] == "apps" else core
        for node in ast.walk(ast.parse(path.read_bytes())):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            if isinstance(node, ast.ImportFrom) and node.level == 0:
                names = [str(node.module)]
            for name in {name.split(".")[0] for name in names} - sys.stdlib_module_names - {"kerfwise"}:
                if not declared & {one.lower() for one in by_module.get(name, [name])}:
                    undeclared.add((name, str(path.relative_to(ROOT))))
    assert undeclared == set()


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Some examples read nests of `examples`, some write."""
    made = tmp_path_factory.mktemp("docstrings")
    shutil.copytree(ROOT / "examples", made / "examples")
    return made


def with_examples() -> list[str]:
    """Modules with examples: to look for some in all others takes longer than to run these."""
    found = [path.relative_to(ROOT) for path in shipped("*.py") if ">>> " in path.read_text(encoding="utf-8")]
    return sorted(".".join(["kerfwise", *path.with_suffix("").parts]).removesuffix(".__init__") for path in found)


@pytest.mark.parametrize("name", with_examples())
def test_examples_in_docstrings_run(name: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    result = doctest.testmod(importlib.import_module(name))
    assert result.failed == 0
