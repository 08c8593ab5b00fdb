"""Lengths added up by whose they are."""

from __future__ import annotations

import numpy as np

from kerfwise.arrays import Floats, Ints


def summed_by(owner: Ints, length_mm: Floats, count: int) -> Floats:
    """Array (count,): the total length of each owner 0…count - 1.

    Examples
    --------
    >>> summed_by(np.array([2, 0, 2]), np.array([1.0, 5.0, 2.0]), 3).tolist()
    [5.0, 0.0, 3.0]
    """
    return np.bincount(owner, weights=length_mm, minlength=count).astype(np.float64)


def summed_by_pair(row: Ints, neighbour: Ints, length_mm: Floats, count: int) -> tuple[Ints, Ints, Floats]:
    """Each (row, neighbour) pair that occurs, sorted, with its total length; neighbours are below `count`.

    Examples
    --------
    >>> row, neighbour, total = summed_by_pair(np.array([1, 0, 1]), np.array([0, 2, 0]), np.array([1.0, 2.0, 3.0]), 3)
    >>> row.tolist(), neighbour.tolist(), total.tolist()
    ([0, 1], [2, 0], [2.0, 4.0])
    """
    pairs, which = np.unique(row * count + neighbour, return_inverse=True)
    return pairs // count, pairs % count, summed_by(which, length_mm, len(pairs))
