"""Statements that are relaxed because the hard rules cannot all hold: what they excuse, and nothing else.

A plan lists them among what it has dropped, a program in comments such as `RELAXED 2 level-ahead P1.outer P2.outer`;
where one comment has no room for all contours the next goes on with the same number.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.nest import Nest
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.rule import Ids, Violation
from kerfwise.rules.stating.cycles import path

from .judgement import Excused, Judgement
from .names import folded, ids_by_name

WHY = "relaxed: the hard rules cannot all hold"
_RELAXED = re.compile(r"RELAXED (?P<number>\d+) (?P<rule>\S+) (?P<contours>.+)", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Relaxed:
    """One statement that is relaxed: the rule it comes from and the contours it is about."""

    rule: str
    contours: tuple[str, ...]


def read_relaxed(nest: Nest, comments: Iterable[str]) -> tuple[Relaxed, ...]:
    """What the comments of a program say is relaxed; contours that the nest does not have are left out."""
    comments = tuple(comments)
    ids = ids_by_name(nest, comments)
    found: dict[tuple[int, str], list[str]] = {}
    for words in filter(None, map(_RELAXED.fullmatch, comments)):
        names = (ids.get(folded(name)) for name in words["contours"].split())
        found.setdefault((int(words["number"]), words["rule"].lower()), []).extend(n for n in names if n)
    return tuple(Relaxed(rule, tuple(names)) for (_, rule), names in found.items())


def excuse_relaxed(
    nest: Nest, cuts: CutSequence, profile: Profile, judged: Sequence[Judgement], relaxed: Sequence[Relaxed]
) -> list[Judgement]:
    """The judgements, with violations of hard rules excused where a relaxed statement is all that asked for more."""
    of_rule: dict[str, list[tuple[str, ...]]] = {}
    for statement in relaxed:
        of_rule.setdefault(statement.rule, []).append(statement.contours)
    return [
        _excuse_relaxed(nest, cuts, profile, judgement, of_rule[judgement.id])
        if judgement.strength == "hard" and judgement.violations and judgement.id in of_rule
        else judgement
        for judgement in judged
    ]


def _excuse_relaxed(
    nest: Nest, cuts: CutSequence, profile: Profile, judgement: Judgement, statements: Sequence[tuple[str, ...]]
) -> Judgement:
    rule, options = profile.rulebook()[judgement.id], profile.settings()[judgement.id].options
    orders = rule.pairs(nest, cuts, options)
    runs = [set(run) for run in rule.together(nest, options)]
    excused = {
        k: Excused(v, why) for k, v in enumerate(judgement.violations) if (why := _why(v, statements, orders, runs))
    }
    return replace(
        judgement,
        violations=tuple(v for k, v in enumerate(judgement.violations) if k not in excused),
        excused=(*judgement.excused, *excused.values()),
    )


def _why(
    violation: Violation, statements: Sequence[tuple[str, ...]], orders: Sequence[Ids], runs: Sequence[set[str]]
) -> str | None:
    """Why a violation may stand, if a relaxed statement is about its contours, or held them in this order."""
    named = set(violation.contours)
    for contours in statements:
        if set(contours) == named:
            return WHY
        if set(contours) in runs and named - set(contours) and len(named & set(contours)) > 1:
            return WHY
    gone = {frozenset(contours) for contours in statements}
    if len(named) == 1:  # such as the first of all: nothing but relaxed orders may have moved it
        moved = violation.orders
        return WHY if moved and all(frozenset(pair) in gone for pair in moved) else None
    return WHY if _no_longer_ordered(violation.contours, orders, gone) else None


def _no_longer_ordered(contours: tuple[str, ...], orders: Sequence[Ids], gone: set[frozenset[str]]) -> bool:
    """For two contours that the rule orders by way of others: whether the relaxed orders break every such way."""
    if len(contours) != 2 or not any(name in pair for name in contours for pair in gone):
        return False
    number: dict[str, int] = {}
    for pair in (contours, *orders):
        for name in pair:
            number.setdefault(name, len(number))
    links = [(number[a], number[b]) for a, b in orders]
    left = [k for k, pair in enumerate(orders) if frozenset(pair) not in gone]
    one, other = number[contours[0]], number[contours[1]]
    asked = path(links, range(len(links)), one, other) is not None
    return asked and path(links, left, one, other) is None


def relaxed_warnings(relaxed: Sequence[Relaxed]) -> Iterator[str]:
    """A line for every statement that is relaxed: a check never passes over them in silence."""
    yield from (f"relaxed: {statement.rule} about {', '.join(statement.contours)}" for statement in relaxed)
