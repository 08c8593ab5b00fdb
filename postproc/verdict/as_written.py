"""A program held, word by word, against what the writer makes of its plan: whatever was changed by hand is told.

The check judges what a program burns. What else its words do (powers, height control, the process, stations, waits of
the machine) it knows only in part; here every block has to be the plan's own. Comments, line numbers, blanks
and how a number is spelt do not count, and neither do pauses (M0, M1), which the reader judges.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import replace
from itertools import zip_longest

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.shown import shown
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.check import CheckResult
from kerfwise.postproc.dialects import Dialect, fitting_dialect
from kerfwise.postproc.nc.program import write_program
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.rule import Violation

_RULE = "follows-plan"
_COMMENT = re.compile(r"\([^()]*\)|;.*")
_TOKEN = re.compile(r"[A-Z$%]+|[+-]?(?:\d+\.?\d*|\.\d+)|\S")
_PAUSES = ({("M", 0.0)}, {("M", 1.0)})
_LENGTHS = frozenset("XYIJR")
_OFF_MM, _SHARE, _NAMED = 0.1, 1e-3, 3

Word = tuple[str, float]


def held_to_plan(result: CheckResult, nest: Nest, text: str, plan: Plan, profile: Profile) -> CheckResult:
    """The verdict on a program, and where its words are others than those of its plan under this profile.

    A plan that was told from an older program has that one's words: it is not asked.
    """
    if not plan.nest.get("sha256"):
        return result
    dialect = fitting_dialect(profile)
    try:
        own = write_program(plan, nest, profile)
    except InputError:  # of another nest, say: the cuts differ, then
        return result
    found = [Violation(_RULE, (), words) for words in _differences(text, own, dialect)]
    rules = tuple(
        replace(rule, violations=(*rule.violations, *found)) if rule.id == _RULE else rule for rule in result.rules
    )
    return replace(result, rules=rules)


def _differences(text: str, own: str, dialect: Dialect) -> Iterator[str]:
    told = 0
    for mine, other in zip_longest(_blocks(text, dialect), _blocks(own, dialect)):
        if mine is None or other is None:
            yield (
                f"it ends before {_spelt(other)}, which the plan's own program says"
                if mine is None
                else f"line {mine[0]}: it says {_spelt(mine)} where the plan's own program has ended"
            )
            return
        if _same(mine[2], other[2], dialect):
            continue
        told += 1
        yield f"line {mine[0]}: it says {_spelt(mine)}, the plan's own program says {_spelt(other)} there"
        if told >= _NAMED or [letter for letter, _ in mine[2]] != [letter for letter, _ in other[2]]:
            return


Row = tuple[int, str, list[Word]]


def _spelt(row: Row | None) -> str:
    return "" if row is None else f"`{shown(row[1])}`"


def _blocks(text: str, dialect: Dialect) -> Iterator[Row]:
    """Line, text and words of each block that a control acts on."""
    for line, raw in enumerate(text.split("\n"), 1):
        row = (raw if dialect.comment is None else _COMMENT.sub(" ", raw)).strip().upper()
        words = _words(row, dialect)
        if words and {*words} not in _PAUSES and row != "%":
            yield line, row, words


def _words(row: str, dialect: Dialect) -> list[Word]:
    letter, words = "", list[Word]()
    for token in _TOKEN.findall(row.replace(" ", "")):
        try:
            value = float(token)
        except ValueError:
            if letter:
                words.append((letter, math.nan))
            letter = token
            continue
        words.append((letter, value))
        letter = ""
    if letter:
        words.append((letter, math.nan))
    return words[1:] if words and words[0][0] == "N" else words


def _same(mine: list[Word], other: list[Word], dialect: Dialect) -> bool:
    if len(mine) != len(other):
        return False
    lengths = not mine[0][0] and dialect.signed  # a move of signed numbers
    return all(
        one == two and _near(a, b, _OFF_MM * dialect.scale if lengths or one in _LENGTHS else 0.0)
        for (one, a), (two, b) in zip(mine, other, strict=True)
    )


def _near(a: float, b: float, off: float) -> bool:
    return (math.isnan(a) and math.isnan(b)) or abs(a - b) <= max(off, _SHARE * abs(b) if off else 1e-6 + 1e-4 * abs(b))
