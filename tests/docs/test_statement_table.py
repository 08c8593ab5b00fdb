"""The table of docs/architecture.md says what the engines really do."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import get_args

import pytest

import kerfwise
from kerfwise.rule_kit import Statement
from kerfwise.tests.commands.run_cli import kerfwise as command_line
from kerfwise.tests.docs.statement_table import PROVES, REFUSES, answer, table
from kerfwise.tests.models.every_kind import examples

PAGE = Path(kerfwise.__file__).parent / "docs" / "architecture.md"
AGAIN = "python -m kerfwise.tests.docs.statement_table prints what belongs under its comment in docs/architecture.md"


@pytest.mark.full
@pytest.mark.minizinc
def test_the_table_is_what_the_engines_do() -> None:
    page = PAGE.read_text(encoding="utf-8")
    assert table() in page, AGAIN


@pytest.mark.minizinc
def test_every_kind_and_every_engine_is_in_the_table() -> None:
    page = PAGE.read_text(encoding="utf-8")
    assert [kind.__name__ for kind in get_args(Statement) if f"\n| `{kind.__name__}` |" not in page] == []
    engines = [line.split()[0] for line in command_line("engines").out.splitlines() if line and line[0] != " "]
    assert len(engines) > 4
    assert [engine for engine in engines if f"| `{engine}` |" not in page] == []


def test_the_answers_differ_where_the_engines_do() -> None:
    seconds = next(example for example in examples() if example.name == "lag of seconds")
    assert (answer(seconds, "ideals"), answer(seconds, "cp-sat-alone")) == (REFUSES, PROVES)


def test_an_engine_that_ignores_a_statement_is_found() -> None:
    """The engine is given a statement of which the judge counts more breaches than there are."""
    order = next(example for example in examples() if example.name == "order" and not example.hard)
    wrong = replace(order, breaches=lambda way: order.breaches(way) + 1)
    with pytest.raises(AssertionError, match="ignores order"):
        answer(wrong, "ideals")


@pytest.mark.minizinc
def test_what_minizinc_has_no_words_for_is_refused() -> None:
    crossing = next(example for example in examples() if example.name == "crossing")
    assert answer(crossing, "minizinc") == REFUSES
