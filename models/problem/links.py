"""Moves with the torch on: from the end of one site through waste to another, in place of idle travel and a pierce."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from kerfwise.arrays import Bools, Int32s, Ints
from kerfwise.encoder.candidates.candidate import Candidate
from kerfwise.encoder.geometry.microns import cost_um, points_um
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.ranges import laid_out
from kerfwise.rules.by_kind import by_kind
from kerfwise.rules.statements import Link, Statement


def links_on(
    candidates: Sequence[Candidate], statements: Iterable[Statement], route: Sequence[int], home_mm: Point
) -> list[Link | None]:
    """For every cut of a route (candidates in order) the link that leads to it, as the compiled problem has it."""
    kinds = by_kind(statements)
    if not kinds.link:
        return [None] * len(route)
    place = np.full(len(candidates), -1, dtype=np.int64)
    place[list(route)] = np.arange(len(route))
    offered, steps = Links.of(kinds.link, place, len(route)), np.arange(len(route) - 1)
    taken = offered.rows_of(steps, steps + 1).tolist()
    price = sum(s.weight for s in kinds.idle_travel)
    timed = {frozenset((lag.first, lag.second)) for lag in kinds.lag if lag.seconds > 0}
    found: list[Link | None] = [None] * len(route)
    for k, ((a, b), row) in enumerate(zip(pairwise(route), taken, strict=True), 1):
        if row >= 0 and frozenset((candidates[a].contour, candidates[b].contour)) not in timed:
            leave, reach = points_um([candidates[a].end, candidates[b].pierce], home_mm).astype(np.float64)
            idle = int(np.rint(price * np.sqrt(((leave - reach) ** 2).sum())))
            found[k] = kinds.link[offered.path[row]] if offered.cost[row] < idle else None
    return found


def _none() -> Ints:
    return np.zeros(0, dtype=np.int64)


@dataclass(frozen=True, eq=False, slots=True)
class Links:
    """Row k: going from site `leave[k]` to site `reach[k]` costs `cost[k]` µm, whatever is out.

    The cut of that site begins at once and takes `ms[k]` more than with a pierce and a lead-in, mostly less. `path[k]`
    is the number of the statement among those given, which knows the way. Rows are sorted by `leave` and then by
    `reach`, each move once; `sites` is the number of sites. Neither end is home.

    A cost may be less than 0, as the site reached is paid for with its pierce; with what that site costs, it is not.
    """

    leave: Ints = field(default_factory=_none)
    reach: Ints = field(default_factory=_none)
    cost: Ints = field(default_factory=_none)
    ms: Ints = field(default_factory=_none)
    path: Ints = field(default_factory=_none)
    sites: int = 0

    def __len__(self) -> int:
        return len(self.leave)

    @staticmethod
    def of(statements: Sequence[Link], candidate_site: Ints, sites: int) -> Links:
        """The moves that statements offer between the sites of their candidates, of several the cheapest.

        Examples
        --------
        >>> from kerfwise.rules.statements import About
        >>> offer = Link((0,), (2, 3), ((0, 0), (9, 0)), About("links", (), ""), -4.5)
        >>> links = Links.of([offer], np.array([0, 0, 1, -1]), 2)
        >>> links.leave.tolist(), links.reach.tolist(), links.cost.tolist()
        ([0], [1], [-4500])
        """
        leaves = [np.unique(candidate_site[list(s.leave)]) for s in statements]
        reaches = [np.unique(candidate_site[list(s.reach)]) for s in statements]
        sizes = [len(a) * len(b) for a, b in zip(leaves, reaches, strict=True)]
        number = np.repeat(np.arange(len(statements), dtype=np.int64), sizes)
        leave = np.concatenate([_none(), *(np.repeat(a, len(b)) for a, b in zip(leaves, reaches, strict=True))])
        reach = np.concatenate([_none(), *(np.tile(b, len(a)) for a, b in zip(leaves, reaches, strict=True))])
        cost = np.array([cost_um(s.weight) for s in statements], dtype=np.int64)[number]
        ms = np.array([round(s.seconds * 1000) for s in statements], dtype=np.int64)[number]
        order = np.lexsort([number, cost, reach, leave])
        order = order[(leave[order] >= 0) & (reach[order] >= 0)]
        move = leave[order] * sites + reach[order]
        once = order[np.append(True, move[1:] != move[:-1])] if len(order) else order
        return Links(leave[once], reach[once], cost[once], ms[once], number[once], sites)

    def only(self, kept: Bools) -> Links:
        """Some of the rows."""
        return Links(self.leave[kept], self.reach[kept], self.cost[kept], self.ms[kept], self.path[kept], self.sites)

    def renumbered(self, number: Ints, sites: int) -> Links:
        """The rows between sites that are left, `number[s]` is the new number of site s, in the same order, or -1."""
        there = (number[self.leave] >= 0) & (number[self.reach] >= 0)
        left = self.only(there)
        return Links(number[left.leave], number[left.reach], left.cost, left.ms, left.path, sites)

    def rows_of(self, leave: Ints | Int32s, reach: Ints | Int32s) -> Ints:
        """The row of the move from `leave[k]` to `reach[k]`, (k,), -1 where it is no link."""
        if not len(self):
            return np.full(len(leave), -1, dtype=np.int64)
        known, asked = self.leave * (self.sites + 1) + self.reach, leave.astype(np.int64) * (self.sites + 1) + reach
        at = np.minimum(np.searchsorted(known, asked), len(known) - 1)
        return np.where(known[at] == asked, at, -1)

    def laid_over(self, table: Ints, leave: Ints, reach: Ints) -> None:
        """Put what links cost into a table of moves from the sites `leave` (rows) to `reach` (columns)."""
        low, high = np.searchsorted(self.leave, leave), np.searchsorted(self.leave, leave, side="right")
        if (low == high).all():
            return
        link = laid_out(low, high - low)
        row, by_site = np.repeat(np.arange(len(leave)), high - low), np.argsort(reach, kind="stable")
        sites, asked = reach[by_site], self.reach[link]
        low, high = np.searchsorted(sites, asked), np.searchsorted(sites, asked, side="right")
        again = np.repeat(np.arange(len(link)), high - low)
        table[row[again], by_site[laid_out(low, high - low)]] = self.cost[link[again]]
