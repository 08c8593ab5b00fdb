"""The ways to write a rule without a checkout, each followed to the letter in an empty folder."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from kerfwise import read_plan
from kerfwise.tests.docs.stopwatch import INSTALLING, ROOT, Command, follow, steps

IN_A_CHECKOUT = "\n## A rule of the catalogue\n"
"""From here on a page is for people who have one: `tests/apps/authoring/test_writing_a_rule.py` follows it."""


def page(name: str) -> str:
    return (ROOT / "docs" / name).read_text(encoding="utf-8").partition(IN_A_CHECKOUT)[0]


def order(folder: Path) -> list[str]:
    return [planned.cut.contour for planned in read_plan(folder / "nest.plan.json").cuts]


@pytest.mark.slow
def test_own_rules_in_yaml(tmp_path: Path) -> None:
    said = follow(page("own-rules.md"), tmp_path)
    assert order(tmp_path).index("A.hole2") < order(tmp_path).index("A.hole1")
    (why,) = (text for words, text in said.items() if words.startswith("kerfwise explain"))
    assert "slots narrower than 8 mm warp when the part is hot" in why


@pytest.mark.full
@pytest.mark.minizinc
def test_a_rule_in_python(tmp_path: Path) -> None:
    said = follow(page("writing-a-rule.md"), tmp_path)
    assert order(tmp_path)[-1] == "Strip.outer"
    (why,) = (text for words, text in said.items() if words.startswith("kerfwise explain"))
    assert "Strip.outer is long" in why


@pytest.mark.full
@pytest.mark.minizinc
def test_a_rule_in_minizinc(tmp_path: Path) -> None:
    follow(page("model-files.md"), tmp_path)
    assert order(tmp_path)[-1] == "Strip.outer"


@pytest.mark.parametrize("name", ["own-rules.md", "model-files.md", "writing-a-rule.md"])
def test_a_page_begins_with_installing(name: str) -> None:
    commands = [step.words for step in steps(page(name)) if isinstance(step, Command)]
    assert commands[0] == f"{INSTALLING}../kerfwise"
    assert sum(words.startswith(INSTALLING) for words in commands) == 1
    assert len(commands) > 4


def test_files_and_commands_are_found_in_order() -> None:
    console = "```console\n$ kerfwise rules\nlocks\n…\n$ kerfwise engines\n```\n"
    assert steps(f"Save this as `a/b.yaml`:\n\n```yaml\nname: x\n```\n\n{console}") == [
        ("a/b.yaml", "name: x\n"),
        Command("kerfwise rules", ("locks",)),
        Command("kerfwise engines", ()),
    ]


WRONG = ("$ kerfwise --version\nthis is not said", "$ kerfwise nowhere", "$ python3 -c 'print(1)'")


@pytest.mark.parametrize("console", WRONG)
def test_a_page_that_is_wrong_fails(console: str, tmp_path: Path) -> None:
    with pytest.raises(AssertionError, match=re.escape(console.splitlines()[0].removeprefix("$ "))):
        follow(f"```console\n{console}\n```\n", tmp_path)
