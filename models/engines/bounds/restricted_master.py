"""A linear program that grows by columns and rows, solved by HiGHS as scipy has it (Huangfu and Hall 2018)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import csr_matrix, hstack, vstack

from kerfwise.arrays import Floats, Ints


@dataclass(frozen=True, eq=False, slots=True)
class Solved:
    """A solution: the value of every column, the multiplier of every row, and the simplex iterations it took."""

    value: Floats
    multiplier: Floats
    iterations: int


class RestrictedMaster:
    """Minimises over columns of at least 0, under equations with these right sides, and then inequalities.

    Examples
    --------
    >>> import numpy as np
    >>> from scipy.sparse import csr_matrix
    >>> program = RestrictedMaster(np.array([4.0]))
    >>> program.add_columns(np.array([2.0, 3.0]), csr_matrix([[1.0, 1.0]]))
    >>> program.solve(100).value.tolist()
    [4.0, 0.0]
    >>> program.add_rows(csr_matrix([[0.0, 1.0]]), np.array([1.0]))
    >>> program.solve(100).multiplier.tolist()
    [2.0, 1.0]
    """

    def __init__(self, right: Floats) -> None:
        self._right = right
        self._cost: Floats = np.zeros(0)
        self._least: Floats = np.zeros(0)
        self._entries = csr_matrix((len(right), 0))

    def add_columns(self, cost: Floats, entries: csr_matrix) -> None:
        """Add columns; `entries` is (rows, columns)."""
        self._cost = np.append(self._cost, cost)
        self._entries = hstack([self._entries, entries], format="csr")

    def add_rows(self, entries: csr_matrix, least: Floats) -> None:
        """Add rows that are at least `least`; `entries` is (rows, columns)."""
        self._least = np.append(self._least, least)
        self._entries = vstack([self._entries, entries], format="csr")

    def drop_rows(self, rows: Ints) -> None:
        """Drop some of the rows that were added, counted from the first equation on; those after them move up."""
        kept = np.ones(self._entries.shape[0], dtype=np.bool_)
        kept[rows] = False
        self._entries, self._least = self._entries[kept], self._least[kept[len(self._right) :]]

    def solve(self, most: int) -> Solved | None:
        """The cheapest columns, None where no optimum is found in so many iterations."""
        equations, rows = self._entries[: len(self._right)], self._entries[len(self._right) :]
        many = rows.shape[0] > 0
        solved = linprog(
            self._cost,
            A_ub=-rows if many else None,
            b_ub=-self._least if many else None,
            A_eq=equations,
            b_eq=self._right,
            method="highs",
            options={"maxiter": most},
        )
        if solved.x is None or solved.status != 0:
            return None
        paid = -solved.ineqlin.marginals if many else self._least
        return Solved(solved.x, np.append(solved.eqlin.marginals, paid), int(solved.nit))
