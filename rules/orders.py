"""All orders that an order rule asks for, made together: large nests have hundreds of thousands."""

from __future__ import annotations

from itertools import repeat
from typing import TYPE_CHECKING, Any

from kerfwise.arrays import Ints
from kerfwise.encoder.of_columns import of_columns

from .rule import OrderRule, order_sentence
from .statements import About, Precede

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import Facts


def orders_of(rule: OrderRule[Any], facts: Facts, pairs: Ints) -> list[Precede]:
    """What `rule.precede` gives for each of the pairs of contour numbers, (k, 2) before and after.

    Sentences are made when they are read; those of a rule that a plant has brought at once, so that a mistake in its
    `reason` is told while the rule is at work.
    """
    ids = [contour.id for contour in facts.nest.contours]
    before, after = pairs.T.tolist() if len(pairs) else ([], [])
    names = list(zip(map(ids.__getitem__, before), map(ids.__getitem__, after), strict=True))

    start_side = facts.start_side  # what is kept with the orders until they are read, not all facts

    def said(contours: tuple[str, ...]) -> str:
        first, then = contours
        return order_sentence(rule, first, then, start_side)

    abouts = About.each(rule.id, names, repeat(said))
    if rule.brought:
        for about in abouts:
            about.sentence  # noqa: B018 - reading makes it
    return of_columns(Precede, len(pairs), before=before, after=after, about=abouts, weight=repeat(None))
