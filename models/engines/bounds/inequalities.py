"""Inequalities: what every plan's moves come to at least, and a cheapest flow comes to too little of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix, vstack

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.models.problem.problem import Problem

from .demands import Cover, Order


@dataclass(frozen=True, eq=False, slots=True)
class Inequalities:
    """For each row: moves from a site of `tail` to one of `head`, less moves to a site of `into`, plus `beside`.

    It comes to `least` at least in every plan. `tail`, `head` and `into` are (k, m + 1), home last, `least` (k,);
    `beside` (k, columns) is what the columns beside the moves count.
    """

    tail: Bools
    head: Bools
    into: Bools
    least: Floats
    beside: csr_matrix

    def __len__(self) -> int:
        return len(self.tail)

    def only(self, kept: Bools) -> Inequalities:
        """Those of them that are kept."""
        return Inequalities(self.tail[kept], self.head[kept], self.into[kept], self.least[kept], self.beside[kept])

    def joined(self, more: Inequalities) -> Inequalities:
        """With more of them."""
        return Inequalities(
            np.concatenate([self.tail, more.tail]),
            np.concatenate([self.head, more.head]),
            np.concatenate([self.into, more.into]),
            np.concatenate([self.least, more.least]),
            vstack([self.beside, more.beside], format="csr"),
        )

    def across(self, leave: Ints, reach: Ints) -> csr_matrix:
        """How much each of some moves counts in every inequality, (k, moves)."""
        starts = np.zeros(len(self) + 1, dtype=np.int64)
        places, values = [np.zeros(0, dtype=np.int64)], [np.zeros(0)]
        for k, (tail, head, into) in enumerate(zip(self.tail, self.head, self.into, strict=True)):
            counts = (tail[leave] & head[reach]).view(np.int8)
            if into.any():
                counts = counts - into[reach]
            places.append(np.flatnonzero(counts))
            values.append(counts[places[-1]].astype(np.float64))
            starts[k + 1] = starts[k] + len(places[-1])
        return csr_matrix((np.concatenate(values), np.concatenate(places), starts), shape=(len(self), len(leave)))

    def worth(self, paid: Floats) -> Floats:
        """What multipliers (k,) make every move worth, (m + 1, m + 1)."""
        worth = (self.tail.T * paid) @ self.head.astype(np.float64)
        return np.asarray(worth - (paid @ self.into)[None, :])


@dataclass(frozen=True, eq=False, slots=True)
class OrderCut:
    """Something goes from `tail` to `head`, each (m + 1,): once at least, or as often as the sites `through`, of one
    contour, are used, or where `order` holds."""

    tail: Bools
    head: Bools
    through: Bools | None = None
    order: Order | None = None


def of_cuts(cuts: Sequence[OrderCut], sites: int, columns: int) -> Inequalities:
    """Cuts as inequalities, over so many sites and home, and columns beside the moves."""
    tail, head = (np.array([getattr(cut, name) for cut in cuts], dtype=np.bool_) for name in ("tail", "head"))
    into = np.zeros((len(cuts), sites + 1), dtype=np.bool_)
    least = np.ones(len(cuts))
    entries = []
    for k, cut in enumerate(cuts):
        if cut.through is not None:
            into[k], least[k] = cut.through, 0.0
        elif cut.order is not None:
            least[k], times = cut.order.weights
            entries.append((k, cut.order.column, -times))
    beside = _beside(entries, len(cuts), columns)
    return Inequalities(tail.reshape(-1, sites + 1), head.reshape(-1, sites + 1), into, least, beside)


def of_covers(covers: Sequence[Cover], sites: int, columns: int) -> Inequalities:
    """Covers as inequalities."""
    none = np.zeros((len(covers), sites + 1), dtype=np.bool_)
    into = none.copy()
    least = np.zeros(len(covers))
    entries = []
    for k, cover in enumerate(covers):
        into[k, cover.sites] = True
        for order in cover.orders:  # how much of it does not hold
            constant, times = order.weights
            entries.append((k, order.column, -times))
            least[k] -= 1.0 - constant
        if cover.paid >= 0:
            entries.append((k, cover.paid, 1.0))
    return Inequalities(none, none, into, least, _beside(entries, len(covers), columns))


def _beside(entries: Sequence[tuple[int, int, float]], rows: int, columns: int) -> csr_matrix:
    row, column, value = (np.array([entry[k] for entry in entries]) for k in range(3))
    return csr_matrix((value.astype(np.float64), (row.astype(int), column.astype(int))), shape=(rows, columns))


def block_inequalities(problem: Problem, columns: int = 0) -> Inequalities:
    """The contours of a contiguous block follow each other: one move less than there are leads from one to another."""
    names, size = np.unique(problem.block, return_counts=True)
    owner = np.append(problem.site_contour, problem.n)
    inside = np.append(problem.block, -1)[owner][None, :] == names[size > 1][:, None]
    least = (size[size > 1] - 1).astype(np.float64)
    none = np.zeros_like(inside)
    return Inequalities(inside, inside, none, least, csr_matrix((len(least), columns)))
