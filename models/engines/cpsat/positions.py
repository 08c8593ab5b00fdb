"""Where in the order a contour can stand, by what must come before and after it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Ints
from kerfwise.models.problem.problem import Problem


def windows(problem: Problem) -> tuple[Ints, Ints]:
    """The first and the last position (from 0) of every contour."""
    return problem.before.sum(axis=0), problem.n - 1 - problem.before.sum(axis=1)


def windows_of_steps(problem: Problem) -> tuple[Ints, Ints]:
    """Matrices (n, n): the first position of i, and the last of j, if j directly follows i.

    Before i comes what must precede i or j, and the whole block of i if the route leaves it; after j likewise.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> zero_before_two = np.array([[0, 0, 1], [0, 0, 0], [0, 0, 0]], dtype=bool)
    >>> first, last = windows_of_steps(SimpleNamespace(n=3, before=zero_before_two, block=np.arange(3)))
    >>> int(first[1, 2]), int(last[0, 1])
    (1, 1)
    """
    n, before = problem.n, problem.before
    together = problem.block[:, None] == problem.block[None, :]
    itself = np.eye(n, dtype=np.bool_)
    within = (_united(before.T | itself, before.T), _united(before, before | itself))
    across = (_united(before.T | together, before.T), _united(before, before | together))
    ahead, behind = (np.where(together, one, other) for one, other in zip(within, across, strict=True))
    return ahead - 1, n - behind


def distances(problem: Problem) -> Ints:
    """Matrix (n, n): by how much the position of j exceeds that of i at least, where i must come before j; else 0."""
    steps = problem.before.astype(np.float32)  # whole numbers well below 2^24: exact, and fast to multiply
    return np.where(problem.before, (steps @ steps).astype(np.int64) + 1, 0)


def _united(one: NDArray[np.bool_], other: NDArray[np.bool_]) -> Ints:
    """How many there are in row i of the one or in row j of the other."""
    common = (one.astype(np.float32) @ other.T.astype(np.float32)).astype(np.int64)
    return np.asarray(one.sum(axis=1)[:, None] + other.sum(axis=1)[None, :] - common, dtype=np.int64)
