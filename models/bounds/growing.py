"""A linear program that grows and is solved on from its last basis, by HiGHS (Huangfu and Hall 2018)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import highspy
import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]


_solver: Any = highspy  # its calls have no types


@dataclass(frozen=True, eq=False, slots=True)
class Solved:
    """A solution: the value of every column, the multiplier of every row, and the simplex iterations it took."""

    value: Floats
    multiplier: Floats
    iterations: int


class Growing:
    """Minimises over columns of at least 0, under rows whose values lie between limits: at first these, (rows,) each.

    Examples
    --------
    >>> import numpy as np
    >>> from scipy.sparse import csr_matrix
    >>> program = Growing(np.array([4.0]), np.array([4.0]))
    >>> program.add_columns(np.array([2.0, 3.0]), csr_matrix([[1.0, 1.0]]))
    >>> program.solve().value.tolist()
    [4.0, 0.0]
    >>> program.add_rows(csr_matrix([[0.0, 1.0]]), np.array([1.0]))
    >>> program.solve().multiplier.tolist()
    [2.0, 1.0]
    """

    def __init__(self, least: Floats, most: Floats) -> None:
        self._highs = _solver.Highs()
        for option, value in (("output_flag", False), ("threads", 1), ("presolve", "off"), ("solver", "simplex")):
            self._highs.setOptionValue(option, value)
        none = np.zeros(0, dtype=np.int32)
        self._highs.addRows(len(least), least, most, 0, np.zeros(len(least), dtype=np.int32), none, np.zeros(0))

    def add_columns(self, cost: Floats, entries: csr_matrix) -> None:
        """Add columns; `entries` is (rows, columns)."""
        by_column, count = entries.tocsc(), len(cost)
        self._highs.addCols(
            count, cost, np.zeros(count), np.full(count, np.inf), by_column.nnz,
            by_column.indptr[:-1].astype(np.int32), by_column.indices.astype(np.int32), by_column.data,
        )  # fmt: skip

    def add_rows(self, entries: csr_matrix, least: Floats) -> None:
        """Add rows that are at least `least`; `entries` is (rows, columns)."""
        count = len(least)
        self._highs.addRows(
            count, least, np.full(count, np.inf), entries.nnz,
            entries.indptr[:-1].astype(np.int32), entries.indices.astype(np.int32), entries.data.astype(np.float64),
        )  # fmt: skip

    def drop_rows(self, rows: Ints) -> None:
        """Drop rows; those after them move up."""
        self._highs.deleteRows(len(rows), rows.astype(np.int32))

    def solve(self) -> Solved | None:
        """The cheapest columns, None where no optimum is found."""
        self._highs.run()
        if self._highs.getModelStatus() != _solver.HighsModelStatus.kOptimal:
            return None
        solution = self._highs.getSolution()
        iterations = int(self._highs.getInfo().simplex_iteration_count)
        return Solved(np.array(solution.col_value), np.array(solution.row_dual), iterations)
