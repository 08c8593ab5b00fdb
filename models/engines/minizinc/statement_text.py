"""Single statements as MiniZinc text: for rules that have no file under `rules/`, such as a plant's own in YAML."""

from __future__ import annotations

from collections.abc import Iterable
from typing import assert_never

from kerfwise.encoder.errors import InputError
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


def conditions(statement: Statement) -> list[str]:
    """Boolean expressions over the words of `sequence.mzn`; a breach of the statement counts once for each false one.

    Raises
    ------
    InputError
        If the statement is of a kind that has no words in MiniZinc.

    Examples
    --------
    >>> from kerfwise.rules.statements import About
    >>> conditions(Precede(0, 4, About("level-ahead", (), "")))
    ['before(1, 5)']
    """
    match statement:
        case Precede(before, after):
            return [f"before({before + 1}, {after + 1})"]
        case Forbid(candidate):
            return [f"not picked({candidate + 1})"]
        case AtLeast():
            terms = [
                f"{weight} * bool2int({_literal(literal)})"
                for literal, weight in zip(statement.literals, statement.weights, strict=True)
            ]
            holds = f"{' + '.join(terms) or '0'} >= {statement.bound}"
            return [holds if statement.when is None else f"picked({statement.when + 1}) -> {holds}"]
        case Contiguous(contours):
            return [_follows(i, set(contours) - {i}) for i in contours if len(set(contours)) > 1]
        case Lag(first, second):
            between = f"cuts_between({first + 1}, {second + 1})"
            return [f"{between} >= {k}" for k in range(1, statement.cuts + 1)]
        case NoGood(out, left):
            return [f"exists(i in {_set(left)}, j in {_set(out)})(before(i, j))"]
        case Crossing() | IdleTravel():
            raise InputError(
                f"rule {statement.about.rule} cannot be stated for MiniZinc: turn it off in the profile, "
                "or take another engine, such as portfolio"
            )
        case Link():
            return []  # a price of moves: the table of travel has it
        case _:
            assert_never(statement)


def _follows(i: int, others: set[int]) -> str:
    """Contour i is cut before all the others, or right after one of them."""
    return (
        f"forall(j in {_set(others)})(before({i + 1}, j)) \\/ exists(j in {_set(others)})(directly_before(j, {i + 1}))"
    )


def lag_ms(lag: Lag) -> int:
    """The time that must lie between the two cuts, ms."""
    return round(lag.seconds * 1000)


def missing_ms(lag: Lag) -> str:
    """The milliseconds that are missing between the two cuts, as an expression over the words of `clock.mzn`."""
    return f"max(0, {lag_ms(lag)} - pause_ms({lag.first + 1}, {lag.second + 1}))"


def _literal(literal: Literal) -> str:
    match literal:
        case Before(i, j):
            return f"before({i + 1}, {j + 1})"
        case Pick(c):
            return f"picked({c + 1})"
        case Enough(within, weights, bound):
            terms = (f"{w} * bool2int({_literal(lit)})" for lit, w in zip(within, weights, strict=True))
            return f"({' + '.join(terms) or '0'} >= {bound})"
        case _:
            assert_never(literal)


def _set(contours: Iterable[int]) -> str:
    return "{" + ", ".join(str(i + 1) for i in sorted(contours)) + "}"
