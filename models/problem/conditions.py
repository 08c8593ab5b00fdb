"""Conditions: what a statement asks of the set that is already cut at the moment a contour is cut.

Nearly every statement comes down to this one form, so that each engine needs to know it alone: when contour
`contour` is cut (by candidate `when`, or by any if None), with S the set of contours cut before it,

    sum of weights[k] over the members[k] that are in S  >=  bound.

A condition that is not met makes the order unlawful (`cost` None) or costs `cost` µm.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from kerfwise.rules.statements import About, AtLeast, Before, NoGood, Precede


@dataclass(frozen=True, slots=True)
class Condition:
    """One condition on the set already cut; members are contour numbers."""

    contour: int
    members: tuple[int, ...]
    weights: tuple[int, ...]
    bound: int
    about: About = field(hash=False)
    """Equal where all is; most sentences are never made."""
    when: int | None = None
    cost: int | None = None

    def met(self, already: frozenset[int] | set[int]) -> bool:
        """Whether it holds when the contours of `already` are cut before this one."""
        return sum(w for k, w in zip(self.members, self.weights, strict=True) if k in already) >= self.bound


def of_soft_precede(statement: Precede, cost: int) -> Condition:
    """When `before` is cut, `after` is not yet out."""
    return Condition(statement.before, (statement.after,), (-1,), 0, statement.about, cost=cost)


def of_no_good(statement: NoGood, cost: int | None) -> Iterator[Condition]:
    """Whoever of `out` comes last finds one of `left` already out: with k = |out| - 1 others,

    k + 1 for each of `left` in S, less one for each other of `out` in S, is at least 1 - k.
    """
    size = len(statement.out)
    left = sorted(statement.left)
    for last in sorted(statement.out):
        others = sorted(statement.out - {last})
        yield Condition(
            last,
            (*left, *others),
            (size,) * len(left) + (-1,) * len(others),
            2 - size,
            statement.about,
            cost=cost,
        )


def of_at_least(statement: AtLeast, contour_of: Sequence[int], cost: int | None) -> Condition | None:
    """The statement as a condition, if all its literals are about one contour's predecessors; else None.

    `contour_of` maps candidates to contours. `Before(x, i)` is x in S; `Before(i, x)` is 1 minus x in S.
    """
    if statement.when is not None:
        return _about_pivot(statement, contour_of[statement.when], cost)
    pairs = [{lit.i, lit.j} for lit in statement.literals if isinstance(lit, Before)]
    for pivot in sorted(set.intersection(*pairs)) if pairs else ():
        if (made := _about_pivot(statement, pivot, cost)) is not None:
            return made
    return None


def _about_pivot(statement: AtLeast, pivot: int, cost: int | None) -> Condition | None:
    weights: dict[int, int] = {}
    bound = statement.bound
    for literal, weight in zip(statement.literals, statement.weights, strict=True):
        if not isinstance(literal, Before):
            return None
        if literal.j == pivot:
            weights[literal.i] = weights.get(literal.i, 0) + weight
        elif literal.i == pivot:
            weights[literal.j] = weights.get(literal.j, 0) - weight
            bound -= weight
        else:
            return None
    members = tuple(sorted(weights))
    return Condition(pivot, members, tuple([weights[k] for k in members]), bound, statement.about, statement.when, cost)
