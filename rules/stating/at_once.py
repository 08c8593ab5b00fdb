"""What statements about a whole nest ask of the first torch, where others cut copies together with it.

Every contour stands for all that is cut together with it. What is cut at one time has no order: of two such contours
neither may be thought to come first, so that what asks for either order cannot hold.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import assert_never

import shapely

from kerfwise.encoder.facts.facts import Copies
from kerfwise.rules.named import candidates_named, contours_named
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
    NoGood,
    Pick,
    Precede,
    Statement,
)


@dataclass(slots=True)
class AtOnce:
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
            made: Literal | None
            match literal:
                case Pick():
                    made = Pick(self.candidate[literal.c])
                case Before():
                    i, j = self.number[literal.i], self.number[literal.j]
                    made = Before(i, j) if i != j else None
                    if made is None:
                        at_once.add(i)
                        bound -= weight if sign * weight < 0 else 0
                case Enough():
                    made, more = self._sum(literal, sign if weight > 0 else -sign)
                    at_once |= more
                case _:
                    assert_never(literal)
            if made is not None:
                weights[made] = weights.get(made, 0) + weight
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
