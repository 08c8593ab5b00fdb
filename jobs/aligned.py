"""Rows of text as columns of equal width, for terminals."""

from __future__ import annotations

from collections.abc import Sequence


def aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    """A line for each row; all rows have as many cells as the first.

    Examples
    --------
    >>> aligned([("", "before", "after"), ("idle travel", "3.1 m", "2.9 m")])
    ['             before  after', 'idle travel  3.1 m   2.9 m']
    """
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return ["  ".join(text.ljust(width) for text, width in zip(row, widths, strict=True)).rstrip() for row in rows]
