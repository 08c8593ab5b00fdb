"""Which inequalities a flow breaks, found by least cuts in its graph."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from ortools.graph.python.max_flow import SimpleMaxFlow

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.models.engines.tuning import MOVES_PER_S, PLENTY, REST
from kerfwise.models.engines.tuning import SEPARATION_BESIDE as BESIDE
from kerfwise.models.engines.tuning import SEPARATION_LITTLE as LITTLE
from kerfwise.models.engines.tuning import SEPARATION_LOOKS as LOOKS
from kerfwise.models.engines.tuning import SEPARATION_MOST as MOST
from kerfwise.models.engines.tuning import SEPARATION_MUCH as MUCH
from kerfwise.models.problem.precedence import immediate

from .network import Inequalities, Network

# Which inequalities a flow breaks: what must lead from one place to another does so with too little, by maximum
# flows.
#
# From home to a contour no plan meets what comes after it, from a contour to home nothing that comes before it, and
# from one contour to a later one nothing before the one or after the other, nor home (Balas, Fischetti and
# Pulleyblank 1995). The same holds of a site, as far as it is used (Fischetti, Salazar González and Toth 1997):
# without that a flow can come to a contour at one of its sites and go on in another cycle from the next.


_Task = tuple[int] | tuple[int, int] | np.int64
"""To and from a contour, from one contour to another, or by a site."""


class Separation:
    """Looks for inequalities of a problem that a flow breaks, and counts the deterministic seconds spent."""

    def __init__(self, network: Network) -> None:
        self._network, self._problem = network, network.problem
        self._wants_out = np.ascontiguousarray(network.sooner.T)
        self._wants_in = np.ascontiguousarray(network.later.T)
        self._owner = np.append(self._problem.site_contour, self._problem.n)
        self._near = immediate(self._problem.before)
        self._most = max(MOST, self._problem.n)
        self._round, self._rests = 0, dict[_Task, int]()
        self.work = 0.0

    def broken(self, flow: Flow, go: Callable[[], bool] = lambda: True) -> Inequalities:
        """The inequalities that most is missing of. No more are looked for if `go` says no."""
        graph = Graph(self._network, flow)
        found: dict[bytes, Missing] = {}
        self._round += 1
        tasks = self._tasks(graph.used)
        tasks = [tasks[k] for k in np.random.default_rng(self._round).permutation(len(tasks)).tolist()]
        rested = [task for task in tasks if self._rests.get(task, 0) <= self._round]
        self._look(rested, graph, found, go)
        if not found:
            self._look([task for task in tasks if self._rests.get(task, 0) > self._round], graph, found, go)
        by_much = [missing for missing in found.values() if missing.amount > MUCH]
        chosen = sorted(by_much or found.values(), key=lambda missing: -missing.amount)[: self._most]
        return cut_inequalities([graph.cut(missing) for missing in chosen], self._problem.m)

    def _look(self, tasks: list[_Task], graph: Graph, found: dict[bytes, Missing], go: Callable[[], bool]) -> None:
        """Look at some until more is missing than a round takes; those that nothing is missing of then rest."""
        much = 0
        for count, task in enumerate(tasks):
            if much > PLENTY * self._most or (count % LOOKS == 0 and not go()):
                break
            whole = True
            for way in self._ways(task):
                self.work += (graph.size + BESIDE) / MOVES_PER_S
                missing = graph.least_cut(way)
                if missing is not None:
                    whole = False
                    much += missing.amount > MUCH and missing.name not in found
                    found.setdefault(missing.name, missing)
            if whole:
                self._rests[task] = self._round + REST

    def _tasks(self, used: Floats) -> list[_Task]:
        """What may be missing of a flow: to and from every contour, between two, and by sites."""
        tasks: list[_Task] = [(j,) for j in range(self._problem.n)]
        tasks += [(i, j) for i, j in np.argwhere(self._near).tolist()]
        return [*tasks, *np.flatnonzero((used[:-1] > LITTLE) & (used[:-1] < 1 - LITTLE))]

    def _ways(self, task: _Task) -> Iterator[Way]:
        n, wants_out, wants_in = self._problem.n, self._wants_out, self._wants_in
        if isinstance(task, np.int64):
            yield from self._by_site(task)
        elif len(task) == 1:
            yield Way(n, task[0], wants_out[task[0]])
            yield Way(task[0], n, wants_in[task[0]])
        else:
            i, j = task
            yield Way(i, j, wants_in[i] | wants_out[j])

    def _by_site(self, site: np.int64) -> Iterator[Way]:
        """Ways to and from a site, with what holds where it is used."""
        n, network, owner = self._problem.n, self._network, self._owner
        j = int(owner[site])
        through = np.arange(len(owner)) == site
        later, sooner = network.later[site], network.sooner[site]
        after = np.append(later, False)[owner] | network.sooner[:, later].any(axis=1) | self._wants_out[j]
        before = np.append(sooner, False)[owner] | network.later[:, sooner].any(axis=1) | self._wants_in[j]
        others = (owner == j) & ~through
        yield Way(n, j, after | others, end_sites=through)
        yield Way(j, n, before | others, start_sites=through)
        for k in np.flatnonzero(later & ~self._problem.before[j]).tolist():
            yield Way(j, k, before | others | self._wants_out[k], start_sites=through)
        for k in np.flatnonzero(sooner & ~self._problem.before[:, j]).tolist():
            yield Way(k, j, after | others | self._wants_in[k], end_sites=through)


# The graph of a flow, and the least cuts on the ways across it.

UNIT = 1_000_000
"""Flows are whole millionths."""
ALL = 1 << 40
"""More of these than ever flow."""


@dataclass(frozen=True, eq=False, slots=True)
class Flow:
    """How much goes along moves `leave[k]` → `reach[k]` between sites, home last; all (moves,)."""

    leave: Ints
    reach: Ints
    amount: Floats


class Way(NamedTuple):
    """From contour to contour, or home, meeting no site that is `barred` (m + 1,); by some sites of either where those
    are given."""

    start: int
    end: int
    barred: Bools
    start_sites: Bools | None = None
    end_sites: Bools | None = None

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
        return self.side.tobytes() + way.barred.tobytes() + (b"" if sites is None else sites.tobytes())


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
        self._contour = self._owner[self._sites]
        self._n = problem.n
        self.size = int(taken.sum())
        self.used: Floats = np.bincount(flow.reach, flow.amount, problem.m + 1).astype(np.float64)

    def least_cut(self, way: Way) -> Missing | None:
        """The least cut on a way, if more than a little is missing of what should go across."""
        through = way.through
        need = 1.0 if through is None else float(self.used[through].sum())
        kept = self._kept(way)
        open_ = kept[self._sites]
        start = (way.start_sites if way.start_sites is not None else self._owner == way.start)[self._sites] & open_
        end = (way.end_sites if way.end_sites is not None else self._owner == way.end)[self._sites] & open_
        goes, nodes = open_[self._leave] & open_[self._reach], len(self._sites)
        graph = SimpleMaxFlow()
        graph.add_arcs_with_capacity(self._leave[goes], self._reach[goes], self._room[goes])
        for k in np.flatnonzero(start).tolist():
            graph.add_arc_with_capacity(nodes, k, ALL)
        for k in np.flatnonzero(end).tolist():
            graph.add_arc_with_capacity(k, nodes + 1, ALL)
        graph.solve(nodes, nodes + 1)
        amount = need - graph.optimal_flow() / UNIT
        if amount <= LITTLE:
            return None
        side = np.zeros(nodes + 2, dtype=np.bool_)
        side[graph.get_source_side_min_cut()] = True
        return Missing(amount, way, side[:-2])

    def cut(self, missing: Missing) -> OrderCut:
        """What goes from one side to the other."""
        tail, head = self._sides(missing.side, missing.way)
        kept = self._kept(missing.way)
        return OrderCut(tail & kept, head & kept, missing.way.through)

    def _kept(self, way: Way) -> Bools:
        kept = ~way.barred
        kept[-1] = self._n in (way.start, way.end)
        return kept

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
