"""Inequalities: moves of which every plan makes so many at least, and which a cheapest flow makes too few of."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.models.problem.problem import Problem

ANY = -1
"""Stands for a site where a cut holds for every plan."""


@dataclass(frozen=True, eq=False, slots=True)
class Inequalities:
    """Every plan goes at least `least[k]` times from a site of `tail[k]` to one of `head[k]`, if it uses `through[k]`.

    `tail` and `head` are (k, m + 1), home last, `least` and `through` (k,); `through` is a site or `ANY`. An inequality
    of some plans asks for one move only.
    """

    tail: Bools
    head: Bools
    least: Floats
    through: Ints

    def __len__(self) -> int:
        return len(self.tail)

    def only(self, kept: Bools) -> Inequalities:
        """Those of them that are kept."""
        return Inequalities(self.tail[kept], self.head[kept], self.least[kept], self.through[kept])

    def joined(self, more: Inequalities) -> Inequalities:
        """With more of them."""
        return Inequalities(
            np.concatenate([self.tail, more.tail]),
            np.concatenate([self.head, more.head]),
            np.concatenate([self.least, more.least]),
            np.concatenate([self.through, more.through]),
        )

    @property
    def sure(self) -> Floats:
        """What the moves across, less those into `through`, come to at least in every plan, (k,)."""
        return np.where(self.through == ANY, self.least, 0.0)

    def across(self, leave: Ints, reach: Ints) -> csr_matrix:
        """How much each of some moves counts in every inequality, (k, moves)."""
        into = self.through[:, None] == reach[None, :]
        over = self.tail[:, leave] & self.head[:, reach]
        return csr_matrix(over.astype(np.float64) - into)

    def worth(self, paid: Floats) -> Floats:
        """What multipliers (k,) make every move worth, (m + 1, m + 1)."""
        worth = (self.tail.T * paid) @ self.head.astype(np.float64)
        through = self.through != ANY
        return np.asarray(worth - np.bincount(self.through[through], paid[through], worth.shape[1])[None, :])


def block_inequalities(problem: Problem) -> Inequalities:
    """The contours of a contiguous block follow each other: one move less than there are leads from one to another."""
    names, size = np.unique(problem.block, return_counts=True)
    owner = np.append(problem.site_contour, problem.n)
    inside = np.append(problem.block, ANY)[owner][None, :] == names[size > 1][:, None]
    least = (size[size > 1] - 1).astype(np.float64)
    return Inequalities(inside, inside, least, np.full(len(least), ANY))
