"""Two routes become a smaller problem: what follows each other in both is one contour of it.

A good route shares most of its arcs with another one. Where they differ is what is left to find out, and a search of
that alone goes on faster and moves whole stretches at once (Cook and Seymour 2003 merge tours of salesmen so).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.models.problem.closure import transitive
from kerfwise.models.problem.links import Links
from kerfwise.models.problem.problem import Problem

from .legs import MATRIX_SITES


@dataclass(frozen=True, eq=False, slots=True)
class Merged:
    """`problem` has a contour for each stretch of sites that is kept; one contour alone keeps all its sites.

    `head[s]` is the site that site s of the smaller problem stands for, the first of its stretch if it has one, by
    which `stretches` are found. `route` is the one that all were cut from, in sites of the smaller problem. What
    stretches cost in themselves is left out of the smaller problem.
    """

    problem: Problem
    stretches: dict[int, Ints]
    head: Ints
    route: Ints

    def whole(self, route: Ints) -> Ints:
        """A route through the smaller problem as one through the problem it was made from."""
        return np.concatenate([self.stretches.get(int(s), s[None]) for s in self.head[route]])


def mergeable(problem: Problem) -> bool:
    """Whether nothing but orders says which contour may stand where, and a table of travel fits into memory."""
    return (
        problem.n > 1
        and (problem.matrix is not None or problem.m <= MATRIX_SITES)
        and len(np.unique(problem.block)) == problem.n
        and not (problem.conditions or problem.soft_groups or problem.lags or problem.general)
        and not len(problem.crossings)
    )


def merge(problem: Problem, route: Ints, other: Ints) -> Merged:
    """The smaller problem in which all arcs that two lawful routes share, from site to site, are taken for granted."""
    following = np.full(problem.m, -1, dtype=np.int64)
    following[other[:-1]] = other[1:]
    begins = np.flatnonzero(np.append(True, following[route[:-1]] != route[1:]))
    pieces = np.split(route, begins[1:])
    single = [len(piece) == 1 for piece in pieces]
    contours = problem.site_contour[[int(piece[0]) for piece in pieces]]
    rows = [
        np.arange(problem.first[c], problem.first[c + 1]) if alone else piece[:1]
        for piece, c, alone in zip(pieces, contours, single, strict=True)
    ]
    heads = np.concatenate(rows)
    last = {int(piece[0]): int(piece[-1]) for piece in pieces}
    tails = np.array([s if alone else last[int(s)] for row, alone in zip(rows, single, strict=True) for s in row])
    first = np.concatenate([[0], np.cumsum([len(row) for row in rows])]).astype(np.int64)
    stretches = {int(piece[0]): piece for piece in pieces if len(piece) > 1}
    taken = {int(s): k for k, s in enumerate(heads)}
    smaller = _smaller(problem, pieces, first, heads, tails)
    return Merged(smaller, stretches, heads, np.array([taken[int(piece[0])] for piece in pieces], dtype=np.int64))


def _smaller(problem: Problem, pieces: list[Ints], first: Ints, heads: Ints, tails: Ints) -> Problem:
    """The problem of stretches that begin at `heads` and end at `tails`; those of stretch k are from `first[k]` on."""
    n, m = len(pieces), len(heads)
    piece_of = np.empty(problem.n, dtype=np.int64)
    for k, piece in enumerate(pieces):
        piece_of[problem.site_contour[piece]] = k
    sooner, later = (piece_of[side] for side in np.nonzero(problem.before))
    direct = np.zeros((n, n), dtype=np.bool_)
    direct[sooner, later] = sooner != later
    site_piece = np.repeat(np.arange(n, dtype=np.int64), np.diff(first))
    many = np.array([len(piece) > 1 for piece in pieces])[site_piece]
    nowhere = np.zeros((m, 2), dtype=np.int64)
    return replace(
        problem,
        n=n,
        first=first,
        site_contour=site_piece,
        site_candidate=np.arange(m, dtype=np.int64),
        candidate_site=np.arange(m, dtype=np.int64),
        pierce_um=nowhere,
        end_um=nowhere,
        site_cost=np.where(many, 0, problem.site_cost[heads]),
        before=transitive(direct),
        block=np.arange(n, dtype=np.int64),
        ids=tuple(problem.ids[problem.site_contour[piece[0]]] for piece in pieces),
        matrix=problem.travel(np.append(tails, problem.m), np.append(heads, problem.m)),
        links=Links(),
    )
