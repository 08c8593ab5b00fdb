"""The graph of a flow, and the least cuts on the ways across it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from kerfwise.arrays import Bools, Floats, Ints

from .demands import Order
from .flow_kernels import flow_up_to
from .inequalities import OrderCut
from .network import Network

UNIT = 1_000_000
"""Flows are whole millionths."""
LITTLE = 0.05
"""What may be missing of a flow without a cut."""


@dataclass(frozen=True, eq=False, slots=True)
class Flow:
    """How much goes along moves `leave[k]` → `reach[k]` between sites, home last; all (moves,)."""

    leave: Ints
    reach: Ints
    amount: Floats


class Way(NamedTuple):
    """From contour to contour, or home, meeting no site that is `barred` (m + 1,); by some sites of either where those
    are given, or as far as an order holds."""

    start: int
    end: int
    barred: Bools
    start_sites: Bools | None = None
    end_sites: Bools | None = None
    order: Order | None = None

    @property
    def through(self) -> Bools | None:
        """The sites that count, None for all of the contour."""
        return self.end_sites if self.start_sites is None else self.start_sites


class Missing(NamedTuple):
    """How much is missing of what should go a way, and which of the nodes of a graph are on its start's side."""

    amount: float
    way: Way
    side: Bools

    @property
    def name(self) -> bytes:
        """Equal for ways that are cut alike."""
        way, sites = self.way, self.way.through
        order = b"" if way.order is None else bytes(f"{way.order.column} {way.order.turned}", "ascii")
        return self.side.tobytes() + way.barred.tobytes() + (b"" if sites is None else sites.tobytes()) + order


class Graph:
    """The moves of a flow, between the sites that it uses."""

    def __init__(self, network: Network, flow: Flow) -> None:
        problem = network.problem
        room = np.rint(flow.amount * UNIT).astype(np.int64)
        taken = room > 0
        self._owner = np.append(problem.site_contour, problem.n)
        self._sites, ends = np.unique(np.append(flow.leave[taken], flow.reach[taken]), return_inverse=True)
        self._leave, self._reach = ends.reshape(2, -1)
        self._room = room[taken]
        ends = np.concatenate([self._leave, self._reach])
        arcs = np.arange(len(self._leave))
        self._first = np.searchsorted(np.sort(ends), np.arange(len(self._sites) + 1))
        self._arcs = np.concatenate([arcs, ~arcs])[np.argsort(ends, kind="stable")]
        self._contour = self._owner[self._sites]
        self._n, self._before, self._first_site = problem.n, problem.before, problem.first[:-1]
        self._wants_out, self._wants_in = network.sooner, network.later
        self.size = int(taken.sum())
        self.used: Floats = np.bincount(flow.reach, flow.amount, problem.m + 1).astype(np.float64)

    def least_cut(self, way: Way, beside: Floats) -> Missing | None:
        """The least cut on a way, if more than a little is missing of what should go across."""
        through = way.through
        need = 1.0 if through is None else float(self.used[through].sum())
        if way.order is not None:
            need = way.order.value(beside)
        kept = self._kept(way)
        start = (way.start_sites if way.start_sites is not None else self._owner == way.start)[self._sites]
        end = (way.end_sites if way.end_sites is not None else self._owner == way.end)[self._sites]
        side = np.empty(len(self._sites), dtype=np.bool_)
        enough = round((need - LITTLE) * UNIT)
        over = flow_up_to(
            enough, start, end, kept[self._sites], self._leave, self._reach, self._room, self._first, self._arcs, side
        )
        amount = need - over / UNIT
        return Missing(amount, way, side) if amount > LITTLE else None

    def lifted(self, missing: Missing) -> OrderCut:
        """What goes from one side to the other, meeting as little as can be."""
        way = missing.way
        tail, head = self._sides(missing.side, way)
        kept = self._kept(way) & ~self._lifted(tail, head, way)
        return OrderCut(tail & kept, head & kept, way.through, way.order)

    def _kept(self, way: Way) -> Bools:
        kept = ~way.barred
        kept[-1] = self._n in (way.start, way.end)
        return kept

    def _lifted(self, tail: Bools, head: Bools, way: Way) -> Bools:
        """Sites (m + 1,) that the move across meets as little as what the way bars, given all that is on its sides.

        Of the contours that lie whole on the side of the tail, the last is no earlier than any of them; the move out of
        it meets nothing that comes before one of them. On the way to home that is all of them, on the way to a contour
        those that come before it. The same from the other end (Balas, Fischetti and Pulleyblank 1995).
        """
        before, i, j, n = self._before, way.start, way.end, self._n
        first = self._first_site
        left = np.logical_and.reduceat(tail[:-1], first)
        right = np.logical_and.reduceat(head[:-1], first)
        if j == n:
            left[i] = True
            return np.asarray(self._wants_in[:, left].any(axis=1))
        if i == n:
            right[j] = True
            return np.asarray(self._wants_out[:, right].any(axis=1))
        left &= before[:, j]
        left[i] = True
        right &= before[left].all(axis=0)
        right[j] = True
        return np.asarray(self._wants_in[:, left].any(axis=1) | self._wants_out[:, right].any(axis=1))

    def _sides(self, side: Bools, way: Way) -> tuple[Bools, Bools]:
        """All sites on either side; those not in use go with the contour's own, or to the end."""
        before, after = (np.bincount(self._contour[which], minlength=self._n + 1) for which in (side, ~side))
        tail = ((before > 0) & (after == 0))[self._owner]
        tail[self._sites] = side
        if way.start_sites is not None:
            tail |= way.start_sites
        elif way.start < self._n:
            tail |= self._owner == way.start
        tail &= ~way.end_sites if way.end_sites is not None else self._owner != way.end
        return tail, ~tail
