"""Stretches of numbers, all in a row."""

from __future__ import annotations

import numpy as np

from kerfwise.arrays import Ints


def spans(low: Ints, high: Ints) -> Ints:
    """All numbers low[0] … high[0] - 1, then low[1] … high[1] - 1, and so on.

    Examples
    --------
    >>> spans(np.array([4, 0, 9]), np.array([6, 0, 10])).tolist()
    [4, 5, 9]
    """
    counts = high - low
    return np.repeat(high - np.cumsum(counts), counts) + np.arange(int(counts.sum()))
