"""What statements about a whole nest still ask of what is left of it, or of the first torch of a gantry."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, assert_never

import shapely

from kerfwise.encoder.facts.compute import without_ways
from kerfwise.encoder.facts.facts import Copies
from kerfwise.rules.rule import Rule
from kerfwise.rules.statements import (
    About,
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
    Move,
    NoGood,
    Pick,
    Precede,
    Statement,
    Steps,
    candidates_named,
    contours_named,
)

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import Facts


# What statements about a whole nest still ask once some of its contours are cut.
#
# Of a contour that is out every order is known: it was cut before all that is left. What that decides is left out,
# whether it holds or not: cuts that are made are facts, and nobody can keep a rule for them any more. What remains is
# only about contours that are left, by their numbers among these. Candidates have the same numbers in both: what is
# out has none.

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


def remaining_statements(statements: Iterable[Statement], rest: Remainder) -> Iterator[Statement]:
    """The statements about a whole nest, as they read for what is left of it.

    - An order between what is out and what is left is kept, or too late.
    - `AtLeast`: literals that are known leave the sum. Where those left can no longer reach the bound, the candidate
      that it was asked of is forbidden; asked of no candidate, it is too late.
    - What is left of a run that has begun is cut in one go.
    - A lag between what is out and what is left is over: metal cools while the machine stands.
    - So is what is asked of a move from what is out.
    - A no-good is over once one of those that were to stay is out, and too late once all the others are.
    - Travel over a part that is out never becomes lawful again: `Crossing.over` is None.

    Examples
    --------
    >>> from kerfwise.rules.statements import About
    >>> about = About("r", (), "")
    >>> orders = [Precede(0, 1, about), Precede(1, 2, about)]
    >>> [(s.before, s.after) for s in remaining_statements(orders, Remainder([-1, 0, 1], {0: 1}))]
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
        case Move():
            leave, reach = (tuple(number[k] for k in side if rest.left(k)) for side in (s.leave, s.reach))
            if leave and reach:
                yield replace(s, leave=leave, reach=reach)
        case NoGood():
            yield from remaining_no_good(s, rest)
        case Crossing():
            yield replace(s, over=None if s.over is None or not rest.left(s.over) else number[s.over])
        case _:
            assert_never(s)


def remaining_no_good(s: NoGood, rest: Remainder) -> Iterator[NoGood]:
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
        case Steps(i, j) if rest.left(i, j):
            return replace(literal, i=rest.number[i], j=rest.number[j])
        case Steps():
            return _left(by_orders(literal, len(rest.number)), rest)
        case Enough():
            left = _open(literal, rest)
            if sum(min(w, 0) for w in left.weights) >= left.bound:
                return True
            return left if sum(max(w, 0) for w in left.weights) >= left.bound else False
        case _:
            assert_never(literal)


def by_orders(steps: Steps, n: int, *, holds: bool = True) -> Enough:
    """Steps, or that they do not hold, by the orders of n contours: so many more come before the one than the other.

    Examples
    --------
    >>> by_orders(Steps(0, 1), 2).literals[0]
    Enough(literals=(Before(i=0, j=1), Before(i=1, j=0)), weights=(1, -1), bound=1)
    """
    i, j = steps.i, steps.j
    orders = (*(Before(k, j) for k in range(n) if k != j), *(Before(k, i) for k in range(n) if k != i))
    up, down = (1,) * (n - 1) + (-1,) * (n - 1), (-1,) * (n - 1) + (1,) * (n - 1)
    after, ahead = (steps.least, -steps.most) if holds else (steps.most + 1, 1 - steps.least)
    return Enough((Enough(orders, up, after), Enough(orders, down, ahead)), (1, 1), 2 if holds else 1)


def _at_least(s: AtLeast, rest: Remainder) -> Iterator[Statement]:
    left = _open(s, rest)
    decided = len(left.literals) < len(s.literals)
    if decided and sum(min(w, 0) for w in left.weights) >= left.bound:
        return
    if not decided or sum(max(w, 0) for w in left.weights) >= left.bound:
        yield replace(s, literals=left.literals, weights=left.weights, bound=left.bound)
    elif s.when is not None:
        yield Forbid(s.when, s.about, s.weight)


def stated_by(rule: Rule[Any], facts: Facts, options: Any) -> Iterable[Statement]:
    """What a rule states of the facts; one that looks at the whole nest states of that, without what is decided.

    Where several torches cut at once, every rule states of the whole, and that is put in terms of the first torch.
    """
    if facts.copies is not None:
        whole = rule.statements(facts.copies.whole, options)
        return GantryStatements(facts.copies, excusable=rule.excusable).of_first(whole, rule.of_each_torch)
    facts = facts if rule.minds_ways else without_ways(facts)
    if facts.past is None or not rule.of_whole_nest:
        return rule.statements(facts, options)
    return remaining_statements(rule.statements(facts.past.whole, options), rest_of(facts))


# Every contour stands for all that is cut together with it. What is cut at one time has no order: of two such
# contours neither may be thought to come first, so that what asks for either order cannot hold.


@dataclass(slots=True)
class GantryStatements:
    """Puts statements about the whole nest in terms of what the first torch cuts.

    `impossible` are contours of the first torch (their own numbers) of which something is asked that cannot be, for it
    is cut together with others, and where that comes from. What an `excusable` rule asks is told so that a plan can
    list where it does not hold.
    """

    copies: Copies
    impossible: list[tuple[int, About]] = field(default_factory=list)
    excusable: bool = False
    runs: set[frozenset[int]] = field(default_factory=set)
    number: Sequence[int] = ()
    candidate: Sequence[int] = ()
    torch: Sequence[int] = ()

    def __post_init__(self) -> None:
        self.number, self.candidate = self.copies.number.tolist(), self.copies.candidate.tolist()
        self.torch = self.copies.torch.tolist()

    def of_first(self, statements: Iterable[Statement], of_each_torch: bool = False) -> Iterator[Statement]:
        """The statements; those of a rule of each torch only where they are about the contours of one."""
        for statement in statements:
            if not of_each_torch or len({self.torch[k] for k in self._contours(statement)}) < 2:
                yield from self._told(statement)

    def _contours(self, s: Statement) -> Iterator[int]:
        yield from contours_named(s)
        yield from (self.copies.whole.candidates[c].contour for c in candidates_named(s))

    def _told(self, s: Statement) -> Iterator[Statement]:
        number = self.number
        match s:
            case Precede():
                before, after = number[s.before], number[s.after]
                if before == after:
                    self._cannot(s, before)
                else:
                    yield replace(s, before=before, after=after)
            case Forbid():
                yield replace(s, candidate=self.candidate[s.candidate])
            case AtLeast():
                yield from self._at_least(s)
            case Contiguous():
                run = tuple(dict.fromkeys(number[k] for k in s.contours))
                if s.weight is not None or frozenset(run) not in self.runs:  # a run of copies is that of the first
                    self.runs.add(frozenset(run))
                    yield replace(s, contours=run)
            case Lag():
                first, second = number[s.first], number[s.second]
                if first == second:
                    self._cannot(s, first)
                else:
                    yield replace(s, first=first, second=second)
            case Move():
                leave, reach = (tuple(dict.fromkeys(number[k] for k in side)) for side in (s.leave, s.reach))
                by = (
                    None if some is None else frozenset(self.candidate[c] for c in some)
                    for some in (s.leaving, s.reaching)
                )
                leaving, reaching = by
                yield replace(s, leave=leave, reach=reach, leaving=leaving, reaching=reaching)
            case NoGood():
                yield from self._no_good(s)
            case Crossing():
                over = None if s.over is None else number[s.over]
                x, y = self.copies.step
                for k in range(max(self.torch)):
                    area = shapely.transform(s.area, lambda xy, k=k: xy - (x * k, y * k))
                    yield replace(s, over=over, area=area)
            case IdleTravel():
                yield s
            case Link():
                raise AssertionError("links are refused where several torches cut")
            case _:
                assert_never(s)

    def _cannot(self, s: Precede | AtLeast | Lag | NoGood, *contours: int) -> None:
        """Note contours that a statement asks what cannot be; a wish with a weight of its own is left out."""
        if s.weight is None:
            self.impossible += [(k, s.about) for k in contours]

    def _at_least(self, s: AtLeast) -> Iterator[Statement]:
        sum_of, at_once = self._sum(s, 1)
        when = None if s.when is None else self.candidate[s.when]
        if sum(w for w in sum_of.weights if w < 0) >= sum_of.bound:
            return
        if sum(w for w in sum_of.weights if w > 0) >= sum_of.bound:
            yield replace(s, literals=sum_of.literals, weights=sum_of.weights, bound=sum_of.bound, when=when)
        elif when is not None:
            never = AtLeast((), (), 1, s.about, when, s.weight)  # unlike a Forbid it can be excused
            yield never if self.excusable else Forbid(when, s.about, s.weight)
        elif at_once:
            self._cannot(s, *sorted(at_once))
        else:
            yield replace(s, literals=sum_of.literals, weights=sum_of.weights, bound=sum_of.bound)

    def _sum(self, s: AtLeast | Enough, sign: int) -> tuple[Enough, set[int]]:
        """A sum in terms of the first torch; what is cut at once counts against it, whichever way it is asked."""
        weights: dict[Literal, int] = {}
        bound, at_once = s.bound, set[int]()
        for literal, weight in zip(s.literals, s.weights, strict=True):
            whole_sum: Literal | None
            match literal:
                case Pick():
                    whole_sum = Pick(self.candidate[literal.c])
                case Before():
                    i, j = self.number[literal.i], self.number[literal.j]
                    whole_sum = Before(i, j) if i != j else None
                    if whole_sum is None:
                        at_once.add(i)
                        bound -= weight if sign * weight < 0 else 0
                case Enough() | Steps():
                    within = literal if isinstance(literal, Enough) else by_orders(literal, len(self.number))
                    whole_sum, more = self._sum(within, sign if weight > 0 else -sign)
                    at_once |= more
                case _:
                    assert_never(literal)
            if whole_sum is not None:
                weights[whole_sum] = weights.get(whole_sum, 0) + weight
        return Enough(tuple(weights), tuple(weights.values()), bound), at_once

    def _no_good(self, s: NoGood) -> Iterator[Statement]:
        """Where one contour that is to be out is cut together with one that is not to be, at that time it is seen."""
        out, left = (frozenset(self.number[k] for k in ks) for ks in (s.out, s.left))
        both = sorted(out & left)
        some_out, some_left = s.about.contours[: len(out)], s.about.contours[len(s.out) :]
        if not both:
            yield replace(s, out=out, left=left, about=replace(s.about, contours=(*some_out, *some_left)))
        elif len(both) == 1:
            (at,) = both
            literals = (*(Before(at, k) for k in sorted(out - {at})), *(Before(k, at) for k in sorted(left - {at})))
            if literals:
                about = replace(s.about, contours=(*some_left, *some_out))
                yield AtLeast(literals, (1,) * len(literals), 1, about, weight=s.weight)
            else:
                self._cannot(s, at)
