"""The vocabulary of rules: linear conditions and costs over the decisions of a plan, and what each is about."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from itertools import groupby
from typing import Any, ClassVar, Protocol, assert_never, get_args

import shapely

# Decisions: `Pick(c)`, candidate c is used; `Before(i, j)`, contour i is cut before contour j; and the route itself.
# Contours and candidates are numbered as in `Facts`. Positions count from 1.


@dataclass(frozen=True, slots=True)
class Before:
    """Literal: contour `i` is cut before contour `j`."""

    i: int
    j: int


@dataclass(frozen=True, slots=True)
class Steps:
    """Literal: contour `j` is cut `least` to `most` cuts after contour `i`; a negative number is so many before it."""

    i: int
    j: int
    least: int = 1
    most: int = 1


@dataclass(frozen=True, slots=True)
class Pick:
    """Literal: candidate `c` is used."""

    c: int


@dataclass(frozen=True, slots=True)
class Enough:
    """Literal: the weights of those that are true among `literals` come to at least `bound`. A condition in another."""

    literals: tuple[Literal, ...]
    weights: tuple[int, ...]
    bound: int


Literal = Before | Steps | Pick | Enough


def plain(literals: Iterable[Literal]) -> Iterator[Before | Steps | Pick]:
    """The orders, steps and picks among the literals, and within them.

    Examples
    --------
    >>> list(plain([Pick(3), Enough((Before(0, 1), Pick(4)), (1, 1), 2)]))
    [Pick(c=3), Before(i=0, j=1), Pick(c=4)]
    """
    for literal in literals:
        if isinstance(literal, Enough):
            yield from plain(literal.literals)
        else:
            yield literal


@dataclass(frozen=True, slots=True)
class About:
    """Where a statement comes from: the rule's id, the contour ids it is about, and a sentence for the planner."""

    rule: str
    contours: tuple[str, ...]
    sentence: str


# What is known of a plan, and whether a statement holds by it.


class KnownPlan(Protocol):
    """Places of all contours, from 0 on, and what is known of the candidates: none, some, or all."""

    @property
    def place(self) -> Sequence[int]: ...

    def picks(self, c: int) -> bool | None:
        """Whether a candidate is used; None where that is open."""

    def cuts_by(self, contour: int, some: frozenset[int]) -> bool | None:
        """Whether a contour is cut by one of these candidates; None where that is open."""


def value_of(literal: Literal, known: KnownPlan) -> bool | None:
    """Whether a literal is true, None where that is open."""
    match literal:
        case Before(i, j):
            return bool(known.place[i] < known.place[j])
        case Steps(i, j, least, most):
            return bool(least <= known.place[j] - known.place[i] <= most)
        case Pick(c):
            return known.picks(c)
        case Enough(literals, weights, bound):
            return reaches(literals, weights, bound, known)
        case _:
            assert_never(literal)


def reaches(literals: Sequence[Literal], weights: Sequence[int], bound: int, known: KnownPlan) -> bool | None:
    """Whether the weights of the true literals come to the bound, None where that is open."""
    least = most = 0
    for literal, weight in zip(literals, weights, strict=True):
        true = value_of(literal, known)
        may_be = (0, weight) if true is None else (weight * true,)
        least, most = least + min(may_be), most + max(may_be)
    return True if least >= bound else False if most < bound else None


class StatementKind:
    """What every kind of statement tells of itself."""

    __slots__ = ()
    HOLDS_IN_PLACE: ClassVar[bool] = False
    """Whether it keeps the contours that it is about in their places, and is not the order of two of them."""

    def contours_named(self) -> Iterator[int]:
        """The contours that it names, by number, perhaps more than once."""
        yield from ()

    def candidates_named(self) -> Iterator[int]:
        """The candidates that it names, perhaps more than once."""
        yield from ()

    def holds(self, known: KnownPlan) -> bool | None:
        """Whether a plan keeps it; None where entries that are open, moves or seconds decide."""
        return None


@dataclass(frozen=True, slots=True)
class Precede(StatementKind):
    """Contour `before` is cut before contour `after`."""

    before: int
    after: int
    about: About
    weight: float | None = None

    def contours_named(self) -> Iterator[int]:
        yield from (self.before, self.after)

    def holds(self, known: KnownPlan) -> bool | None:
        return bool(known.place[self.before] < known.place[self.after])


@dataclass(frozen=True, slots=True)
class Forbid(StatementKind):
    """Candidate `candidate` may not be used."""

    candidate: int
    about: About
    weight: float | None = None

    def candidates_named(self) -> Iterator[int]:
        yield self.candidate

    def holds(self, known: KnownPlan) -> bool | None:
        used = known.picks(self.candidate)
        return None if used is None else not used


@dataclass(frozen=True, slots=True)
class AtLeast(StatementKind):
    """The sum of weights of the true literals is at least `bound` (whenever candidate `when` is used, if given)."""

    literals: tuple[Literal, ...]
    weights: tuple[int, ...]
    bound: int
    about: About
    when: int | None = None
    weight: float | None = None

    @property
    def hopeless(self) -> bool:
        """Whether no plan can meet it: not even with every literal true that helps."""
        return self.when is None and sum(w for w in self.weights if w > 0) < self.bound

    def contours_named(self) -> Iterator[int]:
        for literal in plain(self.literals):
            if not isinstance(literal, Pick):
                yield from (literal.i, literal.j)

    def candidates_named(self) -> Iterator[int]:
        yield from (literal.c for literal in plain(self.literals) if isinstance(literal, Pick))
        yield from () if self.when is None else (self.when,)

    def holds(self, known: KnownPlan) -> bool | None:
        used = True if self.when is None else known.picks(self.when)
        if not used:
            return None if used is None else True
        return reaches(self.literals, self.weights, self.bound, known)


@dataclass(frozen=True, slots=True)
class Contiguous(StatementKind):
    """These contours follow each other without another between."""

    HOLDS_IN_PLACE = True

    contours: tuple[int, ...]
    about: About
    weight: float | None = None

    def contours_named(self) -> Iterator[int]:
        yield from self.contours

    def holds(self, known: KnownPlan) -> bool | None:
        places = [known.place[k] for k in self.contours]
        return not places or bool(max(places) - min(places) < len(set(self.contours)))


@dataclass(frozen=True, slots=True)
class Lag(StatementKind):
    """At least `cuts` other cuts and `seconds` s lie between contours `first` and `second`, whichever is cut first.

    If soft, every cut and every second that is missing costs the weight (whole mm for a second).
    """

    HOLDS_IN_PLACE = True

    first: int
    second: int
    about: About
    cuts: int = 0
    seconds: float = 0.0
    weight: float | None = None

    def contours_named(self) -> Iterator[int]:
        yield from (self.first, self.second)

    def holds(self, known: KnownPlan) -> bool | None:
        kept = abs(known.place[self.first] - known.place[self.second]) > self.cuts
        return None if kept and self.seconds > 0 else bool(kept)


@dataclass(frozen=True, slots=True)
class NoGood(StatementKind):
    """At no moment are all of `out` cut while all of `left` are still in."""

    HOLDS_IN_PLACE = True

    out: frozenset[int]
    left: frozenset[int]
    about: About
    weight: float | None = None

    def contours_named(self) -> Iterator[int]:
        yield from (*self.out, *self.left)

    def holds(self, known: KnownPlan) -> bool | None:
        last = max((known.place[m] for m in self.out), default=0)
        return any(known.place[k] < last for k in self.left)


@dataclass(frozen=True, eq=False, slots=True)
class Crossing(StatementKind):
    """Idle travel over `area` (mm) costs, or is forbidden, once contour `over` is cut: its part may have tipped up.

    With `over` None it is out from the start: an earlier program has cut it.
    """

    over: int | None
    area: shapely.Polygon
    about: About
    weight: float | None = None

    def contours_named(self) -> Iterator[int]:
        yield from () if self.over is None else (self.over,)


@dataclass(frozen=True, slots=True)
class IdleTravel(StatementKind):
    """Idle travel counts, at `weight` a millimetre."""

    about: About
    weight: float = 1.0


@dataclass(frozen=True, eq=False, slots=True)
class Link(StatementKind):
    """Once one of the candidates `leave` is cut, one of `reach` may follow with the torch on, along `path` (mm).

    The move then costs `weight`, in place of idle travel and of what that crosses, and the cut takes `seconds` more.
    Both are less than 0 where the pierce and the lead-in that are saved are worth more than what is burnt. It is an
    offer: a link that costs no less than idle travel is not taken.
    """

    leave: tuple[int, ...]
    reach: tuple[int, ...]
    path: tuple[tuple[float, float], ...]
    about: About
    weight: float
    seconds: float = 0.0

    def candidates_named(self) -> Iterator[int]:
        yield from (*self.leave, *self.reach)


@dataclass(frozen=True, slots=True)
class Move(StatementKind):
    """None of the contours `reach` is cut directly after one of `leave`; soft, each time that one is costs the weight.

    With `leaving`, only where the first of the two is cut by one of these candidates; with `reaching`, only where the
    second is.
    """

    HOLDS_IN_PLACE = True

    leave: tuple[int, ...]
    reach: tuple[int, ...]
    about: About
    weight: float | None = None
    leaving: frozenset[int] | None = None
    reaching: frozenset[int] | None = None

    def covers(self, i: int, j: int, c: int, d: int) -> bool:
        """Whether it is broken where contour `j`, cut by candidate `d`, directly follows `i`, cut by `c`."""
        by = (self.leaving is None or c in self.leaving) and (self.reaching is None or d in self.reaching)
        return by and i in self.leave and j in self.reach

    def contours_named(self) -> Iterator[int]:
        yield from (*self.leave, *self.reach)

    def candidates_named(self) -> Iterator[int]:
        yield from (*(self.leaving or ()), *(self.reaching or ()))

    def holds(self, known: KnownPlan) -> bool | None:
        reached, found = {known.place[j]: j for j in self.reach}, True
        for i in self.leave:
            if (j := reached.get(known.place[i] + 1)) is not None:
                ways = ((i, self.leaving), (j, self.reaching))
                by = [some is None or known.cuts_by(k, some) for k, some in ways]
                if all(by):
                    return False
                found = found and False in by
        return True if found else None


EXEMPTION_MM = 1e6
"""Weight of a hard statement that may be excused: more than any plan travels, so excuses are fewest before all else."""
RELAXED_MM = 2 * EXEMPTION_MM
"""What breaking a relaxed statement costs: more than anything a rule excuses by itself."""

Statement = Precede | Forbid | AtLeast | Contiguous | Lag | NoGood | Crossing | IdleTravel | Link | Move
"""Every `weight` of None makes a statement hard; a number makes breaking it cost that much, in mm of idle travel."""


# Statements sorted by kind: for whoever looks at some kinds only, and leaves the others to others on purpose.
#
# A kind that is not sorted here is refused, and no place may tell kinds apart in any other way than by this or by an
# exhaustive `match`: see docs/writing-a-statement.md.


@dataclass(frozen=True, slots=True)
class Kinds:
    """Statements of each kind, hard and soft, in the order in which they were given."""

    precede: tuple[Precede, ...]
    forbid: tuple[Forbid, ...]
    at_least: tuple[AtLeast, ...]
    contiguous: tuple[Contiguous, ...]
    lag: tuple[Lag, ...]
    no_good: tuple[NoGood, ...]
    crossing: tuple[Crossing, ...]
    idle_travel: tuple[IdleTravel, ...]
    link: tuple[Link, ...]
    move: tuple[Move, ...]


FIELD_OF: Mapping[type, str] = dict(zip(get_args(Statement), (f.name for f in fields(Kinds)), strict=True))
"""The field of `Kinds` of each kind: they stand there in the order of `Statement`."""


def by_kind(statements: Iterable[Statement]) -> Kinds:
    """Sort statements by kind.

    Raises AssertionError if one is of a kind that is not in `Statement`; the message shows it.

    Examples
    --------
    >>> from kerfwise.rules.statements import About
    >>> about = About("r", (), "")
    >>> found = by_kind([Precede(0, 1, about), Forbid(4, about), Precede(1, 2, about)])
    >>> [(s.before, s.after) for s in found.precede], len(found.lag)
    ([(0, 1), (1, 2)], 0)
    """
    found: dict[type, list[Any]] = {kind: [] for kind in FIELD_OF}
    for kind, alike in groupby(statements, type):  # those of a kind mostly stand together
        run = list(alike)
        if kind not in found:
            raise AssertionError(f"no kind of statement: {run[0]!r}")
        found[kind].extend(run)
    return Kinds(**{field: tuple(found[kind]) for kind, field in FIELD_OF.items()})


def contours_named(s: Statement) -> Iterator[int]:
    """The contours that a statement names, by number, perhaps more than once.

    Examples
    --------
    >>> list(contours_named(Precede(0, 4, About("level-ahead", (), ""))))
    [0, 4]
    """
    return _known(s).contours_named()


def candidates_named(s: Statement) -> Iterator[int]:
    """The candidates that it names, perhaps more than once."""
    return _known(s).candidates_named()


def holds(s: Statement, known: KnownPlan) -> bool | None:
    """Whether a plan keeps it; None where entries that are open, moves or seconds decide."""
    return _known(s).holds(known)


def _known(s: Statement) -> Statement:
    if type(s) not in FIELD_OF:
        raise AssertionError(f"no kind of statement: {s!r}")
    return s
