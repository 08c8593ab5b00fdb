"""The figures of the house, counted on a small tree."""

from __future__ import annotations

from pathlib import Path

import pytest

from kerfwise.benchmarks import house

FILES = {
    "__init__.py": "",
    "one.py": "from . import two\n",
    "two.py": "from typing import TYPE_CHECKING\n\nif TYPE_CHECKING:\n    from .three import X\n",
    "three.py": "class X:\n    def late(self) -> None:\n        from .inner.four import f\n",
    "inner/four.py": "from ..two import TYPE_CHECKING\n\n\ndef f() -> None:\n" + "    f()\n" * 60,
    "apps/eight.py": "def g(a, b, c, d, e, f, g, h, *, i) -> None: ...\n",
    "tests/five.py": "from .. import one\n",
    "tests/test_six.py": "import kerfwise\nfrom kerfwise.tests import five\nfrom kerfwise import solve\n",
    "tests/test_seven.py": "from kerfwise import two\n",
    "tests/test_eight.py": "from kerfwise.tests.helper import x\nfrom kerfwise.rule_kit import nest\n",
    "tests/helper.py": "from kerfwise.inner.four import f\n",
}


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    for name, text in FILES.items():
        file = tmp_path / "product" / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    return tmp_path / "product"


def test_lazy_and_typing_imports_make_a_circle_that_loading_does_not(tree: Path) -> None:
    told = {title: (figure, names) for title, figure, names in house.figures(house.read(tree))}
    assert told["product files"][0] == "6"
    assert told["product lines"][0] == str(sum(len(t.splitlines()) for n, t in FILES.items() if "tests" not in n))
    assert told["apps: files, lines"][0] == "1, 1"
    assert told["circles of imports at load (files in them)"][0] == "0 (0)"
    assert told["circles, with lazy and typing imports (files in them)"] == (
        "1 (3)",
        ["product.inner.four · product.three · product.two"],
    )
    assert told["modules with exactly one importer (same folder)"][1] == [
        "product.inner.four ← product.three",
        "product.three ← product.two",
    ]
    assert told["functions past 60 lines, of 3"] == ("1", ["product.inner.four:f@4: 61"])
    assert told["files past 500 lines"] == ("0", [])
    assert told["functions with more than 8 parameters"] == ("1", ["product.apps.eight:g@1: 9"])


def test_a_test_that_reaches_a_room_by_a_helper_is_counted_apart(tree: Path) -> None:
    alone, behind = house.test_figures(tree)
    assert alone == ("test files through the interface, of 3, by themselves", "2", ["kerfwise.tests.test_seven"])
    assert behind[:2] == ("test files through the interface, of 3, with their helpers", "0")
    (tree / "tests" / "five.py").write_text("")
    assert list(house.test_figures(tree))[1][1] == "1"


def test_words_of_prose_are_those_outside_code_tables_and_made_pages(tree: Path) -> None:
    (tree / "docs").mkdir()
    (tree / "README.md").write_text("# Two words\n\n| a | b |\n|---|---|\n")
    (tree / "docs" / "page.md").write_text("Three more words\n\n```sh\nkerfwise solve\n```\n")
    (tree / "docs" / "api.md").write_text("made of the code\n")
    (row,) = house.prose_figures(tree)
    assert row == ("words of prose on 2 pages", "6", ["README.md: 3", "page.md: 3"])


def test_pages_have_at_most_60_000_words_of_prose() -> None:
    ((_, words, _),) = house.prose_figures(Path(house.__file__).parents[1])
    assert int(words.replace(",", "")) <= 60_000
