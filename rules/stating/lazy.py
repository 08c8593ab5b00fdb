"""What geometry finds wrong with a whole order, as statements against it: for rules that no statement can say before.

A narrow strip, say, comes of everything that is already cut; the order is judged when it is there, and what is wrong
with it must not occur again (Petunin 2009, fig. 3).
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING

from kerfwise.rules.rule import Rule
from kerfwise.rules.statements import EXEMPTION_MM, NoGood, Statement

from .at_once import AtOnce
from .loose_metal import enclosed, meeting_of
from .remainder import no_good_left, rest_of

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import Copies, Facts
    from kerfwise.rules.profile.profile import Profile

SAMPLE, SAMPLE_S = 16, 0.05
"""Contours in a first sample of a look; samples become longer until one takes so many seconds."""
LATER = 1.5
"""How much longer the same number of cuts takes to look at later on, when more is out."""


def afterthoughts(facts: Facts, profile: Profile) -> Callable[[Sequence[int]], tuple[Statement, ...]]:
    """A function that says what is wrong with an order (contour numbers), each thing once.

    It answers with nothing when an order shows nothing new: a soft rule, or one that is excusable, may well be broken
    again, at its price.
    """
    nest, whole, book = facts.nest, facts.whole_nest, profile.rulebook()
    index, rest, made = whole.index, rest_of(facts), [cut.contour for cut in facts.already_cut]
    told: set[tuple[str, frozenset[int], frozenset[int]]] = set()
    enclosing: set[tuple[str, ...]] = set()

    def look(order: Sequence[int]) -> tuple[Statement, ...]:
        found: list[Statement] = []
        for names in _in_turn(facts, [*made, *(nest.contours[k].id for k in order)]):
            found += looked(names)
            found += in_loose_metal(names)
        return tuple(found)

    def looked(names: Sequence[str]) -> Iterator[Statement]:
        for name, setting in profile.settings().items():
            for wrong in book[name].no_goods(whole, names, setting.options):
                out, left = frozenset(index[k] for k in wrong.out), frozenset(index[k] for k in wrong.left)
                if (name, out, left) not in told:
                    told.add((name, out, left))
                    about = book[name].about((*wrong.out, *wrong.left), wrong.sentence)
                    hard = EXEMPTION_MM if book[name].excusable else None
                    seen = NoGood(out, left, about, hard if setting.weight is None else setting.weight)
                    yield from no_good_left(seen, rest) if facts.copies is None else _of_first(facts.copies, seen)

    def in_loose_metal(names: Sequence[str]) -> Iterator[Statement]:
        for statement in enclosed(facts, rest, names):
            if (names_of := statement.about.contours) not in enclosing:
                enclosing.add(names_of)
                yield statement

    return look


def forbids_later(facts: Facts, profile: Profile) -> bool:
    """Whether something forbids what only geometry finds in a whole order; what has a price does not.

    A rule of the profile may, and whatever it says: kerfs that meet may cut metal off.
    """
    if meeting_of(facts.whole_nest, facts.options.kerf_mm):
        return True
    book = profile.rulebook()
    hard = (book[name] for name, setting in profile.settings().items() if setting.weight is None)
    return any(type(rule).no_goods is not Rule.no_goods and not rule.excusable for rule in hard)


def _of_first(copies: Copies, seen: NoGood) -> Iterator[Statement]:
    """A no-good about the whole nest in terms of the first torch; one that no order avoids is the check's to tell."""
    yield from AtOnce(copies).of_first([seen])


def _in_turn(facts: Facts, names: list[str]) -> Iterator[list[str]]:
    """The order of all contours, given that of the first torch: of what is cut together each comes first once."""
    copies = facts.copies
    if copies is None:
        yield names
        return
    ids = [contour.id for contour in copies.whole.nest.contours]
    together = {ids[group.contours[0]]: [ids[k] for k in group.contours] for group in copies.groups}
    for turn in range(max((len(row) for row in together.values()), default=1)):
        rows = (together.get(name, [name]) for name in names)
        yield [name for row in rows for name in (*row[turn % len(row) :], *row[: turn % len(row)])]


def look_takes_s(facts: Facts, profile: Profile, clock: Callable[[], float] = time.monotonic) -> float:
    """About how many seconds a look at one order takes: from looks at stretches of an order.

    Each stretch is another, as what a look has told of some parts is known to the next.
    """
    nest, book = facts.whole_nest, profile.rulebook()
    names = [contour.id for contour in nest.contours]

    def looked_s(stretch: Sequence[str]) -> float:
        began_s = clock()
        for name, setting in profile.settings().items():
            book[name].no_goods(nest, stretch, setting.options)
        return clock() - began_s

    first_s = looked_s(names[:1])  # the first cut tells what every look takes before it begins
    begin, count = 1, SAMPLE
    while (took_s := looked_s(names[begin : begin + count])) - first_s < SAMPLE_S and begin + count < len(names):
        begin, count = begin + count, 2 * count
    looked = max(min(count, len(names) - begin), 1)
    return first_s + LATER * max(took_s - first_s, 0.0) * len(names) / looked
