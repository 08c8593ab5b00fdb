"""Which inequalities a flow breaks: what must lead from one place to another does so with too little, by maximum flows.

From home to a contour no plan meets what comes after it, from a contour to home nothing that comes before it, and
from one contour to a later one nothing before the one or after the other, nor home (Balas, Fischetti and Pulleyblank
1995). The same holds of a site, as far as it is used (Fischetti, Salazar González and Toth 1997): without that a flow
can come to a contour at one of its sites and go on in another cycle from the next.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import breadth_first_order, maximum_flow

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.models.problem.closure import immediate
from kerfwise.models.problem.problem import Problem

from .inequalities import ANY, Inequalities

UNIT = 1_000_000
"""Flows are whole millionths."""
MUCH, LITTLE = 0.2, 0.05
"""What may be missing of a flow without a cut: less only where there is no cut by more."""
MOST = 800
"""Inequalities in a round."""
MOVES_PER_S = 2e6
"""Moves of a flow that a second is counted for, every time that it is looked through."""


@dataclass(frozen=True, eq=False, slots=True)
class Flow:
    """How much goes along moves `leave[k]` → `reach[k]` between sites, home last; all (moves,)."""

    leave: Ints
    reach: Ints
    amount: Floats


class _Way(NamedTuple):
    """From contour to contour, or home, meeting nothing that is `barred`; by a site of either where one is given."""

    start: int
    end: int
    barred: Bools
    start_site: int = ANY
    end_site: int = ANY


class _Missing(NamedTuple):
    """A cut that too little goes across: by how much, the sites on either side, and the site that it holds for."""

    amount: float
    tail: Bools
    head: Bools
    through: int


def broken_inequalities(
    problem: Problem, flow: Flow, go: Callable[[], bool] = lambda: True
) -> tuple[Inequalities, float]:
    """The inequalities that most is missing of, and the deterministic seconds spent.

    No more are looked for if `go` says no.
    """
    graph = _Graph(problem, flow)
    found: dict[tuple[bytes, bytes, int], _Missing] = {}
    work = 0.0
    for way in _ways(problem, graph.used):
        if not go():
            break
        work += graph.size / MOVES_PER_S
        cut = graph.least_cut(way)
        if cut is not None:
            found.setdefault((cut.tail.tobytes(), cut.head.tobytes(), cut.through), cut)
    by_much = [cut for cut in found.values() if cut.amount > MUCH]
    chosen = sorted(by_much or found.values(), key=lambda cut: -cut.amount)[:MOST]
    tail, head = (np.array([cut[side] for cut in chosen], dtype=np.bool_).reshape(-1, problem.m + 1) for side in (1, 2))
    through = np.array([cut.through for cut in chosen], dtype=np.int64)
    return Inequalities(tail, head, np.ones(len(chosen)), through), work


def _ways(problem: Problem, used: Floats) -> Iterator[_Way]:
    n, before = problem.n, problem.before
    for j in range(n):
        yield _Way(n, j, before[j])
        yield _Way(j, n, before[:, j])
    for i, j in np.argwhere(immediate(before)).tolist():
        yield _Way(i, j, before[:, i] | before[j])
    for site in np.flatnonzero((used[:-1] > LITTLE) & (used[:-1] < 1 - LITTLE)).tolist():
        j = int(problem.site_contour[site])
        yield _Way(n, j, before[j], end_site=site)
        yield _Way(j, n, before[:, j], start_site=site)


class _Graph:
    """The moves of a flow, between the sites that it uses."""

    def __init__(self, problem: Problem, flow: Flow) -> None:
        room = np.rint(flow.amount * UNIT).astype(np.int32)
        taken = room > 0
        self._owner = np.append(problem.site_contour, problem.n)
        self._sites, ends = np.unique(np.append(flow.leave[taken], flow.reach[taken]), return_inverse=True)
        self._leave, self._reach = ends.reshape(2, -1)
        self._room = room[taken]
        self._contour = self._owner[self._sites]
        self._n = problem.n
        self.size = int(taken.sum())
        self.used: Floats = np.bincount(flow.reach, flow.amount, problem.m + 1).astype(np.float64)

    def least_cut(self, way: _Way) -> _Missing | None:
        """The least cut on a way, if more than a little is missing of what should go across."""
        through = way.start_site if way.start_site != ANY else way.end_site
        need = 1.0 if through == ANY else float(self.used[through])
        kept = np.append(~way.barred, self._n in (way.start, way.end))
        start = self._sites == way.start_site if way.start_site != ANY else self._contour == way.start
        end = self._sites == way.end_site if way.end_site != ANY else self._contour == way.end
        room, source, sink = self._network(kept[self._contour], start, end)
        flow = maximum_flow(room, source, sink)
        amount = need - flow.flow_value / UNIT
        if amount <= LITTLE:
            return None
        left = room - flow.flow
        left.data = np.maximum(left.data, 0)
        left.eliminate_zeros()
        side = np.zeros(room.shape[0], dtype=np.bool_)
        side[breadth_first_order(left, source, return_predecessors=False)] = True
        return _Missing(amount, *self._sides(side[: len(self._sites)], way, kept[self._owner]), through)

    def _network(self, kept: Bools, start: Bools, end: Bools) -> tuple[csr_matrix, int, int]:
        """The kept moves, from one node more to all starts and from all ends to another."""
        size, taken = len(kept), kept[self._leave] & kept[self._reach]
        first, last = np.flatnonzero(start), np.flatnonzero(end)
        leave = np.concatenate([self._leave[taken], np.full(len(first), size), last])
        reach = np.concatenate([self._reach[taken], first, np.full(len(last), size + 1)])
        room = np.concatenate([self._room[taken], np.full(len(first) + len(last), 2 * UNIT, dtype=np.int32)])
        return csr_matrix((room, (leave, reach)), shape=(size + 2, size + 2), dtype=np.int32), size, size + 1

    def _sides(self, side: Bools, way: _Way, kept: Bools) -> tuple[Bools, Bools]:
        """All sites that are not barred on either side; those not in use go with the contour's own, or to the end."""
        before, after = (np.bincount(self._contour[which], minlength=self._n + 1) for which in (side, ~side))
        tail = ((before > 0) & (after == 0))[self._owner]
        tail[self._sites] = side
        if way.start_site != ANY:
            tail[way.start_site] = True
        elif way.start < self._n:
            tail |= self._owner == way.start
        if way.end_site == ANY:
            tail &= self._owner != way.end
        else:
            tail[way.end_site] = False
        return tail & kept, ~tail & kept
