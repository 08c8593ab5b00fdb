"""Inequalities: what every plan's moves come to at least, and a cheapest flow comes to too little of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.models.problem.problem import Problem


@dataclass(frozen=True, eq=False, slots=True)
class Inequalities:
    """For each row: moves from a site of `tail` to one of `head`, less moves to a site of `into`.

    It comes to `least` at least in every plan. `tail`, `head` and `into` are (k, m + 1), home last, `least` (k,).
    """

    tail: Bools
    head: Bools
    into: Bools
    least: Floats

    def __len__(self) -> int:
        return len(self.tail)

    def only(self, kept: Bools) -> Inequalities:
        """Those of them that are kept."""
        return Inequalities(self.tail[kept], self.head[kept], self.into[kept], self.least[kept])

    def joined(self, more: Inequalities) -> Inequalities:
        """With more of them."""
        return Inequalities(
            np.concatenate([self.tail, more.tail]),
            np.concatenate([self.head, more.head]),
            np.concatenate([self.into, more.into]),
            np.concatenate([self.least, more.least]),
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


@dataclass(frozen=True, eq=False, slots=True)
class OrderCut:
    """Something goes from `tail` to `head`, each (m + 1,): once at least, or as often as the sites `through`, of one
    contour, are used."""

    tail: Bools
    head: Bools
    through: Bools | None = None


def cut_inequalities(cuts: Sequence[OrderCut], sites: int) -> Inequalities:
    """Cuts as inequalities, over so many sites and home."""
    tail, head = (np.array([getattr(cut, name) for cut in cuts], dtype=np.bool_) for name in ("tail", "head"))
    into = np.zeros((len(cuts), sites + 1), dtype=np.bool_)
    for k, cut in enumerate(cuts):
        if cut.through is not None:
            into[k] = cut.through
    least = np.where(into.any(axis=1), 0.0, 1.0)
    return Inequalities(tail.reshape(-1, sites + 1), head.reshape(-1, sites + 1), into, least)


def block_inequalities(problem: Problem) -> Inequalities:
    """The contours of a contiguous block follow each other: one move less than there are leads from one to another."""
    names, size = np.unique(problem.block, return_counts=True)
    owner = np.append(problem.site_contour, problem.n)
    inside = np.append(problem.block, -1)[owner][None, :] == names[size > 1][:, None]
    least = (size[size > 1] - 1).astype(np.float64)
    return Inequalities(inside, inside, np.zeros_like(inside), least)
