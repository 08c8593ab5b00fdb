"""What geometry finds wrong with a whole order, as statements against it: for rules that no statement can say before.

A narrow strip, say, comes of everything that is already cut; the order is judged when it is there, and what is wrong
with it must not occur again (Petunin 2009, fig. 3).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from kerfwise.rules.statements import EXEMPTION_MM, NoGood

from .remainder import no_good_left
from .state_rules import rest_of

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import Facts
    from kerfwise.rules.profile.profile import Profile


def afterthoughts(facts: Facts, profile: Profile) -> Callable[[Sequence[int]], tuple[NoGood, ...]]:
    """A function that says what is wrong with an order (contour numbers), each thing once.

    It answers with nothing when an order shows nothing new: a soft rule, or one that is excusable, may well be broken
    again, at its price.
    """
    nest, whole, book = facts.nest, facts.whole_nest, profile.rulebook()
    index, rest, made = whole.index, rest_of(facts), [cut.contour for cut in facts.already_cut]
    told: set[tuple[str, frozenset[int], frozenset[int]]] = set()

    def look(order: Sequence[int]) -> tuple[NoGood, ...]:
        names = [*made, *(nest.contours[k].id for k in order)]
        found: list[NoGood] = []
        for name, setting in profile.settings().items():
            for wrong in book[name].no_goods(whole, names, setting.options):
                out, left = frozenset(index[k] for k in wrong.out), frozenset(index[k] for k in wrong.left)
                if (name, out, left) not in told:
                    told.add((name, out, left))
                    about = book[name].about((*wrong.out, *wrong.left), wrong.sentence)
                    hard = EXEMPTION_MM if book[name].excusable else None
                    seen = NoGood(out, left, about, hard if setting.weight is None else setting.weight)
                    found += no_good_left(seen, rest)
        return tuple(found)

    return look
