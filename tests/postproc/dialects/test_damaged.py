"""Plans in each dialect, with links, tabs and scrap lines too: read back and found sound; damaged, found wrong."""

from __future__ import annotations

import re
from collections.abc import Callable
from itertools import cycle

import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.postproc.dialects import dialect_names
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.check_plan import check_program
from kerfwise.tests.postproc.dialects import cases
from kerfwise.tests.tools.amount import rows

pytestmark = pytest.mark.slow
EVERY = [(name, dialect) for name in cases.NAMES for dialect in cases.case(name).dialects]


def says(name: str, dialect: str, damage: Callable[[str], str] | None = None) -> tuple[str, ...]:
    """The hard rules that a program of the nest breaks; the reader's own words where it is none at all."""
    case, plan = cases.case(name), cases.planned(name)
    plant = case.plant(dialect)
    text = write_program(plan, case.nest, plant)
    if damage is not None:
        damaged = damage(text)
        assert damaged != text
        text = damaged
    try:
        return check_program(case.nest, text, plant, plan=plan).broken()
    except InputError as error:
        return (error.message,)


def turned(text: str) -> str:
    """The first arc the other way round; without arcs, the first move of the first cut."""
    if re.search(r"\bG0?2 ", text) or re.search(r"\bG0?3 X", text):
        return re.sub(r"\bG(0?)([23])(?= X)", lambda g: f"G{g[1]}{5 - int(g[2])}", text, count=1)
    first = r"((?:M0?[347]\b.*|M04)\n(?:.*\n)??.*X)(-?)(\d+)"
    if text.startswith("71\n"):
        first = r"(39\+\d+\n(?:[+-]0)?)([+-])(\d+)"
    if text.startswith("IN;\n"):
        first = r"(PD;\n(?:VS.*\n)?PD)(-?)(\d+)"
    return re.sub(first, lambda m: f"{m[1]}{'+' if m[2] == '-' else '-'}{m[3]}", text, count=1)


def still_on(text: str) -> str:
    """The first way between two cuts with the torch on: GRBL is dark in G0 and HPGL in PU, so G1 and PD there."""
    if text.startswith("IN;\n"):
        return re.sub(r"^PU;\nPU(?=\d)", "PD", text, count=1, flags=re.MULTILINE)
    if "M4 S" in text:
        return re.sub(r"^M5\n((?:\(.*\n)*)G0 ", r"\1G1 ", text, count=1, flags=re.MULTILINE)
    return re.sub(r"^(N\d+ )?(M5 \$0|M08|M5|M03|54)\n", "", text, count=1, flags=re.MULTILINE)


def faster(text: str) -> str:
    """The feed of the first cut half as high again."""
    feed = r"([XYIJ][-\d.]+ F|\b39\+|\bVS)(\d+)(\.\d+)?"
    return re.sub(feed, lambda f: f"{f[1]}{float(f[2] + (f[3] or '')) * 1.5:.{len(f[3] or ' ') - 1}f}", text, count=1)


DAMAGES = {"an arc's sign": turned, "a missing off": still_on, "a feed": faster}
NUMBERS = {name: number for names in (cases.NAMES, dialect_names()) for number, name in enumerate(names)}


def turn(row: tuple[str, str]) -> tuple[bool, int]:
    """When a nest in a dialect has its turn: large nests last."""
    name, dialect = row
    return name not in cases.SMALL, (NUMBERS[name] + NUMBERS[dialect]) % 3


TURNS = sorted(EVERY, key=turn)
"""Each small nest in every third dialect first, another third for the next nest: no nest and no dialect is left out."""
ALWAYS = sum(turn(row) == (False, 0) for row in EVERY)


@pytest.mark.parametrize(("name", "dialect"), rows(TURNS, ALWAYS))
def test_every_program_is_sound(name: str, dialect: str) -> None:
    assert says(name, dialect) == ()


DAMAGED = [(*row, damage) for row in EVERY if row[0] in cases.SMALL for damage in DAMAGES]
SPREAD = sorted(DAMAGED, key=lambda row: (turn(row[:2]), (NUMBERS[row[0]] // 3 - [*DAMAGES].index(row[2])) % 3))
"""Of the plans whose soundness is always looked at, each with one damage first."""


@pytest.mark.parametrize(("name", "dialect", "damage"), rows(SPREAD, ALWAYS))
def test_one_block_changed_is_found(name: str, dialect: str, damage: str) -> None:
    assert says(name, dialect, DAMAGES[damage])


@pytest.mark.parametrize(("dialect", "damage"), rows(zip(dialect_names(), cycle(DAMAGES), strict=False), 0))
def test_one_block_changed_is_found_on_the_plate(dialect: str, damage: str) -> None:
    assert says("a made plate of 115 contours", dialect, DAMAGES[damage])
