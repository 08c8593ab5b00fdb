"""Lists of lists as two flat arrays: those of i lie at `flat[first[i]:first[i + 1]]`."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate

import numpy as np

from kerfwise.arrays import Ints


def ints(values: Sequence[int]) -> Ints:
    """An array of whole numbers, empty ones included."""
    return np.array(values, dtype=np.int64)


def flatten(rows: Sequence[Sequence[int]]) -> tuple[Ints, Ints]:
    """`first` and `flat`.

    Examples
    --------
    >>> [a.tolist() for a in flatten([[5, 6], [], [7]])]
    [[0, 2, 2, 3], [5, 6, 7]]
    """
    return ints([0, *accumulate(len(row) for row in rows)]), ints([x for row in rows for x in row])
