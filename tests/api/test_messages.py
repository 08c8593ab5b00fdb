"""Messages that both the command line and Python show name an option by both names."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import kerfwise

ROOT = Path(kerfwise.__file__).parent
OF_APPS = ("nesting", "edit", "resequence", "pareto", "distortion", "viewer/compare", "viewer/page")
SHARED = (
    *("encoder", "rules/profile", "rules/options", "rules/stating", "models", "jobs"),
    *(f"apps/{app}" for app in OF_APPS),
)
"""What both go through; `commands`, and the verbs of apps, are the command line's alone."""
OPTIONS = "units|sheet|frame|repair|origin|relax|lock-from|upto|redo-last|engine|time-limit|work"
OPTION = re.compile(rf"(?<![\w-])--({OPTIONS})\b")


def test_an_option_is_named_for_both() -> None:
    assert [found for folder in SHARED for found in _for_one_only(ROOT / folder)] == []


def test_one_that_is_not_would_be_found(tmp_path: Path) -> None:
    (tmp_path / "new.py").write_text('"""About --units."""\nraise ValueError("try --units")\n')
    assert list(_for_one_only(tmp_path)) == ["new.py:2: try --units"]


def _for_one_only(folder: Path) -> Iterator[str]:
    """Texts, but for docstrings, that name an option of the command line and not what it is in Python."""
    for file in sorted(folder.rglob("*.py")):
        source = file.read_text(encoding="utf-8")
        if file.stem.endswith(("verb", "verbs")) or not OPTION.search(source):
            continue
        tree = ast.parse(source)
        docs = {
            id(node.body[0].value)
            for node in ast.walk(tree)
            if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef)
            and node.body
            and isinstance(node.body[0], ast.Expr)
        }
        bare = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
        parts = {id(part) for node in ast.walk(tree) if isinstance(node, ast.JoinedStr) for part in node.values}
        for node in ast.walk(tree):
            if id(node) in docs | bare | parts or not isinstance(node, ast.Constant | ast.JoinedStr):
                continue
            text = _text(node)
            if OPTION.search(text) and "in Python" not in text and "machine.origin" not in text:
                yield f"{file.name}:{node.lineno}: {text}"


def _text(node: ast.Constant | ast.JoinedStr) -> str:
    if isinstance(node, ast.Constant):
        return node.value if isinstance(node.value, str) else ""
    return "".join(str(part.value) if isinstance(part, ast.Constant) else "{}" for part in node.values)
