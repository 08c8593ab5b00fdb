"""Which hard rules a route could not keep where: what the plan lists as its excuses."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from typing import assert_never

from kerfwise.encoder.facts.facts import Facts
from kerfwise.models.problem.conditions import Condition, of_at_least, of_no_good
from kerfwise.rules.statements import (
    EXEMPTION_MM,
    AtLeast,
    Contiguous,
    Crossing,
    Forbid,
    IdleTravel,
    Lag,
    Link,
    NoGood,
    Precede,
)
from kerfwise.rules.stating.state_rules import Stated


def excused(facts: Facts, stated: Stated, route: Sequence[int]) -> dict[str, tuple[str, ...]]:
    """Contour id → ids of the rules that are excused there; `route` are candidates in cutting order.

    That is where the route breaks a statement that weighs EXEMPTION_MM, and where a rule is exempt in any order.
    """
    return excused_and_used(facts, stated, route)[0]


def excused_and_used(facts: Facts, stated: Stated, route: Sequence[int]) -> tuple[dict[str, tuple[str, ...]], int]:
    """See `excused`; and how many statements that weigh EXEMPTION_MM a route breaks: its objective holds each."""
    rules: dict[str, set[str]] = defaultdict(set)
    for about in stated.exempt:
        for name in about.contours:
            rules[name].add(about.rule)
    used = list(_used(facts, stated, route))
    for condition, name in used:
        rules[name].add(condition.about.rule)
    return {name: tuple(sorted(of)) for name, of in rules.items()}, len(used)


def _used(facts: Facts, stated: Stated, route: Sequence[int]) -> Iterator[tuple[Condition, str]]:
    contour_of = [c.contour for c in facts.candidates]
    asked = _excusable(stated, contour_of)
    already: set[int] = set()
    for c in route:
        for condition, name in asked.get(contour_of[c], ()):
            if condition.when in (None, c) and not condition.met(already):
                yield condition, name
        already.add(contour_of[c])


def _excusable(stated: Stated, contour_of: list[int]) -> dict[int, list[tuple[Condition, str]]]:
    """Contour → the conditions on it that may be excused, each with the id of the contour that is excused.

    That is the first that a statement is about; of a no-good, which is seen when the last of `out` is cut, the first
    that is left.
    """
    found: dict[int, list[tuple[Condition, str]]] = defaultdict(list)
    for s in stated.statements:
        if s.weight != EXEMPTION_MM:
            continue
        match s:
            case NoGood():
                for condition in of_no_good(s, None):
                    found[condition.contour].append((condition, s.about.contours[len(s.out)]))
            case AtLeast():
                if (asked := of_at_least(s, contour_of, None)) is not None:
                    found[asked.contour].append((asked, s.about.contours[0]))
            case Precede() | Forbid() | Contiguous() | Lag() | Crossing() | IdleTravel() | Link():
                pass  # no excusable rule states them
            case _:
                assert_never(s)
    return found
