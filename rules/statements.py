"""The vocabulary of rules: linear conditions and costs over the decisions of a plan, and what each is about."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import groupby
from typing import Any, assert_never

import shapely

# Decisions: `Pick(c)`, candidate c is used; `Before(i, j)`, contour i is cut before contour j; and the route itself.
# Contours and candidates are numbered as in `Facts`. Positions count from 1.


@dataclass(frozen=True, slots=True)
class Before:
    """Literal: contour `i` is cut before contour `j`."""

    i: int
    j: int


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


Literal = Before | Pick | Enough


def plain(literals: Iterable[Literal]) -> Iterator[Before | Pick]:
    """The orders and picks among the literals, and within them.

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


@dataclass(frozen=True, slots=True)
class Precede:
    """Contour `before` is cut before contour `after`."""

    before: int
    after: int
    about: About
    weight: float | None = None


@dataclass(frozen=True, slots=True)
class Forbid:
    """Candidate `candidate` may not be used."""

    candidate: int
    about: About
    weight: float | None = None


@dataclass(frozen=True, slots=True)
class AtLeast:
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


@dataclass(frozen=True, slots=True)
class Contiguous:
    """These contours follow each other without another between."""

    contours: tuple[int, ...]
    about: About
    weight: float | None = None


@dataclass(frozen=True, slots=True)
class Lag:
    """At least `cuts` other cuts and `seconds` s lie between contours `first` and `second`, whichever is cut first.

    If soft, every cut and every second that is missing costs the weight (whole mm for a second).
    """

    first: int
    second: int
    about: About
    cuts: int = 0
    seconds: float = 0.0
    weight: float | None = None


@dataclass(frozen=True, slots=True)
class NoGood:
    """At no moment are all of `out` cut while all of `left` are still in."""

    out: frozenset[int]
    left: frozenset[int]
    about: About
    weight: float | None = None


@dataclass(frozen=True, eq=False, slots=True)
class Crossing:
    """Idle travel over `area` (mm) costs, or is forbidden, once contour `over` is cut: its part may have tipped up.

    With `over` None it is out from the start: an earlier program has cut it.
    """

    over: int | None
    area: shapely.Polygon
    about: About
    weight: float | None = None


@dataclass(frozen=True, slots=True)
class IdleTravel:
    """Idle travel counts, at `weight` a millimetre."""

    about: About
    weight: float = 1.0


@dataclass(frozen=True, eq=False, slots=True)
class Link:
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


@dataclass(frozen=True, slots=True)
class Move:
    """None of the contours `reach` is cut directly after one of `leave`; soft, each time that one is costs the weight.

    With `leaving`, only where the first of the two is cut by one of these candidates; with `reaching`, only where the
    second is.
    """

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


def by_kind(statements: Iterable[Statement]) -> Kinds:
    """Sort statements by kind.

    Raises
    ------
    AssertionError
        If one is of a kind that is not in `Statement`; the message shows it.

    Examples
    --------
    >>> from kerfwise.rules.statements import About
    >>> about = About("r", (), "")
    >>> found = by_kind([Precede(0, 1, about), Forbid(4, about), Precede(1, 2, about)])
    >>> [(s.before, s.after) for s in found.precede], len(found.lag)
    ([(0, 1), (1, 2)], 0)
    """
    precede: list[Precede] = []
    forbid: list[Forbid] = []
    at_least: list[AtLeast] = []
    contiguous: list[Contiguous] = []
    lag: list[Lag] = []
    no_good: list[NoGood] = []
    crossing: list[Crossing] = []
    idle_travel: list[IdleTravel] = []
    link: list[Link] = []
    move: list[Move] = []
    for _, alike in groupby(statements, type):  # those of a kind mostly stand together
        run: list[Any] = list(alike)
        first: Statement = run[0]
        match first:
            case Precede():
                precede.extend(run)
            case Forbid():
                forbid.extend(run)
            case AtLeast():
                at_least.extend(run)
            case Contiguous():
                contiguous.extend(run)
            case Lag():
                lag.extend(run)
            case NoGood():
                no_good.extend(run)
            case Crossing():
                crossing.extend(run)
            case IdleTravel():
                idle_travel.extend(run)
            case Link():
                link.extend(run)
            case Move():
                move.extend(run)
            case _:
                assert_never(first)
    return Kinds(
        precede=tuple(precede),
        forbid=tuple(forbid),
        at_least=tuple(at_least),
        contiguous=tuple(contiguous),
        lag=tuple(lag),
        no_good=tuple(no_good),
        crossing=tuple(crossing),
        idle_travel=tuple(idle_travel),
        link=tuple(link),
        move=tuple(move),
    )


# Which contours and candidates a statement names, by number.


def contours_named(s: Statement) -> Iterator[int]:
    """The contours, perhaps more than once.

    Examples
    --------
    >>> from kerfwise.rules.statements import About
    >>> list(contours_named(Precede(0, 4, About("level-ahead", (), ""))))
    [0, 4]
    """
    match s:
        case Precede():
            yield from (s.before, s.after)
        case Contiguous():
            yield from s.contours
        case Lag():
            yield from (s.first, s.second)
        case NoGood():
            yield from (*s.out, *s.left)
        case AtLeast():
            for literal in plain(s.literals):
                if isinstance(literal, Before):
                    yield from (literal.i, literal.j)
        case Crossing():
            yield from () if s.over is None else (s.over,)
        case Move():
            yield from (*s.leave, *s.reach)
        case Forbid() | IdleTravel() | Link():
            return
        case _:
            assert_never(s)


def candidates_named(s: Statement) -> Iterator[int]:
    """The candidates, perhaps more than once."""
    match s:
        case Forbid():
            yield s.candidate
        case AtLeast():
            yield from (literal.c for literal in plain(s.literals) if isinstance(literal, Pick))
            yield from () if s.when is None else (s.when,)
        case Link():
            yield from (*s.leave, *s.reach)
        case Move():
            yield from (*(s.leaving or ()), *(s.reaching or ()))
        case Precede() | Contiguous() | Lag() | NoGood() | Crossing() | IdleTravel():
            return
        case _:
            assert_never(s)
