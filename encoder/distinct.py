"""The different numbers of an array."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

NumberT = TypeVar("NumberT", bound=np.generic)


def distinct(numbers: NDArray[NumberT]) -> NDArray[NumberT]:
    """The numbers (k,) in rising order, each once.

    Numpy sorts where it is to count them; else it looks by hash, which takes ten times as long for many.

    Examples
    --------
    >>> distinct(np.array([3, 1, 3])).tolist()
    [1, 3]
    """
    once: NDArray[NumberT] = np.unique(numbers, return_counts=True)[0]
    return once


def distinct_pairs(pairs: NDArray[np.int64]) -> NDArray[np.int64]:
    """The rows (k, 2) of whole numbers, none below 0, in rising order, each once.

    Examples
    --------
    >>> distinct_pairs(np.array([[2, 0], [1, 5], [2, 0]])).tolist()
    [[1, 5], [2, 0]]
    """
    over = int(pairs[:, 1].max(initial=0)) + 1
    return np.column_stack(np.divmod(distinct(pairs[:, 0] * over + pairs[:, 1]), over))
