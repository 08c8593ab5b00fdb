"""Which contours and candidates a statement names, by number."""

from __future__ import annotations

from collections.abc import Iterator
from typing import assert_never

from .statements import (
    AtLeast,
    Before,
    Contiguous,
    Crossing,
    Forbid,
    IdleTravel,
    Lag,
    Link,
    NoGood,
    Pick,
    Precede,
    Statement,
    plain,
)


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
        case Precede() | Contiguous() | Lag() | NoGood() | Crossing() | IdleTravel():
            return
        case _:
            assert_never(s)
