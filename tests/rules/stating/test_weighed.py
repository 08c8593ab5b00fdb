"""Statements at the price of their rule are those that were given, but for the price."""

from __future__ import annotations

from dataclasses import replace

from kerfwise.rules.statements import About, AtLeast, Before, Lag, Precede, Statement
from kerfwise.rules.stating.statement_costs import soften

ABOUT = About("r", (), "")


def test_kinds_and_prices_of_their_own_may_be_mixed() -> None:
    given: list[Statement] = []
    for k in range(24):
        given += [AtLeast((Before(k, 0),), (2,), 1, ABOUT, k)] * (k % 5) + [Lag(k, k + 1, ABOUT, 3)] * (k // 8 * 8)
        given += [Precede(k, 0, ABOUT, 7.0 if k % 3 else None), Precede(0, k, ABOUT, 0.0)]
    found = list(soften(iter(given), 25.0))
    assert found == [replace(s, weight=25.0) if s.weight is None else s for s in given]
    assert any(s.weight == 0.0 for s in found)
    assert all(s.weight is None for s in given if isinstance(s, Lag))


def test_none_are_none() -> None:
    assert list(soften([], 25.0)) == []
