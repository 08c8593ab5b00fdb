"""Rules are judged without the facts that models are built on."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from kerfwise.rules import catalogue, judging
from kerfwise.rules.catalogue.no_narrow_strips import strips
from kerfwise.rules.expression import node, over_cuts
from kerfwise.rules.own import criteria, demands, known_nest, selector
from kerfwise.rules.registry import catalogue_modules


def imported(node: ast.AST) -> list[str]:
    """Modules imported anywhere below, but for those under `if TYPE_CHECKING`."""
    if isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING":
        return []
    if isinstance(node, ast.ImportFrom):
        return [node.module or ""]
    if isinstance(node, ast.Import):
        return [alias.name for alias in node.names]
    return [name for child in ast.iter_child_nodes(node) for name in imported(child)]


JUDGING = [str(path) for path in sorted(Path(str(judging.__file__)).parent.glob("*.py"))]
OWN = (criteria, demands, known_nest, selector, node, over_cuts)
FILES = [*(m.__file__ for m in (*catalogue_modules(), catalogue, strips, *OWN)), *JUDGING]


@pytest.mark.parametrize("file", FILES, ids=lambda f: Path(str(f)).stem)
def test_no_facts(file: str) -> None:
    tree = ast.parse(Path(file).read_text(encoding="utf-8"))
    assert [name for name in imported(tree) if "facts" in name or "candidates" in name] == []


def test_all_of_the_judging_is_looked_at() -> None:
    assert {"metal", "holding", "facing", "strips"} <= {Path(str(file)).stem for file in FILES}


def test_the_look_for_imports_can_find_one() -> None:
    assert imported(ast.parse("def f():\n    from ..encoder.facts import Facts")) == ["encoder.facts"]
