"""Sets of intervals on a line, each an array (k, 2) of ends in order that do not touch."""

from __future__ import annotations

import numpy as np

from kerfwise.arrays import Floats

NONE: Floats = np.empty((0, 2))


def union(rows: Floats, slack_mm: float = 1e-9) -> Floats:
    """Any intervals (n, 2) as a set; those less than `slack_mm` apart become one.

    Examples
    --------
    >>> union(np.array([[4.0, 6.0], [0.0, 1.0], [5.0, 9.0]])).tolist()
    [[0.0, 1.0], [4.0, 9.0]]
    """
    if not len(rows):
        return NONE
    rows = rows[np.argsort(rows[:, 0], kind="stable")]
    reach = np.maximum.accumulate(rows[:, 1])
    new = np.concatenate([[True], rows[1:, 0] > reach[:-1] + slack_mm])
    first = np.flatnonzero(new)
    return np.stack([rows[first, 0], reach[np.concatenate([first[1:] - 1, [len(rows) - 1]])]], axis=1)


def rest(held: Floats, length_mm: float) -> Floats:
    """What a set leaves of 0 to `length_mm`.

    Examples
    --------
    >>> rest(np.array([[1.0, 2.0], [5.0, 9.0]]), 8.0).tolist()
    [[0.0, 1.0], [2.0, 5.0]]
    """
    low = np.concatenate([[0.0], held[:, 1]])
    high = np.concatenate([held[:, 0], [length_mm]])
    left = np.stack([np.clip(low, 0.0, length_mm), np.clip(high, 0.0, length_mm)], axis=1)
    return np.asarray(left[left[:, 1] - left[:, 0] > 1e-9])


def both(one: Floats, other: Floats) -> Floats:
    """What two sets share.

    Examples
    --------
    >>> both(np.array([[0.0, 3.0], [5.0, 9.0]]), np.array([[2.0, 6.0]])).tolist()
    [[2.0, 3.0], [5.0, 6.0]]
    """
    low = np.maximum(one[:, None, 0], other[None, :, 0]).ravel()
    high = np.minimum(one[:, None, 1], other[None, :, 1]).ravel()
    return union(np.stack([low, high], axis=1)[high > low])


def minus(one: Floats, other: Floats) -> Floats:
    """What one set has and the other has not."""
    if not len(one) or not len(other):
        return one
    return both(one, rest(other, float(max(one[-1, 1], other[-1, 1]))))


def total_mm(held: Floats) -> float:
    """How long a set is altogether."""
    return float((held[:, 1] - held[:, 0]).sum())


def closed_up(left: Floats, length_mm: float) -> list[tuple[float, float]]:
    """What is left of a closed ring, the stretch across its first point in one piece: its end is beyond the length.

    Examples
    --------
    >>> closed_up(np.array([[0.0, 1.0], [4.0, 5.0], [7.0, 8.0]]), 8.0)
    [(4.0, 5.0), (7.0, 9.0)]
    """
    rows = [(low, high) for low, high in left.tolist()]
    if len(rows) > 1 and rows[0][0] <= 1e-9 and rows[-1][1] >= length_mm - 1e-9:
        rows = [*rows[1:-1], (rows[-1][0], length_mm + rows[0][1])]
    return rows
