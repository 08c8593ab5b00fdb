"""Plans of three nests in each dialect: read back and found sound; with one block changed, found wrong."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cache

import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.jobs.ask import ask, facts_of
from kerfwise.jobs.produce import produce
from kerfwise.jobs.solve_options import options_for
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.dialects import dialect_names
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.checking import check_program
from kerfwise.rules.profile.profile import load_profile
from kerfwise.tests.postproc.dialects import reading, table

pytestmark = pytest.mark.slow
NESTS = ("e1x_6", "s8877", "a made plate of 115 contours")


@cache
def planned(name: str) -> tuple[Plan, Nest]:
    nest, profile = dict(table.nests())[name], load_profile()
    return produce(ask(facts_of(nest, profile), profile), profile, options_for(nest, profile, work=1.0)).plan, nest


def says(name: str, dialect: str, damage: Callable[[str], str] | None = None) -> tuple[str, ...]:
    """The hard rules that a program of the nest breaks; the reader's own words where it is none at all."""
    plan, nest = planned(name)
    plant = reading.with_dialect(load_profile(), dialect)
    text = write_program(plan, nest, plant)
    if damage is not None:
        damaged = damage(text)
        assert damaged != text
        text = damaged
    try:
        return check_program(nest, text, plant, plan=plan).broken()
    except InputError as error:
        return (error.message,)


def turned(text: str) -> str:
    """The first arc the other way round; without arcs, the first move of the first cut."""
    if re.search(r"\bG0?2 ", text) or re.search(r"\bG0?3 X", text):
        return re.sub(r"\bG(0?)([23])(?= X)", lambda g: f"G{g[1]}{5 - int(g[2])}", text, count=1)
    first = r"(39\+\d+\n)([+-])(\d+)" if text.startswith("71\n") else r"((?:M0?[347]\b.*|M04)\n(?:.*\n)??.*X)(-?)(\d+)"
    return re.sub(first, lambda m: f"{m[1]}{'+' if m[2] == '-' else '-'}{m[3]}", text, count=1)


def still_on(text: str) -> str:
    """The first way between two cuts with the torch on: GRBL's beam is dark in G0, so G1 there."""
    if "M4 S" in text:
        return re.sub(r"^M5\n((?:\(.*\n)*)G0 ", r"\1G1 ", text, count=1, flags=re.MULTILINE)
    return re.sub(r"^(N\d+ )?(M5 \$0|M08|M5|M03|54)\n", "", text, count=1, flags=re.MULTILINE)


def faster(text: str) -> str:
    """The feed of the first cut half as high again."""
    feed = r"([XYIJ][-\d.]+ F|\b39\+)(\d+)"
    return re.sub(feed, lambda f: f"{f[1]}{int(f[2]) * 3 // 2}", text, count=1)


DAMAGES = {"an arc's sign": turned, "a missing off": still_on, "a feed": faster}


@pytest.mark.parametrize("dialect", dialect_names())
@pytest.mark.parametrize("name", NESTS)
def test_every_program_is_sound(name: str, dialect: str) -> None:
    assert says(name, dialect) == ()


@pytest.mark.parametrize("damage", DAMAGES)
@pytest.mark.parametrize("dialect", dialect_names())
@pytest.mark.parametrize("name", NESTS[:2])
def test_one_block_changed_is_found(name: str, dialect: str, damage: str) -> None:
    assert says(name, dialect, DAMAGES[damage])


@pytest.mark.parametrize(("dialect", "damage"), list(zip(dialect_names(), [*DAMAGES] * 3, strict=False)))
def test_one_block_changed_is_found_on_the_plate(dialect: str, damage: str) -> None:
    assert says(NESTS[2], dialect, DAMAGES[damage])
