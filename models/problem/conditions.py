"""Conditions: what a statement asks of the set that is already cut at the moment a contour is cut.

Nearly every statement comes down to this one form, so that each engine needs to know it alone: when contour
`contour` is cut (by candidate `when`, or by any if None), with S the set of contours cut before it,

    sum of weights[k] over the members[k] that are in S  >=  bound.

A condition that is not met makes the order unlawful (`cost` None) or costs `cost` µm.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import chain
from operator import is_
from typing import NamedTuple, Self, assert_never

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.encoder.geometry.tolerances import cost_um
from kerfwise.rules.statements import (
    About,
    AtLeast,
    Before,
    Contiguous,
    Crossing,
    Forbid,
    IdleTravel,
    Lag,
    Link,
    Move,
    NoGood,
    Precede,
    Statement,
)


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


class ConditionRows(NamedTuple):
    """Conditions, one a row, as arrays: contour, site (-1 for any) and bound of each; row, member and weight of all."""

    contour: Ints
    site: Ints
    bound: Ints
    row: Ints
    member: Ints
    weight: Ints

    @classmethod
    def of(cls, conditions: Sequence[Condition]) -> Self:
        """The rows of conditions, in their order."""
        sizes = np.array([len(c.members) for c in conditions], dtype=np.int64)
        return cls(
            _column(c.contour for c in conditions),
            _column(-1 if c.when is None else c.when for c in conditions),
            _column(c.bound for c in conditions),
            np.repeat(np.arange(len(sizes)), sizes),
            _column(chain.from_iterable(c.members for c in conditions)),
            _column(chain.from_iterable(c.weights for c in conditions)),
        )

    def by_member(self, n: int) -> tuple[Ints, Ints, Ints]:
        """Where each of n contours begins among the members, (n + 1,), and these members' rows and weights."""
        order = np.argsort(self.member, kind="stable")
        return np.searchsorted(self.member[order], np.arange(n + 1)), self.row[order], self.weight[order]


def _column(values: Iterable[int]) -> Ints:
    return np.fromiter(values, dtype=np.int64)


def soft_precede_condition(statement: Precede, cost: int) -> Condition:
    """When `before` is cut, `after` is not yet out."""
    return Condition(statement.before, (statement.after,), (-1,), 0, statement.about, cost=cost)


def no_good_condition(statement: NoGood, cost: int | None) -> Iterator[Condition]:
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


def at_least_condition(statement: AtLeast, contour_of: Sequence[int], cost: int | None) -> Condition | None:
    """The statement as a condition, if all its literals are about one contour's predecessors; else None.

    `contour_of` maps candidates to contours. `Before(x, i)` is x in S; `Before(i, x)` is 1 minus x in S.
    """
    if statement.when is not None:
        return _about_pivot(statement, contour_of[statement.when], cost)
    pairs = [{lit.i, lit.j} for lit in statement.literals if isinstance(lit, Before)]
    for pivot in sorted(set.intersection(*pairs)) if pairs else ():
        if (condition := _about_pivot(statement, pivot, cost)) is not None:
            return condition
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


# What statements come to before candidates become sites: hard orders as pairs, conditions, and what no condition
# says.
#
# A round of a solve asks for those of the round before and a few more, so that only these are worked out.


def _no_pairs() -> Ints:
    return np.empty((0, 2), dtype=np.int64)


@dataclass(frozen=True, eq=False, slots=True)
class LoweredStatements:
    """Statements and what they come to: `pairs` (k, 2) of contours of which the first is hard before the second.

    In `conditions`, `when` is a candidate. Other kinds of statements are fields of a problem of their own.
    """

    statements: tuple[Statement, ...] = ()
    pairs: Ints = field(default_factory=_no_pairs)
    conditions: tuple[Condition, ...] = ()
    general: tuple[AtLeast, ...] = ()


def starts_with(statements: tuple[object, ...], known: tuple[object, ...]) -> bool:
    """Whether they begin with the very statements that are known."""
    return len(statements) >= len(known) and all(map(is_, known, statements))


def lower_statements(
    statements: tuple[Statement, ...], contour_of: Sequence[int], earlier: LoweredStatements
) -> LoweredStatements:
    """What statements come to; where they begin with those of an `earlier` answer, that is taken over.

    `contour_of` maps candidates to contours, the same ones as for the earlier answer.
    """
    if not starts_with(statements, earlier.statements):
        earlier = LoweredStatements()
    before: list[int] = []
    after: list[int] = []
    conditions: list[Condition] = []
    general: list[AtLeast] = []
    for s in statements[len(earlier.statements) :]:
        match s:
            case Precede():
                if s.weight is None:
                    before.append(s.before)
                    after.append(s.after)
                else:
                    conditions.append(soft_precede_condition(s, cost_um(s.weight)))
            case NoGood():
                conditions.extend(no_good_condition(s, None if s.weight is None else cost_um(s.weight)))
            case AtLeast():
                condition = at_least_condition(s, contour_of, None if s.weight is None else cost_um(s.weight))
                if condition is None:
                    general.append(s)
                else:
                    conditions.append(condition)
            case Forbid() | Contiguous() | Lag() | Crossing() | IdleTravel() | Link() | Move():
                pass  # `make_problem` reads them
            case _:
                assert_never(s)
    return LoweredStatements(
        statements,
        np.concatenate([earlier.pairs, np.array([before, after], dtype=np.int64).T.reshape(-1, 2)]),
        (*earlier.conditions, *conditions),
        (*earlier.general, *general),
    )
