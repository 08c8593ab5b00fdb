"""Makes the smaller problem of a region: with all rules, at the same price but for what no order of it changes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kerfwise.arrays import Bools, Ints
from kerfwise.models.engines.search.tables import SearchTables
from kerfwise.models.problem.closure import transitive
from kerfwise.models.problem.links import Links
from kerfwise.models.problem.pace import Pace
from kerfwise.models.problem.problem import Problem

from .asked import AskedOf
from .crossed import CrossedBy
from .lags import LaggedBy
from .pieces import Pieces
from .region import Region


class Contractor:
    """Makes regions of one problem.

    Parameters
    ----------
    problem
        One that is `regional`.
    fields
        The same for kernels.
    """

    def __init__(self, problem: Problem, fields: SearchTables) -> None:
        self._problem = problem
        orders = fields.orders
        self._sooner, self._later = orders.covers, np.repeat(np.arange(problem.n), np.diff(orders.covers_first))
        self._asked = AskedOf(fields.demands)
        self._crossed = CrossedBy(problem)
        self._lagged = LaggedBy(problem)

    def region(self, route: Ints, free: Bools, starts: bool = False, ends: bool = False) -> Region:
        """The region of the contours that are `free` (n,), whole blocks, on a lawful route.

        `starts` keeps the first piece first, `ends` the last one last.
        """
        problem = self._problem
        pieces = Pieces.of(problem, route, free)
        before = self._orders(pieces, starts, ends)
        matrix = problem.travel(np.append(pieces.tails, problem.m), np.append(pieces.heads, problem.m))
        self._lagged.add_to(matrix, pieces)
        site_cost = np.where(pieces.alone[pieces.site_piece], problem.site_cost[pieces.heads], 0)
        conditions = self._asked.of(pieces, before, site_cost)
        conditions += self._crossed.within(pieces, before)
        count, sites = len(pieces.first) - 1, len(pieces.heads)
        nowhere = np.zeros((sites, 2), dtype=np.int64)
        smaller = replace(
            problem,
            n=count,
            first=pieces.first,
            site_contour=pieces.site_piece,
            site_candidate=np.arange(sites, dtype=np.int64),
            candidate_site=np.arange(sites, dtype=np.int64),
            pierce_um=nowhere,
            end_um=nowhere,
            site_cost=site_cost,
            before=before,
            block=np.where(pieces.free, problem.block[pieces.leader], problem.n + np.arange(count)),
            conditions=tuple(conditions),
            lags=(),
            ids=tuple(problem.ids[c] for c in pieces.leader.tolist()),
            crossings=self._crossed.between(pieces),
            pace=Pace(),
            links=Links(),
            matrix=matrix,
        )
        return Region(smaller, pieces.sites, pieces.heads, pieces.route)

    def _orders(self, pieces: Pieces, starts: bool, ends: bool) -> Bools:
        """Which piece must come before which."""
        count = len(pieces.first) - 1
        direct = np.zeros((count, count), dtype=np.bool_)
        sooner, later = pieces.of_contour[self._sooner], pieces.of_contour[self._later]
        direct[sooner, later] = sooner != later
        if starts:
            direct[0, 1:] = True
        if ends:
            direct[:-1, -1] = True
        return transitive(direct)
