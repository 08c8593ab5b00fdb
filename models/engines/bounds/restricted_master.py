"""A linear program that grows by columns and rows, and is solved on from its last basis (Huangfu and Hall 2018)."""

from __future__ import annotations

from dataclasses import dataclass

import highspy
import numpy as np
from scipy.sparse import csr_matrix

from kerfwise.arrays import Floats, Ints

DUAL, PRIMAL = 1, 4
"""Ways of the simplex method, as HiGHS numbers them. Where nothing but columns came, the last solution is still lawful,
and the primal one goes on from it in a third of the time."""
MOST_ROUNDS = 2**31 - 1
"""The highest limit of rounds that HiGHS takes."""


@dataclass(frozen=True, eq=False, slots=True)
class MasterSolution:
    """A solution: the value of every column, the multiplier of every row, and what these leave of columns' costs."""

    value: Floats
    multiplier: Floats
    reduced: Floats


class _Quiet(highspy.Highs):
    """HiGHS without callbacks: to set any prints its name, and keeps the program in memory for longer."""

    def __init__(self) -> None:
        super().__init__()  # type: ignore[no-untyped-call]

    def enableCallbacks(self) -> None:
        self.callbacks.clear()


class RestrictedMaster:
    """Minimises over columns between 0 and a most, under equations with these right sides, and then inequalities.

    `iterations` are those of the simplex method that the last call of `solve` took, `primal` whether they were of the
    primal one.

    Examples
    --------
    >>> program = RestrictedMaster(np.array([4.0]))
    >>> program.add_columns(np.array([2.0, 3.0]), csr_matrix([[1.0, 1.0]]))
    >>> program.solve(100).value.tolist()
    [4.0, 0.0]
    >>> program.add_rows(csr_matrix([[0.0, 1.0]]), np.array([1.0]))
    >>> program.solve(100).multiplier.tolist()
    [2.0, 1.0]
    """

    def __init__(self, right: Floats) -> None:
        self._highs = _Quiet()
        self._lawful, self._value = False, np.zeros(0)
        self.iterations, self.primal = 0, False
        options: dict[str, bool | int | str] = {"output_flag": False, "solver": "simplex", "presolve": "off"}
        for option, value in (options | {"threads": 1}).items():
            self._highs.setOptionValue(option, value)
        self._add_rows(csr_matrix((len(right), 0)), right, right)

    def add_columns(self, cost: Floats, entries: csr_matrix, most: float = np.inf) -> None:
        """Add columns of at most `most`; `entries` is (rows, columns)."""
        by_column = entries.tocsc()
        none, all_of_it = np.zeros(len(cost)), np.full(len(cost), most)
        self._value = np.append(self._value, none)
        self._told(self._highs.addCols(len(cost), cost, none, all_of_it, *_sparse(by_column)))

    def add_rows(self, entries: csr_matrix, least: Floats) -> None:
        """Add rows that are at least `least`; `entries` is (rows, columns)."""
        self._add_rows(entries.tocsr(), least, np.full(len(least), np.inf))

    def drop_rows(self, rows: Ints) -> None:
        """Drop some of the rows that were added, counted from the first equation on; those after them move up."""
        if len(rows):
            self._told(self._highs.deleteRows(len(rows), rows.astype(np.int32)))

    def drop_columns(self, columns: Ints) -> None:
        """Drop some columns, none of them in use; those after them move up."""
        if len(columns):
            self._value = np.delete(self._value, columns)
            self._told(self._highs.deleteCols(len(columns), columns.astype(np.int32)))

    def limit(self, columns: Ints, most: Floats) -> None:
        """Keep these columns at no more than so much each from now on."""
        if len(columns):
            self._lawful = self._lawful and bool((self._value[columns] <= most).all())
            chosen, none = columns.astype(np.int32), np.zeros(len(columns))
            self._told(self._highs.changeColsBounds(len(columns), chosen, none, most))

    def price(self, columns: Ints, cost: Floats) -> None:
        """What these columns cost from now on."""
        if len(columns):
            self._told(self._highs.changeColsCost(len(columns), columns.astype(np.int32), cost))

    def solve(self, most: int, most_s: float = np.inf) -> MasterSolution | None:
        """The cheapest columns, None where no optimum is found in so many iterations, and seconds by the clock."""
        self._highs.setOptionValue("time_limit", self._highs.getRunTime() + max(0.0, most_s))
        self._highs.setOptionValue("simplex_iteration_limit", min(most, MOST_ROUNDS))
        self.primal = self._lawful
        self._highs.setOptionValue("simplex_strategy", PRIMAL if self.primal else DUAL)
        self._highs.run()
        self.iterations = int(self._highs.getInfo().simplex_iteration_count)
        if self._highs.getModelStatus() != highspy.HighsModelStatus.kOptimal:
            return None
        self._lawful = True
        found = self._highs.getSolution()
        self._value = np.array(found.col_value)
        return MasterSolution(self._value, np.array(found.row_dual), np.array(found.col_dual))

    def _add_rows(self, entries: csr_matrix, least: Floats, most: Floats) -> None:
        if len(least):
            self._lawful = False
            self._told(self._highs.addRows(len(least), least, most, *_sparse(entries)))

    def _told(self, status: object) -> None:
        """Nothing may be left out of the program in silence: a bound would still hold, but less than it could."""
        if status == highspy.HighsStatus.kError:
            raise RuntimeError(f"HiGHS refuses a change of the linear program: {status}")


def _sparse(entries: csr_matrix) -> tuple[int, Ints, Ints, Floats]:
    """Entries by row (or by column) as HiGHS reads them: how many, where each row begins, and each one's place."""
    starts, places = entries.indptr[:-1].astype(np.int32), entries.indices.astype(np.int32)
    return entries.nnz, starts, places, entries.data.astype(np.float64)
