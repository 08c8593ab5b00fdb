"""Positions that are firm, among orders that may give way: which orders must be dropped so that all positions can hold.

The contours cut before a position are a set of that many contours. An order is broken where such a set holds the later
one of its two contours without the other. So the sets before all the positions are chosen together, as a small integer
program, each inside the next; what is cut in one go is torn by no more of them than can be.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import coo_array

from kerfwise.rules.by_kind import by_kind
from kerfwise.rules.statements import Before, Statement

from .cycles import Link

MOST_ROWS = 300_000
"""Where the program had more rows, nothing is dropped: the contradiction is told as any other."""


def positions(statements: Sequence[Statement], n: int) -> dict[int, int]:
    """Contour → its position among n, counted from 1, where hard statements leave it one only.

    Examples
    --------
    >>> from kerfwise.rules.statements import About, AtLeast
    >>> about = About("locks", ("B",), "B is cut 2 in order")
    >>> second = [AtLeast((Before(0, 1), Before(2, 1)), (1, 1), 1, about)]
    >>> positions([*second, AtLeast((Before(1, 0), Before(1, 2)), (1, 1), 1, about)], 3)
    {1: 2}
    """
    ahead: dict[int, int] = {}
    behind: dict[int, int] = {}
    for s in by_kind(statements).at_least:
        if s.weight is not None or s.when is not None or len(s.literals) != n - 1:
            continue
        if set(s.weights) != {1} or not all(isinstance(literal, Before) for literal in s.literals):
            continue
        pairs = [(literal.i, literal.j) for literal in s.literals if isinstance(literal, Before)]
        for found, inner, outer in ((ahead, 1, 0), (behind, 0, 1)):
            (contour, *others) = {pair[inner] for pair in pairs}
            if not others and len({pair[outer] for pair in pairs}) == n - 1:
                found[contour] = max(found.get(contour, 0), s.bound)
    return {k: ahead[k] + 1 for k in ahead if k in behind and ahead[k] + behind[k] == n - 1}


def in_the_way(
    n: int,
    links: Sequence[Link],
    weights: Sequence[int | None],
    runs: Sequence[Sequence[int]],
    at: Mapping[int, int],
) -> list[int]:
    """Numbers of the links (before, after) to drop so that the positions `at` can hold, of least total weight.

    A weight of None is kept. Nothing where no drop helps, or none is needed. The links have no cycle; `runs` are
    contours cut in one go.

    Examples
    --------
    >>> in_the_way(3, [(0, 2), (1, 2)], [2, 1], [], {2: 2})
    [1]
    """
    sizes = sorted({size for place in at.values() for size in (place - 1, place)} - {0, n})
    group = np.arange(n)
    for run in runs:
        group[list(run)] = min(run)
    several = sorted({int(group[run[0]]) for run in runs if len(run) > 1})
    if not sizes or len(sizes) * (len(links) + 2 * n) > MOST_ROWS:
        return []
    program = _Program(n, len(links), len(sizes), several)
    for k, size in enumerate(sizes):
        program.row([(program.inside(k, c), 1) for c in range(n)], size, size)
        for run in runs:
            for c in run if len(run) > 1 else ():
                low, high = program.run(k, int(group[c]))
                program.row([(program.inside(k, c), 1), (low, -1)], 0, np.inf)
                program.row([(high, 1), (program.inside(k, c), -1)], 0, np.inf)
        torn = [(column, sign) for g in several for column, sign in zip(program.run(k, g), (-1, 1), strict=True)]
        if torn:
            program.row(torn, -np.inf, 1)
        for number, (a, b) in enumerate(links):
            apart = group[a] != group[b]
            early = program.run(k, int(group[a]))[0] if apart and group[a] in several else program.inside(k, a)
            late = program.run(k, int(group[b]))[1] if apart and group[b] in several else program.inside(k, b)
            row = [(early, 1), (late, -1)] + [(number, 1)] * (weights[number] is not None)
            program.row(row, 0, np.inf)
    for k in range(len(sizes) - 1):
        for c in range(n):
            program.row([(program.inside(k + 1, c), 1), (program.inside(k, c), -1)], 0, np.inf)
    for contour, place in at.items():
        if place - 1 in sizes:
            program.fixed[program.inside(sizes.index(place - 1), contour)] = 0
        if place in sizes:
            program.fixed[program.inside(sizes.index(place), contour)] = 1
        if place - 1 in sizes and place in sizes:
            for g in several:
                if g != group[contour]:  # nothing comes between contours that are cut in one go
                    (low, high), (low_, high_) = (program.run(sizes.index(s), g) for s in (place - 1, place))
                    program.row([(high, 1), (low, -1), (high_, 1), (low_, -1)], -np.inf, 1)
    return program.least([w or 0 for w in weights])


class _Program:
    """Columns: a link is dropped; a contour is inside a set; of a run all, and any, are inside a set. All 0 or 1."""

    def __init__(self, n: int, links: int, sets: int, several: Sequence[int]) -> None:
        self.n, self.links, self.of_run = n, links, {g: links + sets * n + 2 * sets * k for k, g in enumerate(several)}
        self.columns = links + sets * n + 2 * sets * len(several)
        self.cells: list[tuple[int, int, int]] = []
        self.low: list[float] = []
        self.high: list[float] = []
        self.fixed: dict[int, int] = {}

    def inside(self, k: int, contour: int) -> int:
        return self.links + k * self.n + contour

    def run(self, k: int, group: int) -> tuple[int, int]:
        return self.of_run[group] + 2 * k, self.of_run[group] + 2 * k + 1

    def row(self, cells: Sequence[tuple[int, int]], low: float, high: float) -> None:
        self.cells += [(len(self.low), column, sign) for column, sign in cells]
        self.low.append(low)
        self.high.append(high)

    def least(self, weights: Sequence[int]) -> list[int]:
        """The links dropped at the least weight; none where nothing helps."""
        rows, columns, signs = np.array(self.cells).T
        matrix = coo_array((signs.astype(np.float64), (rows, columns)), shape=(len(self.low), self.columns))
        low, high = np.zeros(self.columns), np.ones(self.columns)
        for column, value in self.fixed.items():
            low[column] = high[column] = value
        costs = np.zeros(self.columns)
        costs[: self.links] = weights
        found = milp(
            costs,
            integrality=np.ones(self.columns),
            bounds=Bounds(low, high),
            constraints=LinearConstraint(matrix.tocsr(), self.low, self.high),
        )
        return [] if found.x is None else np.flatnonzero(found.x[: self.links] > 0.5).tolist()
