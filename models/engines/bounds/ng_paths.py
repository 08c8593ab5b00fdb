"""What a walk remembers: at every contour, which of a few others near it come later.

A walk that must keep clear of the contours it remembers takes short cycles no more (ng-routes: Baldacci, Mingozzi and
Roberti 2011). It remembers a contour as long as all contours on its way have it among their neighbours.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kerfwise.arrays import Floats, Int16s, Ints
from kerfwise.models.problem.problem import Problem


@dataclass(frozen=True, eq=False, slots=True)
class NgSets:
    """`near[a, j]` is neighbour j of contour a, -1 for none; a memory at a is a set of bits j.

    A walk at contour a that goes on to b, where it remembers M, remembers `carried[a, b, M]` at a; -1 where it may
    not: a is in M, or something that must come before a is.
    """

    near: Ints
    carried: Int16s

    @property
    def size(self) -> int:
        """Number of memories at a contour."""
        return int(self.carried.shape[2])


def ng_sets(problem: Problem, move: Floats, most: int) -> NgSets:
    """The `most` nearest neighbours of every contour among those that may be cut at about the same time."""
    n = problem.n
    near = _nearest(problem, move, min(most, n - 1))
    memories = np.arange(1 << near.shape[1])
    bit = np.full((n, n + 1), -1, dtype=np.int64)  # which neighbour of the row the column is
    rows, columns = np.nonzero(near >= 0)
    bit[rows, near[rows, columns]] = columns
    own = np.where(bit[:, :n] >= 0, 1 << np.maximum(bit[:, :n], 0), 0)
    carried = np.repeat(own[:, :, None], len(memories), axis=2)
    never = problem.before.T | np.eye(n, dtype=np.bool_)  # never[a, c]: c may not come after a
    for j in range(near.shape[1]):
        has = (memories >> j & 1).astype(np.bool_)
        there = near[:, j] >= 0
        contour = np.where(there, near[:, j], 0)
        kept = np.where(there[None, :], own[:, contour], 0)  # (a, b): what neighbour j of b is at a
        broken = never[:, contour] & there[None, :]
        carried |= np.where(has, kept[:, :, None], 0)
        carried[broken[:, :, None] & has] = -1
    return NgSets(near, carried.astype(np.int16))


def _nearest(problem: Problem, move: Floats, most: int) -> Ints:
    n, m = problem.n, problem.m
    first = problem.first[:-1]
    apart = np.minimum.reduceat(np.minimum.reduceat(move[:m, :m], first, axis=0), first, axis=1)
    apart = np.minimum(apart, apart.T)
    np.fill_diagonal(apart, np.inf)
    order = np.argsort(apart, axis=1, kind="stable")[:, :most]
    near: Ints = np.where(np.isfinite(np.take_along_axis(apart, order, axis=1)), order, -1).reshape(n, most)
    return near
