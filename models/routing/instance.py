"""A routing instance as its file says it, and the same as a `Problem` that every engine takes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.models.problem.closure import close
from kerfwise.models.problem.problem import Problem


@dataclass(frozen=True, eq=False)
class Instance:
    """A tour visits one vertex of every cluster, clusters in an order that keeps `orders`, and costs the arcs it takes.

    Vertices and clusters are numbered from 0 here and from 1 in files and tours. `cost` is (v, v); `clusters[k]` the
    vertices of cluster k; `orders` (k, 2) pairs of clusters (before, after), sorted. `start` is the vertex that every
    tour begins at. A `closed` tour returns there, an open one ends at the last vertex visited.
    """

    name: str
    cost: Ints
    clusters: tuple[tuple[int, ...], ...]
    orders: Ints
    start: int
    closed: bool

    @cached_property
    def problem(self) -> Problem:
        """The instance with the start as home: cluster k that is not the start's is contour k, or k - 1 after it."""
        home = next(k for k, members in enumerate(self.clusters) if self.start in members)
        rest = [k for k in range(len(self.clusters)) if k != home]
        number = np.zeros(len(self.clusters), dtype=np.int64)
        number[rest] = np.arange(len(rest))
        n = len(rest)
        before = close(n, number[self.orders[self.orders[:, 0] != home]], np.arange(n, dtype=np.int64))
        counts = [len(self.clusters[k]) for k in rest]
        m = sum(counts)
        nowhere = np.zeros((m, 2), dtype=np.int64)
        return Problem(
            n=n,
            first=np.concatenate([[0], np.cumsum(counts)]).astype(np.int64),
            site_contour=np.repeat(np.arange(n, dtype=np.int64), counts),
            site_candidate=np.arange(m, dtype=np.int64),
            candidate_site=np.arange(m, dtype=np.int64),
            pierce_um=nowhere,
            end_um=nowhere,
            site_cost=np.zeros(m, dtype=np.int64),
            home_um=np.zeros(2, dtype=np.int64),
            travel_weight=1.0,
            before=before,
            block=np.arange(n, dtype=np.int64),
            conditions=(),
            soft_groups=(),
            lags=(),
            general=(),
            ids=tuple(str(k + 1) for k in rest),
            matrix=self._matrix(),
        )

    def tour(self, route: Sequence[int]) -> tuple[int, ...]:
        """The vertices, numbered as in the file, of a route through the sites of `problem`."""
        vertices = self._vertices()
        return tuple(int(vertices[s]) + 1 for s in (len(vertices) - 1, *route))

    def _vertices(self) -> Ints:
        """The vertex of every site, that of home last."""
        rest = [v for members in self.clusters if self.start not in members for v in members]
        return np.array([*rest, self.start], dtype=np.int64)

    def _matrix(self) -> Ints:
        """Costs between sites. What stands where an order forbids the arc (-1, often) is made the dearest arc."""
        vertices = self._vertices()
        matrix = self.cost[np.ix_(vertices, vertices)].copy()
        matrix[matrix < 0] = matrix.max()
        if not self.closed:
            matrix[:, -1] = 0
        return matrix
