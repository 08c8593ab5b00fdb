"""The pages of the rules are made from the rules."""

from __future__ import annotations

from pathlib import Path

import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.rules.options.option import options_of
from kerfwise.rules.pages import all_pages, rule_page, rule_table
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.registry import RULES


def test_docs_are_up_to_date() -> None:
    written = Path(__file__).parents[2] / "docs" / "rules.md"
    assert written.read_text(encoding="utf-8") == all_pages(), "run python -m kerfwise.rules.pages > docs/rules.md"


@pytest.mark.parametrize("rule", RULES)
def test_page_has_the_sentence_the_source_and_every_option(rule: str) -> None:
    page = rule_page(rule)
    assert page.startswith(f"# {rule}\n\n{RULES[rule].sentence}\n\n## What it does\n")
    assert f"Source: {RULES[rule].source.rstrip('.')}.\n" in page
    assert all(f"| `{option.key}` |" in page for option in options_of(RULES[rule].Options))


def test_table_of_a_profile() -> None:
    table = rule_table(load_profile("water-jet"))
    assert [row.id for row in table][: len(RULES)] == sorted(RULES), "rules from outside come after them"
    found = {row.id: (row.strength, row.weight) for row in table}
    assert found["part-contiguous"] == ("soft", 100.0)
    assert found["zone-order"] == ("off", None)
    assert found["level-ahead"] == ("hard", None)


def test_unknown_rule() -> None:
    with pytest.raises(InputError, match="unknown rule 'hull': did you mean 'hull-before'"):
        rule_page("hull")
