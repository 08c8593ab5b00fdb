"""Runs of consecutive numbers laid end to end: how a list of (where, how many) becomes an index array."""

from __future__ import annotations

import numpy as np

from kerfwise.arrays import Ints


def laid_out(first: Ints, count: Ints) -> Ints:
    """The numbers first[k] … first[k] + count[k] - 1 of every k, one run after the other.

    Examples
    --------
    >>> laid_out(np.array([10, 3]), np.array([3, 2])).tolist()
    [10, 11, 12, 3, 4]
    """
    before = np.cumsum(count) - count
    return np.repeat(first - before, count) + np.arange(int(count.sum()))
