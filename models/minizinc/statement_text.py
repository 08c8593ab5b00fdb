"""Single statements as MiniZinc text: for rules that have no file under `rules/`, such as a plant's own in YAML."""

from __future__ import annotations

from collections.abc import Iterable
from functools import singledispatch

from ...encoder.errors import InputError
from ...rules.statements import AtLeast, Before, Contiguous, Forbid, Lag, Literal, NoGood, Precede, Statement


@singledispatch
def conditions(statement: Statement) -> list[str]:
    """Boolean expressions over the words of `sequence.mzn`; a breach of the statement counts once for each false one.

    Raises
    ------
    InputError
        If the statement is of a kind that MiniZinc is not told of.

    Examples
    --------
    >>> from kerfwise.rules.statements import About
    >>> conditions(Precede(0, 4, About("level-ahead", (), "")))
    ['before(1, 5)']
    """
    raise InputError(
        f"rule {statement.about.rule} cannot be stated for MiniZinc: turn it off in the profile, or use --engine cp-sat"
    )


@conditions.register
def _(statement: Precede) -> list[str]:
    return [f"before({statement.before + 1}, {statement.after + 1})"]


@conditions.register
def _(statement: Forbid) -> list[str]:
    return [f"not picked({statement.candidate + 1})"]


@conditions.register
def _(statement: AtLeast) -> list[str]:
    terms = [
        f"{weight} * bool2int({_literal(literal)})"
        for literal, weight in zip(statement.literals, statement.weights, strict=True)
    ]
    holds = f"{' + '.join(terms) or '0'} >= {statement.bound}"
    return [holds if statement.when is None else f"picked({statement.when + 1}) -> {holds}"]


@conditions.register
def _(statement: Contiguous) -> list[str]:
    return [
        f"forall(j in {_set(others)})(before({i + 1}, j)) \\/ exists(j in {_set(others)})(directly_before(j, {i + 1}))"
        for i in statement.contours
        if (others := set(statement.contours) - {i})
    ]


@conditions.register
def _(statement: Lag) -> list[str]:
    between = f"cuts_between({statement.first + 1}, {statement.second + 1})"
    return [f"{between} >= {k}" for k in range(1, statement.cuts + 1)]


@conditions.register
def _(statement: NoGood) -> list[str]:
    return [f"exists(i in {_set(statement.left)}, j in {_set(statement.out)})(before(i, j))"]


def lag_ms(lag: Lag) -> int:
    """The time that must lie between the two cuts, ms."""
    return round(lag.seconds * 1000)


def missing_ms(lag: Lag) -> str:
    """The milliseconds that are missing between the two cuts, as an expression over the words of `clock.mzn`."""
    return f"max(0, {lag_ms(lag)} - pause_ms({lag.first + 1}, {lag.second + 1}))"


def _literal(literal: Literal) -> str:
    if isinstance(literal, Before):
        return f"before({literal.i + 1}, {literal.j + 1})"
    return f"picked({literal.c + 1})"


def _set(contours: Iterable[int]) -> str:
    return "{" + ", ".join(str(i + 1) for i in sorted(contours)) + "}"
