"""A plant's rule needs `kerfwise.rule_kit` alone: the template, the pages and a rule of the tests import no more."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

import kerfwise
from kerfwise import rule_kit
from kerfwise.tests.commands.run_cli import kerfwise as command_line
from kerfwise.tests.docs.rule_kit_page import page
from kerfwise.tests.rules.outside.written import RULE

ROOT = Path(kerfwise.__file__).parent


def imported(code: str) -> set[str]:
    """The modules of kerfwise that Python text imports from."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(code)):
        if isinstance(node, ast.ImportFrom):
            found.add(node.module or "")
        elif isinstance(node, ast.Import):
            found |= {name.name for name in node.names}
    return {name for name in found if name.split(".")[0] == "kerfwise"}


def test_the_page_is_current() -> None:
    again = "python -m kerfwise.tests.docs.rule_kit_page > kit.md && mv kit.md docs/rule-kit.md makes it again"
    assert (ROOT / "docs" / "rule-kit.md").read_text(encoding="utf-8") == page(), again


def test_a_new_rule_imports_nothing_else(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert command_line("rules", "new", "long-parts-last", "--python").code == 0
    (path,) = tmp_path.glob("*.py")
    assert imported(path.read_text(encoding="utf-8")) == {"kerfwise.rule_kit"}
    assert imported(RULE) == {"kerfwise.rule_kit"}


@pytest.mark.parametrize("name", ["writing-a-rule.md", "rule-kit.md", "own-rules.md", "model-files.md"])
def test_pages_show_no_other_import(name: str) -> None:
    text = (ROOT / "docs" / name).read_text(encoding="utf-8")
    of_plants = text.partition("## A rule of the catalogue")[0]
    for code in re.findall(r"```python\n(.*?)```", of_plants, re.DOTALL):
        assert imported(code) <= {"kerfwise", "kerfwise.rule_kit"}
    assert set(re.findall(r"from (kerfwise\.[\w.]+) import", of_plants)) <= {"kerfwise.rule_kit"}
    assert not re.search(r"`kerfwise\.(rules|encoder|models|jobs)\.", of_plants)


def test_every_name_is_there_once() -> None:
    assert sorted(set(rule_kit.__all__)) == sorted(rule_kit.__all__)
    assert all(hasattr(rule_kit, name) for name in rule_kit.__all__)
