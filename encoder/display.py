"""Lists, tables and figures as a planner reads them."""

from __future__ import annotations

from collections.abc import Sequence

# Names in a sentence: the first few of them, and how many more there are.


def join_names(names: Sequence[str], most: int) -> str:
    """The first names, `most` of them, and the number of the others.

    Examples
    --------
    >>> join_names(["A", "B"], 2), join_names(["A", "B", "C"], 2)
    ('A, B', 'A, B and 1 more')
    """
    return ", ".join(names[:most]) + (f" and {len(names) - most} more" if len(names) > most else "")


def first_and_last(names: Sequence[str], most: int = 6) -> str:
    """All names, or the first and the last where there are more than `most`.

    Examples
    --------
    >>> first_and_last(["A", "B"]), first_and_last(["A", "B", "C"], most=2)
    ('A, B', 'A … C')
    """
    return ", ".join(names) if len(names) <= most else f"{names[0]} … {names[-1]}"


# Rows of text as columns of equal width, for terminals.


def align_columns(rows: Sequence[Sequence[str]]) -> list[str]:
    """A line for each row; all rows have as many cells as the first.

    Examples
    --------
    >>> align_columns([("", "before", "after"), ("idle travel", "3.1 m", "2.9 m")])
    ['             before  after', 'idle travel  3.1 m   2.9 m']
    """
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return ["  ".join(text.ljust(width) for text, width in zip(row, widths, strict=True)).rstrip() for row in rows]


# Figures as a planner reads them.

NONE = "–"
"""Stands where there is no figure."""


def clock(seconds: float) -> str:
    """Hours, minutes and seconds.

    Examples
    --------
    >>> clock(75.2), clock(3675.0)
    ('1:15', '1:01:15')
    """
    minutes, left = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{left:02d}" if hours else f"{minutes}:{left:02d}"


def money(amount: float | None, currency: str) -> str:
    """An amount with its currency."""
    return NONE if amount is None else f"{amount:.2f} {currency}"


def metres(mm: float) -> str:
    """A length."""
    return f"{mm / 1000:.2f} m"


def percent(share: float | None) -> str:
    """A share; what is 0 is exactly that.

    Examples
    --------
    >>> percent(0.0), percent(0.0123)
    ('0 %', '1.23 %')
    """
    return NONE if share is None else "0 %" if share == 0 else f"{100 * share:.2f} %"
