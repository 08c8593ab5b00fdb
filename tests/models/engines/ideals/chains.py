"""Orders of few ideals for any number of contours."""

from __future__ import annotations

from kerfwise.models.problem.problem import Problem
from kerfwise.tests.models.problems import problem, scattered


def chains(count: int, length: int) -> Problem:
    """`count` chains of contours one before the next, with nothing ordered between chains."""
    bare = scattered(7, count * length, 2)
    where = [
        [(x / 1000, y / 1000) for x, y in bare.pierce_um[list(bare.sites(i))].tolist()] for i in range(count * length)
    ]
    return problem(where, pairs=[(i, i + count) for i in range(count * (length - 1))])
