"""Many objects of one dataclass at once, from columns: a tenth of the time that calling it for each one takes.

Nests of 10,000 contours ask for half a million orders, each with where it comes from.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from itertools import repeat
from typing import Any, TypeVar

ObjectT = TypeVar("ObjectT")


def of_columns(kind: type[ObjectT], count: int, **columns: Iterable[Any]) -> list[ObjectT]:
    """So many objects of a dataclass with slots, the k-th with the k-th value of every column, defaults told as well.

    `__init__` and `__post_init__` are not called, and slots without a column are left empty: the columns are to be what
    a call would leave behind.

    Raises
    ------
    ValueError
        If a column has another number of values.

    Examples
    --------
    >>> from dataclasses import dataclass
    >>> @dataclass(frozen=True, slots=True)
    ... class Order:
    ...     before: int
    ...     after: int
    >>> of_columns(Order, 2, before=[0, 1], after=repeat(5))
    [Order(before=0, after=5), Order(before=1, after=5)]
    """
    made: list[ObjectT] = list(map(object.__new__, repeat(kind, count)))
    for name, values in columns.items():
        column = values if isinstance(values, repeat) else list(values)
        if isinstance(column, list) and len(column) != count:
            raise ValueError(f"{len(column)} values of {name}, expected {count}")
        deque(map(getattr(kind, name).__set__, made, column), maxlen=0)
    return made
