"""What statements about a whole nest still ask once some of its contours are cut.

Of a contour that is out every order is known: it was cut before all that is left. What that decides is left out,
whether it holds or not: cuts that are made are facts, and nobody can keep a rule for them any more. What remains is
only about contours that are left, by their numbers among these. Candidates have the same numbers in both: what is out
has none.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, assert_never

from kerfwise.rules.statements import (
    AtLeast,
    Before,
    Contiguous,
    Crossing,
    Enough,
    Forbid,
    IdleTravel,
    Lag,
    Link,
    Literal,
    NoGood,
    Pick,
    Precede,
    Statement,
)

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import Facts

OUT = -1


@dataclass(frozen=True, slots=True)
class Remainder:
    """`number[i]` is the number of contour i of the whole among those left, `OUT` where it is out.

    `cut_at` tells when what is out was cut; what has fallen out uncut is not in it.
    """

    number: Sequence[int]
    cut_at: Mapping[int, int]

    def left(self, *contours: int) -> bool:
        """Whether all of these are left."""
        return all(self.number[k] != OUT for k in contours)

    def known(self, i: int, j: int) -> bool | None:
        """Whether contour i is cut before contour j, None where that is still open."""
        if self.left(i, j):
            return None
        if not self.left(i) and not self.left(j):
            return self.cut_at.get(i, math.inf) < self.cut_at.get(j, math.inf)
        return self.left(j)


def rest_of(facts: Facts) -> Remainder:
    """What is left of the whole nest, for statements about that."""
    if facts.past is None:
        return Remainder(range(facts.n), {})
    index = facts.whole_nest.index
    cut_at = {index[cut.contour]: k for k, cut in enumerate(facts.already_cut, 1)}
    return Remainder(facts.past.number.tolist(), cut_at)


def of_what_is_left(statements: Iterable[Statement], rest: Remainder) -> Iterator[Statement]:
    """The statements about a whole nest, as they read for what is left of it.

    - An order between what is out and what is left is kept, or too late.
    - `AtLeast`: literals that are known leave the sum. Where those left can no longer reach the bound, the candidate
      that it was asked of is forbidden; asked of no candidate, it is too late.
    - What is left of a run that has begun is cut in one go.
    - A lag between what is out and what is left is over: metal cools while the machine stands.
    - A no-good is over once one of those that were to stay is out, and too late once all the others are.
    - Travel over a part that is out never becomes lawful again: `Crossing.over` is None.

    Examples
    --------
    >>> from kerfwise.rules.statements import About
    >>> about = About("r", (), "")
    >>> orders = [Precede(0, 1, about), Precede(1, 2, about)]
    >>> [(s.before, s.after) for s in of_what_is_left(orders, Remainder([-1, 0, 1], {0: 1}))]
    [(0, 1)]
    """
    for statement in statements:
        yield from _reduced(statement, rest)


def _reduced(s: Statement, rest: Remainder) -> Iterator[Statement]:
    number = rest.number
    match s:
        case Precede():
            if rest.left(s.before, s.after):
                yield replace(s, before=number[s.before], after=number[s.after])
        case Forbid() | IdleTravel() | Link():
            yield s
        case AtLeast():
            yield from _at_least(s, rest)
        case Contiguous():
            left = tuple(number[k] for k in s.contours if rest.left(k))
            if len(left) > 1:
                yield replace(s, contours=left)
        case Lag():
            if rest.left(s.first, s.second):
                yield replace(s, first=number[s.first], second=number[s.second])
        case NoGood():
            yield from no_good_left(s, rest)
        case Crossing():
            yield replace(s, over=None if s.over is None or not rest.left(s.over) else number[s.over])
        case _:
            assert_never(s)


def no_good_left(s: NoGood, rest: Remainder) -> Iterator[NoGood]:
    """What a no-good about a whole nest still asks of what is left: itself, or nothing."""
    out = frozenset(rest.number[k] for k in s.out if rest.left(k))
    if out and rest.left(*s.left):
        yield replace(s, out=out, left=frozenset(rest.number[k] for k in s.left))


def _open(s: AtLeast | Enough, rest: Remainder) -> Enough:
    """The literals of a sum that are not decided yet, and what the others leave of its bound."""
    literals: list[Literal] = []
    weights: list[int] = []
    bound = s.bound
    for literal, weight in zip(s.literals, s.weights, strict=True):
        left = _left(literal, rest)
        if isinstance(left, bool):
            bound -= weight * left
        else:
            literals.append(left)
            weights.append(weight)
    return Enough(tuple(literals), tuple(weights), bound)


def _left(literal: Literal, rest: Remainder) -> Literal | bool:
    """A literal over what is left, or whether it is decided to hold."""
    match literal:
        case Pick():
            return literal
        case Before(i, j):
            known = rest.known(i, j)
            return Before(rest.number[i], rest.number[j]) if known is None else known
        case Enough():
            left = _open(literal, rest)
            if sum(min(w, 0) for w in left.weights) >= left.bound:
                return True
            return left if sum(max(w, 0) for w in left.weights) >= left.bound else False
        case _:
            assert_never(literal)


def _at_least(s: AtLeast, rest: Remainder) -> Iterator[Statement]:
    left = _open(s, rest)
    decided = len(left.literals) < len(s.literals)
    if decided and sum(min(w, 0) for w in left.weights) >= left.bound:
        return
    if not decided or sum(max(w, 0) for w in left.weights) >= left.bound:
        yield replace(s, literals=left.literals, weights=left.weights, bound=left.bound)
    elif s.when is not None:
        yield Forbid(s.when, s.about, s.weight)
