"""A linear program that grows by columns and rows, and is solved on from its last basis (Huangfu and Hall 2018).

HiGHS is scipy's own: `highspy` cannot be loaded beside ortools. Where a later scipy keeps it elsewhere, every solution
starts from nothing through `scipy.optimize.linprog`: as good, in about four times the time.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import csr_matrix, hstack, vstack

from kerfwise.arrays import Bools, Floats, Ints

try:
    from scipy.optimize._highspy import _core as highs
except ImportError:  # pragma: no cover - a later scipy
    highs = None

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


class RestrictedMaster(Protocol):
    """Minimises over columns between 0 and a most, under equations with given right sides, and then inequalities.

    `iterations` are those of the simplex method that the last call of `solve` took, `primal` whether they were of the
    primal one, and `goes_on` says whether the next call goes on from where that ended.
    """

    iterations: int
    primal: bool
    goes_on: bool

    def add_columns(self, cost: Floats, entries: csr_matrix, most: float = np.inf) -> None:
        """Add columns of at most `most`; `entries` is (rows, columns)."""

    def add_rows(self, entries: csr_matrix, least: Floats) -> None:
        """Add rows that are at least `least`; `entries` is (rows, columns)."""

    def drop_rows(self, rows: Ints) -> None:
        """Drop some of the rows that were added, counted from the first equation on; those after them move up."""

    def basic(self) -> tuple[Bools, Bools]:
        """Which columns and which rows are in the basis of the last solution: as many as there are rows."""

    def drop_columns(self, columns: Ints, emptied: Ints) -> None:
        """Drop some columns, none of them in use; those after them move up.

        `emptied` are equations that are left without a column, each in place of one of them in the basis.
        """

    def limit(self, columns: Ints, most: Floats) -> None:
        """Keep these columns at no more than so much each from now on."""

    def price(self, columns: Ints, cost: Floats) -> None:
        """What these columns cost from now on."""

    def solve(self, most: int, most_s: float = np.inf) -> MasterSolution | None:
        """The cheapest columns, None where no optimum is found in so many iterations, and seconds by the clock."""


def restricted_master(right: Floats) -> RestrictedMaster:
    """A program of no columns yet, with these right sides of its equations.

    Examples
    --------
    >>> program = restricted_master(np.array([4.0]))
    >>> program.add_columns(np.array([2.0, 3.0]), csr_matrix([[1.0, 1.0]]))
    >>> program.solve(100).value.tolist()
    [4.0, 0.0]
    >>> program.add_rows(csr_matrix([[0.0, 1.0]]), np.array([1.0]))
    >>> program.solve(100).multiplier.tolist()
    [2.0, 1.0]
    """
    return Anew(right) if highs is None else GoesOn(right)


class GoesOn:
    """Solved on from the last basis."""

    goes_on = True

    def __init__(self, right: Floats) -> None:
        self._highs = highs._Highs()
        self._lawful, self._value = False, np.zeros(0)
        self.iterations, self.primal = 0, False
        for option, value in {"output_flag": False, "solver": "simplex", "presolve": "off", "threads": 1}.items():
            self._highs.setOptionValue(option, value)
        self._add_rows(csr_matrix((len(right), 0)), right, right)

    def add_columns(self, cost: Floats, entries: csr_matrix, most: float = np.inf) -> None:
        by_column = entries.tocsc()
        none, all_of_it = np.zeros(len(cost)), np.full(len(cost), most)
        self._value = np.append(self._value, none)
        self._told(self._highs.addCols(len(cost), cost, none, all_of_it, *_sparse(by_column)))

    def add_rows(self, entries: csr_matrix, least: Floats) -> None:
        self._add_rows(entries.tocsr(), least, np.full(len(least), np.inf))

    def drop_rows(self, rows: Ints) -> None:
        if len(rows):
            self._told(self._highs.deleteRows(len(rows), rows.astype(np.int32)))

    def basic(self) -> tuple[Bools, Bools]:
        basis, status = self._highs.getBasis(), highs.HighsBasisStatus
        column = np.array([kind == status.kBasic for kind in basis.col_status], dtype=np.bool_)
        return column, np.array([kind == status.kBasic for kind in basis.row_status], dtype=np.bool_)

    def drop_columns(self, columns: Ints, emptied: Ints) -> None:
        if len(emptied):
            basis, status = self._highs.getBasis(), highs.HighsBasisStatus
            of_column, of_row = list(basis.col_status), list(basis.row_status)
            for column in columns.tolist():
                of_column[column] = status.kLower
            for row in emptied.tolist():
                of_row[row] = status.kBasic
            basis.col_status, basis.row_status = of_column, of_row
            self._told(self._highs.setBasis(basis))
        if len(columns):
            self._value = np.delete(self._value, columns)
            self._told(self._highs.deleteCols(len(columns), columns.astype(np.int32)))

    def limit(self, columns: Ints, most: Floats) -> None:
        if len(columns):
            self._lawful = self._lawful and bool((self._value[columns] <= most).all())
            chosen, none = columns.astype(np.int32), np.zeros(len(columns))
            self._told(self._highs.changeColsBounds(len(columns), chosen, none, most))

    def price(self, columns: Ints, cost: Floats) -> None:
        if len(columns):
            self._told(self._highs.changeColsCost(len(columns), columns.astype(np.int32), cost))

    def solve(self, most: int, most_s: float = np.inf) -> MasterSolution | None:
        self._highs.setOptionValue("time_limit", self._highs.getRunTime() + max(0.0, most_s))
        self._highs.setOptionValue("simplex_iteration_limit", min(most, MOST_ROUNDS))
        self.primal = self._lawful
        self._highs.setOptionValue("simplex_strategy", PRIMAL if self.primal else DUAL)
        self._highs.run()
        self.iterations = int(self._highs.getInfo().simplex_iteration_count)
        if self._highs.getModelStatus() != highs.HighsModelStatus.kOptimal:
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
        if status == highs.HighsStatus.kError:
            raise RuntimeError(f"HiGHS refuses a change of the linear program: {status}")


class Anew:
    """Solved from nothing each time."""

    goes_on = False

    def __init__(self, right: Floats) -> None:
        self._right, self.iterations, self.primal = right, 0, False
        self._cost: Floats = np.zeros(0)
        self._most: Floats = np.zeros(0)
        self._least: Floats = np.zeros(0)
        self._entries = csr_matrix((len(right), 0))

    def add_columns(self, cost: Floats, entries: csr_matrix, most: float = np.inf) -> None:
        self._cost = np.append(self._cost, cost)
        self._most = np.append(self._most, np.full(len(cost), most))
        self._entries = hstack([self._entries, entries], format="csr")

    def add_rows(self, entries: csr_matrix, least: Floats) -> None:
        self._least = np.append(self._least, least)
        self._entries = vstack([self._entries, entries], format="csr")

    def drop_rows(self, rows: Ints) -> None:
        kept = np.ones(self._entries.shape[0], dtype=np.bool_)
        kept[rows] = False
        self._entries, self._least = self._entries[kept], self._least[kept[len(self._right) :]]

    def basic(self) -> tuple[Bools, Bools]:
        return np.zeros(len(self._cost), dtype=np.bool_), np.ones(self._entries.shape[0], dtype=np.bool_)

    def drop_columns(self, columns: Ints, emptied: Ints) -> None:
        self._cost, self._most = np.delete(self._cost, columns), np.delete(self._most, columns)
        kept = np.ones(self._entries.shape[1], dtype=np.bool_)
        kept[columns] = False
        self._entries = self._entries[:, kept]

    def limit(self, columns: Ints, most: Floats) -> None:
        self._most[columns] = most

    def price(self, columns: Ints, cost: Floats) -> None:
        self._cost[columns] = cost

    def solve(self, most: int, most_s: float = np.inf) -> MasterSolution | None:
        equations, rows = self._entries[: len(self._right)], self._entries[len(self._right) :]
        many = rows.shape[0] > 0
        solved = linprog(
            self._cost,
            A_ub=-rows if many else None,
            b_ub=-self._least if many else None,
            A_eq=equations,
            b_eq=self._right,
            bounds=np.stack([np.zeros_like(self._most), self._most], axis=1),
            method="highs",
            options={"maxiter": most} | ({"time_limit": max(0.0, most_s)} if np.isfinite(most_s) else {}),
        )
        self.iterations = int(solved.nit)
        if solved.x is None or solved.status != 0:
            return None
        paid = -solved.ineqlin.marginals if many else self._least
        reduced = solved.lower.marginals + solved.upper.marginals
        return MasterSolution(solved.x, np.append(solved.eqlin.marginals, paid), reduced)


def _sparse(entries: csr_matrix) -> tuple[int, Ints, Ints, Floats]:
    """Entries by row (or by column) as HiGHS reads them: how many, where each row begins, and each one's place."""
    starts, places = entries.indptr[:-1].astype(np.int32), entries.indices.astype(np.int32)
    return entries.nnz, starts, places, entries.data.astype(np.float64)
