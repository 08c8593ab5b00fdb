"""Statements of a rule at the price that the profile gives it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from kerfwise.rules.statements import Statement


def weighed(statements: Iterable[Statement], weight: float) -> Iterator[Statement]:
    """The statements at a price, in their order; what its author wants weighed by itself keeps its own weight.

    Examples
    --------
    >>> from kerfwise.rules.statements import About, Precede
    >>> about = About("r", (), "")
    >>> [s.weight for s in weighed([Precede(0, 1, about), Precede(1, 2, about, 5.0)], 25.0)]
    [25.0, 5.0]
    """
    for statement in statements:
        yield statement if statement.weight is not None else replace(statement, weight=weight)
