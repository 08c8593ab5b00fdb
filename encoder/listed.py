"""Names in a sentence: the first few of them, and how many more there are."""

from __future__ import annotations

from collections.abc import Sequence


def listed(names: Sequence[str], most: int) -> str:
    """The first names, `most` of them, and the number of the others.

    Examples
    --------
    >>> listed(["A", "B"], 2), listed(["A", "B", "C"], 2)
    ('A, B', 'A, B and 1 more')
    """
    return ", ".join(names[:most]) + (f" and {len(names) - most} more" if len(names) > most else "")
