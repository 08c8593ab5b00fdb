"""Each word of each dialect changed: told before anything is planned, or the program does the same on its control.

What the control knows (`reads`, `also`) stays that of the dialect as it is shipped, so that a changed word does not
bring its own excuse.
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterator
from functools import cache
from typing import Any

import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.postproc.check.reader.controls import Setup
from kerfwise.postproc.check.reader.own_words import control_for
from kerfwise.postproc.check.reader.program import NcProgram
from kerfwise.postproc.check.reader.rs274 import read_nc
from kerfwise.postproc.dialects import Dialect, dialect_names, load_dialect
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.dialect_read_back import read_back
from kerfwise.tests.postproc.dialects.test_outside_readers import case
from kerfwise.tests.tools.amount import rows

WORDS = (
    "header", "footer", "torch_on", "torch_off", "mark_on", "mark_off", "rapid", "line", "arc_cw", "arc_ccw", "feed",
    "dwell", "torch_station", "mark_station",
)  # fmt: skip
OTHERS: dict[str, tuple[object, ...]] = {
    "arc_centre": ("relative", "absolute", "radius", "none"),
    "positions": ("absolute", "incremental"),
    "units": ("inch",),
    "scale": (10.0, 25.4),
    "feed_alone": (True, False),
    "signed": (True,),
    "blanks": (False,),
    "decimals": (0, 1),
    "whole_point": (True,),
    "trailing_zeros": (True,),
    "decimal": (",",),
    "modal": (("motion", "x", "y", "feed"),),
    "greatest_sweep_deg": (30.0,),
}
NUMBER = re.compile(r"(?<=[A-Z])0*(\d+)(?![\d.])")


def changed_blocks(blocks: tuple[str, ...], others: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
    """The blocks with one left out, said twice, in another's place, or with another number."""
    for k, block in enumerate(blocks):
        head, tail = blocks[:k], blocks[k + 1 :]
        yield head + tail
        yield (*head, block, *blocks[k:])
        for found in NUMBER.finditer(block):
            for number in (int(found[1]) + 1, int(found[1]) - 1):
                if number >= 0:
                    yield (*head, f"{block[: found.start()]}{number}{block[found.end() :]}", *tail)
        yield from ((*head, other, *tail) for other in others if other != block)


@cache
def mutants(name: str) -> list[tuple[str, Dialect]]:
    """The dialects that differ from a shipped one by one word, or one setting."""
    made = load_dialect(name)
    torches = tuple(dict.fromkeys((*made.torch_on, *made.torch_off, *made.mark_on, *made.mark_off)))
    found: list[tuple[str, Dialect]] = []
    for key in WORDS:
        value = getattr(made, key)
        words: tuple[str, ...] = (value,) if isinstance(value, str) else value
        motions = (made.rapid, made.line, made.arc_cw, made.arc_ccw)
        others = motions if key in ("rapid", "line", "arc_cw", "arc_ccw") else torches if "_o" in key else ()
        for blocks in changed_blocks(words, others):
            now: Any = blocks if not isinstance(value, str) else blocks[0] if len(blocks) == 1 else None
            if now is not None and (now or key in ("header", "rapid", "line")):
                found.append((f"{key}: {now}", dataclasses.replace(made, **{key: now})))
    for other, values in OTHERS.items():
        for value in values:
            if value != getattr(made, other):
                found.append((f"{other}: {value}", dataclasses.replace(made, **{other: value})))
    return found


def done(program: NcProgram) -> list[float]:
    """What a program does: each burn's tool, ends, length, feed and waits, and the way to it."""
    found: list[float] = []
    for burn in program.burns:
        (x0, y0, *_), *_, (x1, y1, *_) = burn.path.as_rows()
        waits = burn.pierce_s + burn.held_s
        found += [burn.tool, x0, y0, x1, y1, burn.path.length_mm, max(burn.feeds_mm_s), waits, sum(burn.travels_mm)]
    return found


def read(name: str, text: str) -> NcProgram:
    """What the control of a dialect, as it is shipped, makes of a program."""
    held_s = (1.0, 0.0) if load_dialect(name).pierce_dwell == "machine" else (0.0, 0.0)
    return read_nc(text, Setup(held_s=held_s), control=control_for(load_dialect(name)))


QUARTERS = [(name, (k + turn) % 4) for turn in range(4) for k, name in enumerate(dialect_names())]


@pytest.mark.parametrize(("name", "quarter"), rows(QUARTERS, len(dialect_names())))
def test_each_changed_word_is_told_or_harmless(name: str, quarter: int) -> None:
    plan, nest, plant, text = case(name)
    right, silent = done(read(name, text)), []
    told = 0
    for what, dialect in mutants(name)[quarter::4]:
        try:
            read_back(dialect, name)
            made = read(name, write_program(plan, nest, plant, dialect))
        except InputError:
            told += 1
            continue
        told += bool(made.faults or made.hot_rapids)
        if not (made.faults or made.hot_rapids) and done(made) != pytest.approx(right, rel=0.003, abs=0.3):
            silent.append(what)
    assert silent == []
    assert told > 4


def test_a_feed_that_is_not_said_again_is_no_fault_of_a_dialect_with_feeds_alone() -> None:
    for name in ("essi", "hpgl"):
        read_back(dataclasses.replace(load_dialect(name), modal=("feed",)), name)
