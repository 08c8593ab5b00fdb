"""Conditions: what a statement asks of the set that is already cut at the moment a contour is cut.

Nearly every statement comes down to this one form, so that each engine needs to know it alone: when contour
`contour` is cut (by candidate `when`, or by any if None), with S the set of contours cut before it,

    sum of weights[k] over the members[k] that are in S  >=  bound.

A condition that is not met makes the order unlawful (`cost` None) or costs `cost` µm.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from kerfwise.rules.statements import About, AtLeast, Before, NoGood, Precede


@dataclass(frozen=True, slots=True)
class Condition:
    """One condition on the set already cut; members are contour numbers."""

    contour: int
    members: tuple[int, ...]
    weights: tuple[int, ...]
    bound: int
    about: About
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
    if not all(isinstance(lit, Before) for lit in statement.literals):
        return None
    pairs = [lit for lit in statement.literals if isinstance(lit, Before)]
    if statement.when is not None:
        shared = {contour_of[statement.when]}
    else:
        shared = set.intersection(*({p.i, p.j} for p in pairs)) if pairs else set()
    for pivot in sorted(shared):
        if all(pivot in (p.i, p.j) for p in pairs):
            return _about_pivot(statement, pairs, pivot, cost)
    return None


def _about_pivot(statement: AtLeast, pairs: list[Before], pivot: int, cost: int | None) -> Condition:
    weights: dict[int, int] = {}
    bound = statement.bound
    for pair, weight in zip(pairs, statement.weights, strict=True):
        if pair.j == pivot:
            weights[pair.i] = weights.get(pair.i, 0) + weight
        else:
            weights[pair.j] = weights.get(pair.j, 0) - weight
            bound -= weight
    members = tuple(sorted(weights))
    return Condition(
        pivot,
        members,
        tuple(weights[k] for k in members),
        bound,
        statement.about,
        when=statement.when,
        cost=cost,
    )
