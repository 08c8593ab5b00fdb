"""No module imports itself by way of others, and few are imported by most: imports within functions and those for types
alone count as well."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
NO_PRODUCT = {"tests", "benchmarks", "examples", "docs", "build", "node_modules"}
MOST_IMPORTERS = 60
IMPORTED_EVERYWHERE = {
    "arrays": "types of arrays",
    "encoder.cut": "geometry: a cut is a contour's entry, direction and leads",
    "encoder.errors": "the one error that a user sees",
    "encoder.facts.facts": "what rules state from: facts and statements are the words that all stages share",
    "encoder.geometry.curve": "geometry",
    "encoder.geometry.segment": "geometry",
    "encoder.nest": "the nest",
    "rules.statements": "what rules state, and engines keep",
}
Sources = Mapping[str, tuple[str, bool]]
"""Module → its text, and whether it is a package's `__init__.py`."""


def product() -> dict[str, tuple[str, bool]]:
    """Every module of kerfwise but tests, benchmarks and examples."""
    found = {}
    for path in sorted(ROOT.rglob("*.py")):
        words = path.relative_to(ROOT).with_suffix("").parts
        if words[0] in NO_PRODUCT or any(word.startswith(".") for word in words):
            continue
        package = words[-1] == "__init__"
        found[".".join(("kerfwise", *(words[:-1] if package else words)))] = (path.read_text(), package)
    return found


def imported(name: str, text: str, package: bool, modules: Sources) -> Iterator[str]:
    """The modules that one imports, wherever in its text."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name in modules)
        elif isinstance(node, ast.ImportFrom):
            words = name.split(".")
            above = words[: len(words) - node.level + package] if node.level else []
            base = ".".join([*above, *([node.module] if node.module else [])])
            for alias in node.names:
                whole = f"{base}.{alias.name}"
                if whole in modules or base in modules:
                    yield whole if whole in modules else base


def circle(modules: Sources) -> list[str]:
    """Modules that import each other in a circle; none where there is none."""
    links = {
        name: {other for other in imported(name, text, package, modules) if other != name}
        for name, (text, package) in modules.items()
    }
    try:
        TopologicalSorter(links).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def test_no_module_imports_itself_by_way_of_others() -> None:
    modules = product()
    assert len(modules) > 200
    assert circle(modules) == []


def test_no_module_is_imported_by_most_others() -> None:
    modules = product()
    importers = dict.fromkeys(modules, 0)
    for name, (text, package) in modules.items():
        for other in set(imported(name, text, package, modules)) - {name}:
            importers[other] += 1
    many = {name.removeprefix("kerfwise.") for name, count in importers.items() if count > MOST_IMPORTERS}
    assert many == set(IMPORTED_EVERYWHERE)


def test_folders_of_engines_have_at_most_eight_files_and_their_functions_eight_parameters() -> None:
    folders: dict[Path, int] = {}
    for path in sorted((ROOT / "models" / "engines").glob("*/**/*.py")):
        folders[path.parent] = folders.get(path.parent, 0) + 1
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.FunctionDef):
                of = [arg.arg for arg in (*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs)]
                assert len(of) - (of[:1] == ["self"]) <= 8, f"{path}: {node.name}"
    assert len(folders) >= 6
    assert max(folders.values()) <= 8, folders


@pytest.mark.parametrize(
    "late",
    [
        "from .b import two",
        "def one():\n    from .b import two\n    return two",
        "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from .b import two",
        "def one():\n    import k.b\n    return k.b.two",
    ],
)
def test_a_circle_is_found_however_it_is_imported(late: str) -> None:
    modules = {"k": ("", True), "k.a": (late, False), "k.b": ("from k.a import one", False)}
    assert set(circle(modules)) == {"k.a", "k.b"}
    assert circle({**modules, "k.b": ("two = 2", False)}) == []
