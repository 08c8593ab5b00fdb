"""Which inequalities a flow breaks: what must lead from one place to another does so with too little, by maximum flows.

From home to a contour no plan meets what comes after it, from a contour to home nothing that comes before it, and
from one contour to a later one nothing before the one or after the other, nor home (Balas, Fischetti and Pulleyblank
1995). The same holds of a site, as far as it is used (Fischetti, Salazar González and Toth 1997): without that a flow
can come to a contour at one of its sites and go on in another cycle from the next.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from kerfwise.arrays import Floats
from kerfwise.models.problem.closure import immediate

from .demands import DemandColumns, Order
from .inequalities import Inequalities, of_covers, of_cuts
from .least_cuts import LITTLE, Flow, Graph, Missing, Way
from .network import Network

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
        return of_cuts([graph.lifted(missing) for missing in chosen], m, columns).joined(of_covers(covers, m, columns))

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
