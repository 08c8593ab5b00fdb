"""Which inequalities a flow breaks, found by least cuts in its graph."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.models.jit import jit
from kerfwise.models.problem.precedence import immediate

from .inequalities import DemandColumns, Inequalities, Order, OrderCut, cover_inequalities, cut_inequalities
from .network import Network

# Which inequalities a flow breaks: what must lead from one place to another does so with too little, by maximum
# flows.
#
# From home to a contour no plan meets what comes after it, from a contour to home nothing that comes before it, and
# from one contour to a later one nothing before the one or after the other, nor home (Balas, Fischetti and
# Pulleyblank 1995). The same holds of a site, as far as it is used (Fischetti, Salazar González and Toth 1997):
# without that a flow can come to a contour at one of its sites and go on in another cycle from the next.

MUCH = 0.2
"""What may be missing of a flow where there are cuts by more."""
MOST, PLENTY = 250, 2
"""Inequalities in a round at the most, unless there are more contours; and how many times as many are looked for."""
REST = 3
"""Rounds for which ways that nothing is missing of are looked at no more, unless nothing is missing of any other."""
LOOKS = 64
"""Ways from one look at whether to go on to the next."""
MOVES_PER_S, BESIDE = 1.5e7, 800
"""Moves of a flow that a second is counted for, every time that it is looked through; so many take as long as all else
with a way."""


class _Sites(NamedTuple):
    """Some sites of a contour."""

    contour: int
    sites: tuple[int, ...]


_Task = tuple[int] | tuple[int, int] | _Sites | Order


class Separation:
    """Looks for inequalities of a problem that a flow breaks, and counts the deterministic seconds spent."""

    def __init__(self, network: Network, demands: DemandColumns) -> None:
        self._network, self._problem, self._demands = network, network.problem, demands
        self._wants_out = np.ascontiguousarray(network.sooner.T)
        self._wants_in = np.ascontiguousarray(network.later.T)
        self._owner = np.append(self._problem.site_contour, self._problem.n)
        self._blocks = np.append(self._problem.block, -1)[self._owner]
        self._near = immediate(self._problem.before)
        self._ordered = self._sites_by_order()
        self._most = max(MOST, self._problem.n)
        self._round, self._rests = 0, dict[_Task, int]()
        self.work = 0.0

    def broken(self, flow: Flow, beside: Floats, go: Callable[[], bool] = lambda: True) -> Inequalities:
        """The inequalities that most is missing of; `beside` (columns,) are the values of the columns beside the moves.

        No more are looked for if `go` says no.
        """
        graph = Graph(self._network, flow)
        found: dict[bytes, Missing] = {}
        self._round += 1
        tasks = self._tasks(graph.used, beside)
        tasks = [tasks[k] for k in np.random.default_rng(self._round).permutation(len(tasks)).tolist()]
        rested = [task for task in tasks if self._rests.get(task, 0) <= self._round]
        self._look(rested, graph, beside, found, go)
        if not found:
            self._look([task for task in tasks if self._rests.get(task, 0) > self._round], graph, beside, found, go)
        by_much = [missing for missing in found.values() if missing.amount > MUCH]
        chosen = sorted(by_much or found.values(), key=lambda missing: -missing.amount)[: self._most]
        m, columns = self._problem.m, len(beside)
        covers = [cover for _, cover in self._demands.covers(graph.used, beside)]
        return cut_inequalities([graph.lifted(missing) for missing in chosen], m, columns).joined(
            cover_inequalities(covers, m, columns)
        )

    def _look(
        self, tasks: list[_Task], graph: Graph, beside: Floats, found: dict[bytes, Missing], go: Callable[[], bool]
    ) -> None:
        """Look at some until more is missing than a round takes; those that nothing is missing of then rest."""
        much = 0
        for count, task in enumerate(tasks):
            if much > PLENTY * self._most or (count % LOOKS == 0 and not go()):
                break
            whole = True
            for way in self._ways(task):
                self.work += (graph.size + BESIDE) / MOVES_PER_S
                missing = graph.least_cut(way, beside)
                if missing is not None:
                    whole = False
                    much += missing.amount > MUCH and missing.name not in found
                    found.setdefault(missing.name, missing)
            if whole:
                self._rests[task] = self._round + REST

    def _tasks(self, used: Floats, beside: Floats) -> list[_Task]:
        """What may be missing of a flow: to and from every contour, between two, by sites, and in an order."""
        tasks: list[_Task] = [(j,) for j in range(self._problem.n)]
        tasks += [(i, j) for i, j in np.argwhere(self._near).tolist()]
        split = np.flatnonzero((used[:-1] > LITTLE) & (used[:-1] < 1 - LITTLE))
        tasks += [_Sites(int(self._problem.site_contour[site]), (site,)) for site in split.tolist()]
        tasks += [some for some in self._ordered if used[list(some.sites)].sum() > LITTLE]
        orders = (order for pair in self._demands.pairs for order in (pair, pair.other_way_round))
        return [*tasks, *(order for order in orders if order.value(beside) > LITTLE)]

    def _ways(self, task: _Task) -> Iterator[Way]:
        n, wants_out, wants_in = self._problem.n, self._wants_out, self._wants_in
        if isinstance(task, _Sites):
            yield from self._by_sites(task.contour, list(task.sites))
        elif isinstance(task, Order):
            block = self._blocks
            i, j = task.first, task.then
            sooner, later = block == self._problem.block[i], block == self._problem.block[j]
            yield Way(n, i, wants_out[i] | wants_out[j] | later, order=task)
            yield Way(i, j, wants_in[i] | wants_out[j], order=task)
            yield Way(j, n, wants_in[j] | wants_in[i] | sooner, order=task)
        elif len(task) == 1:
            yield Way(n, task[0], wants_out[task[0]])
            yield Way(task[0], n, wants_in[task[0]])
        else:
            i, j = task
            yield Way(i, j, wants_in[i] | wants_out[j])

    def _by_sites(self, j: int, sites: list[int]) -> Iterator[Way]:
        """Ways to and from some sites of contour j, with what holds where one of them is used."""
        n, network, owner = self._problem.n, self._network, self._owner
        through = np.zeros(len(owner), dtype=np.bool_)
        through[sites] = True
        later, sooner = network.later[sites].all(axis=0), network.sooner[sites].all(axis=0)
        after, before = np.append(later, False)[owner], np.append(sooner, False)[owner]
        after |= network.sooner[:, later].any(axis=1) | self._wants_out[j]
        before |= network.later[:, sooner].any(axis=1) | self._wants_in[j]
        others = (owner == j) & ~through
        yield Way(n, j, after | others, end_sites=through)
        yield Way(j, n, before | others, start_sites=through)
        for k in np.flatnonzero(later & ~self._problem.before[j]).tolist():
            yield Way(j, k, before | others | self._wants_out[k], start_sites=through)
        for k in np.flatnonzero(sooner & ~self._problem.before[:, j]).tolist():
            yield Way(k, j, after | others | self._wants_in[k], end_sites=through)

    def _sites_by_order(self) -> list[_Sites]:
        """Contours with those of their sites that want one other contour out, or in, where those are several."""
        found: dict[_Sites, None] = {}
        for side in (self._network.sooner, self._network.later):
            for j in range(self._problem.n):
                sites = self._problem.sites(j)
                of_contour = side[sites.start : sites.stop]
                for k in np.flatnonzero(of_contour.any(axis=0) & ~of_contour.all(axis=0)).tolist():
                    chosen = tuple((sites.start + np.flatnonzero(of_contour[:, k])).tolist())
                    if len(chosen) > 1:
                        found[_Sites(j, chosen)] = None
        return list(found)


# The graph of a flow, and the least cuts on the ways across it.

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


# The inner loop of the search for broken inequalities, compiled by numba.


@jit(nogil=True)
def flow_up_to(  # pragma: no cover - compiled
    enough: int, start: Bools, end: Bools, open_: Bools, leave: Ints, reach: Ints, room: Ints, first: Ints,
    arcs: Ints, side: Bools
) -> int:  # fmt: skip
    """The most that flows from the `start` nodes to the `end` nodes over `open_` nodes, or more than `enough` of it.

    By blocking flows in layers (Dinitz 1970). Arc a leads from node `leave[a]` to `reach[a]` and has `room[a]`; arcs
    of node k are `arcs[first[k]:first[k + 1]]`, a where it leaves and ~a where it arrives. Where the most is no more
    than enough, `side` says on return which nodes are on the starts' side of a least cut.
    """
    nodes = len(start)
    left, back = room.copy(), np.zeros_like(room)
    layer, queue, at = np.empty(nodes, np.int64), np.empty(nodes, np.int64), np.empty(nodes, np.int64)
    path = np.empty(nodes, np.int64)
    total = 0
    while True:
        side[:] = False
        last, found = 0, -1
        for k in range(nodes):
            if start[k] and open_[k]:
                side[k], queue[last], layer[k] = True, k, 0
                last += 1
        starts, looked = last, 0
        while looked < last:
            k = queue[looked]
            looked += 1
            if layer[k] == found:
                break
            for e in range(first[k], first[k + 1]):
                arc = arcs[e]
                to = reach[arc] if arc >= 0 else leave[~arc]
                some = left[arc] if arc >= 0 else back[~arc]
                if some > 0 and open_[to] and not side[to]:
                    side[to], layer[to] = True, layer[k] + 1
                    queue[last] = to
                    last += 1
                    if end[to] and found < 0:
                        found = layer[to]
        if found < 0:
            return total
        for x in range(last):
            at[queue[x]] = first[queue[x]]
        for x in range(starts):
            k, depth = queue[x], 0
            while True:
                if end[k]:
                    most = enough + 1
                    for d in range(depth):
                        arc = path[d]
                        most = min(most, left[arc] if arc >= 0 else back[~arc])
                    cut = depth
                    for d in range(depth - 1, -1, -1):
                        arc = path[d]
                        if arc >= 0:
                            left[arc] -= most
                            back[arc] += most
                            full = left[arc] == 0
                        else:
                            back[~arc] -= most
                            left[~arc] += most
                            full = back[~arc] == 0
                        if full:
                            cut = d
                    total += most
                    if total > enough:
                        return total
                    depth = cut
                    arc = path[depth]
                    k = leave[arc] if arc >= 0 else reach[~arc]
                    continue
                went = False
                while at[k] < first[k + 1]:
                    arc = arcs[at[k]]
                    to = reach[arc] if arc >= 0 else leave[~arc]
                    some = left[arc] if arc >= 0 else back[~arc]
                    if some > 0 and side[to] and layer[to] == layer[k] + 1 and (end[to] or layer[to] < found):
                        path[depth] = arc
                        depth += 1
                        k, went = to, True
                        break
                    at[k] += 1
                if went:
                    continue
                if depth == 0:
                    break
                depth -= 1
                arc = path[depth]
                k = leave[arc] if arc >= 0 else reach[~arc]
                at[k] += 1
