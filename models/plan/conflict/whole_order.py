"""An order and entries that keep all groups, put together step by step: where one is found, nothing contradicts.

It need not be found where there is one. What is found is held against every statement before it counts.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import assert_never

from kerfwise.encoder.facts.facts import Facts
from kerfwise.rules.by_kind import by_kind
from kerfwise.rules.named import candidates_named
from kerfwise.rules.statements import (
    AtLeast,
    Before,
    Contiguous,
    Crossing,
    Enough,
    Forbid,
    Lag,
    Literal,
    NoGood,
    Pick,
    Precede,
)
from kerfwise.rules.stating.cycles import Link
from kerfwise.rules.stating.in_runs import order_in_runs

from .at_once import bounds
from .group import CanClash, Group
from .orders import Orders, forced

TRIES = 20
"""So often an order is made anew, with what the entries that were left had asked for."""


@dataclass(frozen=True, slots=True)
class Way:
    """Places of contours, from 0 on, and the candidates that are used; all but those of `entered` contours are open."""

    place: Sequence[int]
    contour_of: Sequence[int]
    picked: set[int] = field(default_factory=set)
    entered: set[int] = field(default_factory=set)

    def keeps(self, s: CanClash) -> bool:
        """Whether the statement holds, or may hold still where entries are open; moves and seconds are not asked."""
        match s:
            case Precede(i, j):
                return self.place[i] < self.place[j]
            case Forbid(c):
                return c not in self.picked
            case AtLeast():
                if s.when is not None and s.when not in self.picked:
                    return True
                return self._span(s.literals, s.weights)[1] >= s.bound
            case Contiguous(contours):
                places = [self.place[k] for k in contours]
                return not places or max(places) - min(places) < len(set(contours))
            case Lag(i, j):
                return abs(self.place[i] - self.place[j]) > s.cuts
            case NoGood(out, left):
                return any(self.place[k] < max((self.place[m] for m in out), default=0) for k in left)
            case Crossing():
                return True
            case _:
                assert_never(s)

    def _span(self, literals: Sequence[Literal], weights: Sequence[int]) -> tuple[int, int]:
        """The least and the most that the literals which are true may weigh."""
        least = most = 0
        for literal, weight in zip(literals, weights, strict=True):
            true = self._value(literal)
            may_be = (0, weight) if true is None else (weight * true,)
            least, most = least + min(may_be), most + max(may_be)
        return least, most

    def _value(self, literal: Literal) -> bool | None:
        """Whether a literal is true, None where that is open."""
        match literal:
            case Before(i, j):
                return self.place[i] < self.place[j]
            case Pick(c):
                return None if self.contour_of[c] not in self.entered else c in self.picked
            case Enough(literals, weights, bound):
                least, most = self._span(literals, weights)
                return True if least >= bound else False if most < bound else None
            case _:
                assert_never(literal)


def whole_order(facts: Facts, groups: Sequence[Group], said: Sequence[Orders]) -> Way | None:
    """An order of all contours, and entries, that keep every group; None if none was found.

    `said` is what each group says of orders. Moves and seconds are not asked.
    """
    runs = [run for of in said for run in of.runs]
    links = [link for of in said for link in of.links]
    earliest, latest = bounds(said)
    contour_of = [c.contour for c in facts.candidates]
    asked: dict[int, list[CanClash]] = defaultdict(list)
    for group, of in zip(groups, said, strict=True):
        for s in () if of.whole else group.statements:
            for contour in dict.fromkeys(contour_of[c] for c in candidates_named(s)):
                asked[contour].append(s)
    for _ in range(TRIES):
        place = order_in_runs(facts.n, links, runs, earliest, latest)
        if place is None:
            return None
        way = Way(place, contour_of)
        wanted: list[Link] = []
        for contour, statements in asked.items():
            wants = _enter(way, facts.candidates_of(contour), statements)
            if wants is None:
                return None
            wanted += wants
            way.entered.add(contour)
        if not wanted:
            return way if all(way.keeps(s) for group in groups for s in group.statements) else None
        links = [*links, *wanted]
    return None


def _enter(way: Way, candidates: Iterable[int], statements: Sequence[CanClash]) -> list[Link] | None:
    """Use one of the candidates; the orders that it still needs, as few as can be. None if no order would help it."""
    found: tuple[list[Link], int] | None = None
    for c in candidates:
        way.picked.add(c)
        needs = [_needs(s) for s in statements if not way.keeps(s)]
        way.picked.discard(c)
        wants = [link for links in needs for link in links]
        if all(needs) and (found is None or len(wants) < len(found[0])):
            found = wants, c
            if not wants:
                break
    if found is None:
        return None
    way.picked.add(found[1])
    return found[0]


def _needs(s: CanClash) -> list[Link]:
    """The orders that a statement forces."""
    return [link for s in by_kind([s]).at_least for link, _ in forced(s)]
