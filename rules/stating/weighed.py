"""Statements of a rule at the price that the profile gives it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import fields, replace
from itertools import groupby, repeat
from operator import attrgetter

from kerfwise.encoder.of_columns import of_columns
from kerfwise.rules.statements import Statement

FEW = 8
"""So many statements are made one by one as soon as together."""


def weighed(statements: Iterable[Statement], weight: float) -> Iterator[Statement]:
    """The statements at a price, in their order; what its author wants weighed by itself keeps its own weight.

    Examples
    --------
    >>> from kerfwise.rules.statements import About, Precede
    >>> about = About("r", (), "")
    >>> [s.weight for s in weighed([Precede(0, 1, about), Precede(1, 2, about, 5.0)], 25.0)]
    [25.0, 5.0]
    """
    for (kind, own), run in groupby(statements, lambda s: (type(s), s.weight is not None)):
        given = list(run)
        if own:
            yield from given
        elif len(given) < FEW:
            yield from (replace(s, weight=weight) for s in given)
        else:
            same = [field.name for field in fields(kind) if field.name != "weight"]
            columns = {name: map(attrgetter(name), given) for name in same}
            yield from of_columns(kind, len(given), **columns, weight=repeat(weight))
