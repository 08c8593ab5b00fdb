"""The pages of the rules are made from the rules."""

from __future__ import annotations

from pathlib import Path

import pytest

from kerfwise import InputError
from kerfwise.rules.flat.model_rule import read_model_rule
from kerfwise.rules.minizinc.twin import Twin, rule_file, twin_of
from kerfwise.rules.options.option import options_of
from kerfwise.rules.pages import all_pages, rule_page, rule_table, texts_page
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.registry import RULES
from kerfwise.tests.commands.run_cli import kerfwise


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


CATALOGUE = Path(__file__).parents[2] / "rules" / "catalogue"


@pytest.mark.parametrize("rule", RULES)
def test_the_table_has_every_rule_with_texts_that_are_there(rule: str) -> None:
    (row,) = (line for line in texts_page().splitlines() if line.startswith(f"| `{rule}` |"))
    _, _, source, twin, place, _ = (cell.strip() for cell in row.split("|"))
    assert (CATALOGUE / source.strip("`")).exists()
    assert (twin == "none") == (not rule_file(rule).exists())
    assert place == "yes" or place == f"no: {RULES[rule].takes_no_file}"


def test_the_command_prints_the_table_and_the_page_ends_with_it() -> None:
    assert kerfwise("rules", "--texts").out == texts_page()
    assert all_pages().endswith(texts_page())


@pytest.mark.parametrize("rule", RULES)
def test_a_file_takes_the_place_or_is_refused_with_the_reason(rule: str, tmp_path: Path) -> None:
    name = rule.replace("-", "_")
    (tmp_path / f"{name}.mzn").write_text(f"array[int] of var bool: {name}_holds = [];\n")
    (tmp_path / "plant.yaml").write_text(f"models: [{name}.mzn]\n")
    why = RULES[rule].takes_no_file
    if not why:
        assert load_profile(tmp_path / "plant.yaml").known_rules()[rule].brought.endswith(f"{name}.mzn")
        assert f"A plant's file `{name}.mzn` may take its place." in rule_page(rule)
        twin = type(twin_of(rule))
        assert rule_file(rule).exists()
        assert twin.data is Twin.data or twin.measured is not Twin.measured, "the check knows what the file reads"
        return
    with pytest.raises(InputError) as refused:
        load_profile(tmp_path / "plant.yaml")
    assert str(refused.value.file) == str(tmp_path / f"{name}.mzn")
    assert refused.value.message.startswith(
        f"rule {rule} takes no file in its place: {why}; give the file another name"
    )
    assert f"No file of a plant takes its place: {why}." in rule_page(rule)
    assert read_model_rule(tmp_path / f"{name}.mzn", rule_id="own:beside").id == "own:beside"
