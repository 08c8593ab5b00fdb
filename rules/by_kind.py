"""Statements sorted by kind: for whoever looks at some kinds only, and leaves the others to others on purpose.

A kind that is not sorted here is refused, and no place may tell kinds apart in any other way than by this or by an
exhaustive `match`: see docs/writing-a-statement.md.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import groupby
from typing import Any, assert_never

from .statements import AtLeast, Contiguous, Crossing, Forbid, IdleTravel, Lag, Link, NoGood, Precede, Statement


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
    )
