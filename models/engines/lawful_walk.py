"""Building an order step by step, always knowing what may lawfully be cut next; and one that is like a known order."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.encoder.geometry.tolerances import UM_PER_MM
from kerfwise.models.problem.conditions import ConditionRows
from kerfwise.models.problem.moves import LAWFUL_MOST
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.statements import EXEMPTION_MM

EXCUSE_UM = round(EXEMPTION_MM * UM_PER_MM)


class Walk:
    """A route that grows; `options` are the sites that keep every hard statement which the sets cut so far decide.

    `left` says of each contour, (n,), whether it is still to be cut. A walk may end where nothing lawful is left though
    contours are: then it must begin again.
    """

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self.route: list[int] = []
        self.left = np.ones(problem.n, dtype=np.bool_)
        self._waits = problem.before.sum(axis=0, dtype=np.int64)
        self._in_block = np.bincount(problem.block, minlength=problem.n)
        self._block = -1
        self._apart = {frozenset(pair) for pair in problem.apart()}
        given = [c for c in problem.conditions if c.cost is None or c.cost >= EXCUSE_UM]
        rows = ConditionRows.of(given)
        self._contour, self._site, self._short = rows.contour, rows.site, rows.bound
        self._rows_of, self._row, self._weight = rows.by_member(problem.n)
        self._hard = np.array([c.cost is None for c in given], dtype=np.bool_)
        self._unmet_of_site = np.zeros((2, problem.m), dtype=np.int64)  # that may be excused, and that may not
        self._unmet_of_site[0] = problem.site_cost >= EXCUSE_UM
        self._unmet_of_contour = np.zeros((2, problem.n), dtype=np.int64)
        self._count(np.flatnonzero(self._short > 0), 1)

    @property
    def finished(self) -> bool:
        """Whether every contour has its place."""
        return len(self.route) == self.problem.n

    def options(self, among: Bools | None = None) -> list[int]:
        """Sites that may come next, in order; those that need an excuse only where there are no others.

        Of the contours that are `among`, (n,), those alone.
        """
        ready = self._ready()
        sites = self.problem.sites_of(ready if among is None else ready[among[ready]])
        if self.route:
            sites = sites[self.problem.travel(self.route[-1:], sites)[0] <= LAWFUL_MOST]
        unmet = self._unmet_of_site[:, sites] + self._unmet_of_contour[:, self.problem.site_contour[sites]]
        lawful, free = unmet[1] == 0, unmet[0] == 0
        found: list[int] = sites[lawful & free if (lawful & free).any() else lawful].tolist()
        return found

    def take(self, site: int) -> None:
        """Cut this one next."""
        contour, block = int(self.problem.site_contour[site]), int(self.problem.block[self.problem.site_contour[site]])
        self.route.append(site)
        self.left[contour] = False
        self._waits -= self.problem.before[contour]
        self._in_block[block] -= 1
        self._block = block if self._in_block[block] > 0 else -1
        touched = slice(int(self._rows_of[contour]), int(self._rows_of[contour + 1]))
        rows = self._row[touched]
        was = self._short[rows] > 0
        self._short[rows] -= self._weight[touched]
        now = self._short[rows] > 0
        self._count(rows[now & ~was], 1)
        self._count(rows[was & ~now], -1)

    def _ready(self) -> Ints:
        """Contours whose turn the orders, blocks and bans on moves allow."""
        ready = np.flatnonzero(self.left & (self._waits == 0))
        if self._block >= 0:
            ready = ready[self.problem.block[ready] == self._block]
        if self._apart and self.route:
            last = int(self.problem.site_contour[self.route[-1]])
            ready = ready[[frozenset((last, c)) not in self._apart for c in ready.tolist()]]
        return ready

    def _count(self, rows: Ints, more: int) -> None:
        """Count conditions that are not met any more, or, with -1, that are met now."""
        whole = self._site[rows] < 0
        kind = self._hard[rows].astype(np.int64)
        np.add.at(self._unmet_of_contour, (kind[whole], self._contour[rows[whole]]), more)
        np.add.at(self._unmet_of_site, (kind[~whole], self._site[rows[~whole]]), more)


def route_like(
    problem: Problem, wanted: Sequence[int], places: Mapping[int, int] | None = None
) -> tuple[int, ...] | None:
    """A route as much like a wanted one as a walk allows, or None where that comes to no end.

    Parameters
    ----------
    wanted
        Sites in cutting order, each of another contour; contours that are missing come after those that they lie
        nearest to, by their nearest sites.
    places
        Contour → its place in the order, from 0, of those that have to be at one: what has to be out before comes in
        time.
    """
    pinned = _Pinned(problem, places or {})
    walk, centre = Walk(problem), _centres(problem)
    rank, liked = np.arange(problem.n, dtype=np.float64), np.full(problem.n, -1, dtype=np.int64)
    for place, site in enumerate(wanted):
        rank[problem.site_contour[site]], liked[problem.site_contour[site]] = place, site
    known = np.flatnonzero(liked >= 0)
    for contour in np.flatnonzero(liked < 0).tolist() if len(known) else ():
        rank[contour] = rank[known[np.hypot(*(centre[known] - centre[contour]).T).argmin()]] + 0.5
    while not walk.finished:
        options = np.array(walk.options(pinned.next_to(walk)), dtype=np.int64)
        if not len(options):
            return None
        contours = problem.site_contour[options]
        chosen = contours[rank[contours].argmin()]
        sites = options[contours == chosen]
        if liked[chosen] in sites:
            walk.take(int(liked[chosen]))
        else:
            here = np.full(len(sites), walk.route[-1] if walk.route else problem.m)
            walk.take(int(sites[problem.legs(here, sites).argmin()]))
    return tuple(walk.route)


class _Pinned:
    """Contours that have to be cut at their places, and by when all that has to be out before them is cut."""

    def __init__(self, problem: Problem, places: Mapping[int, int]) -> None:
        self._at = {place: contour for contour, place in places.items()}
        self._pinned = np.zeros(problem.n, dtype=np.bool_)
        self._due = np.full(problem.n, problem.n)
        for contour, place in places.items():
            self._pinned[contour], self._due[contour] = True, place
            ahead = problem.before[:, contour]
            self._due[ahead] = np.minimum(self._due[ahead], place - 1)
        self._last = np.unique(self._due[self._due < problem.n]).tolist()

    def next_to(self, walk: Walk) -> Bools | None:
        """Which contours may come next, (n,): the one of the place, else one that is due, else any without a place."""
        if not self._at:
            return None
        place = len(walk.route)
        if (contour := self._at.get(place)) is not None:
            return np.asarray(np.arange(len(self._due)) == contour)
        for last in self._last:
            pressing = walk.left & (self._due <= last)
            if int(pressing.sum()) >= last - place + 1:
                return np.asarray(pressing & ~self._pinned)
        return np.asarray(walk.left & ~self._pinned)


def _centres(problem: Problem) -> Floats:
    """Where contours are pierced, on an average, (n, 2), µm."""
    if not problem.n:
        return np.zeros((0, 2))
    return np.add.reduceat(problem.pierce_um.astype(np.float64), problem.first[:-1]) / np.diff(problem.first)[:, None]
