"""The problem: facts and statements as the numbers that every engine works on.

Costs are whole micrometres (of idle travel, or of what a soft rule is worth in it), so that all engines agree to
the last digit. Candidates of a contour that no statement tells apart and that share pierce and end are one *site*.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from kerfwise.arrays import Bools, Floats, Int32s, Ints, concat_ranges
from kerfwise.encoder.candidates.candidate import Candidate
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.geometry.tolerances import cost_um, points_um
from kerfwise.models.physics.motion import Feeds
from kerfwise.rules.statements import About, AtLeast, Lag, Link, Statement, by_kind

from .conditions import Condition, LoweredStatements
from .crossings import Crossings
from .moves import MovePrices
from .precedence import Followers, known_followers

AT_ONCE = 30_000
"""Moves whose lengths are worked out together: they fit into a processor's cache."""

# Moves with the torch on: from the end of one site through waste to another, in place of idle travel and a pierce.


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
        known, wanted = self.leave * (self.sites + 1) + self.reach, leave.astype(np.int64) * (self.sites + 1) + reach
        at = np.minimum(np.searchsorted(known, wanted), len(known) - 1)
        return np.where(known[at] == wanted, at, -1)

    def laid_over(self, table: Ints, leave: Ints, reach: Ints) -> None:
        """Put what links cost into a table of moves from the sites `leave` (rows) to `reach` (columns)."""
        low, high = np.searchsorted(self.leave, leave), np.searchsorted(self.leave, leave, side="right")
        if (low == high).all():
            return
        link = concat_ranges(low, high - low)
        row, by_site = np.repeat(np.arange(len(leave)), high - low), np.argsort(reach, kind="stable")
        sites, asked = reach[by_site], self.reach[link]
        low, high = np.searchsorted(sites, asked), np.searchsorted(sites, asked, side="right")
        again = np.repeat(np.arange(len(link)), high - low)
        table[row[again], by_site[concat_ranges(low, high - low)]] = self.cost[link[again]]


# How long cuts and moves take, in whole milliseconds, for statements that count seconds.


@dataclass(frozen=True, eq=False, slots=True)
class Durations:
    """`cut_ms` (m,) is the time of every site's cut, piercing included; a move of d µm takes d · `ms_per_um`, rounded.

    An empty `cut_ms` says that cuts and moves take no time.
    """

    cut_ms: Ints = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    ms_per_um: float = 0.0

    @staticmethod
    def of(facts: Facts, representatives: Sequence[int], feeds: Feeds) -> Durations:
        """The pace of a machine, for the candidates that the sites stand for."""
        times = []
        for number in representatives:
            candidate = facts.candidates[number]
            contour = facts.nest.contours[candidate.contour]
            if contour.kind == "mark":
                times.append(feeds.mark_start_s + candidate.cut_mm / feeds.mark_mm_s)
            else:
                pierce = feeds.edge_s if candidate.unpierced else feeds.pierce_s
                run_mm = candidate.cut_mm + candidate.at_corners_mm(contour)
                times.append(pierce + run_mm / (feeds.cut_mm_s * contour.feed_share))
        return Durations(np.asarray(np.rint(np.array(times) * 1000), dtype=np.int64), 1.0 / feeds.travel_mm_s)

    def move_ms(self, from_um: Ints, to_um: Ints) -> Ints:
        """Time of the moves between points (k, 2), ms."""
        gap = np.sqrt(((from_um.astype(np.float64) - to_um) ** 2).sum(axis=-1))
        return np.asarray(np.rint(gap * self.ms_per_um), dtype=np.int64)


@dataclass(frozen=True, slots=True)
class SoftGroup:
    """Contours that should follow each other: every piece beyond the first costs `cost` µm."""

    contours: tuple[int, ...]
    cost: int
    about: About


@dataclass(frozen=True, eq=False, slots=True)
class Problem:
    """n contours, m sites.

    `site_candidate[s]` is the candidate that site s stands for, `candidate_site[c]` the site of candidate c or -1;
    sites of contour i are `first[i]` … `first[i+1] - 1`.
    `pierce_um`, `end_um` are (m, 2) coordinates, µm; `site_cost` (m,) what using a site costs (soft `Forbid`).
    `before[i, j]` says that i must come before j (closure, lifted over contiguous blocks); `block[i]` numbers the
    contiguous block that i belongs to. `conditions` are about sites (`when` is a site here). `general` are statements
    that only an engine with the whole order in hand can judge, as are `lags`; those of one cut are among `moves`,
    which are what going directly from one site to another costs. `crossings` are moves that cost more, or are unlawful,
    once some contour is out. `pace` tells how long cuts and moves take. `links` are moves with the torch on, each in
    place of the idle travel between its two sites.
    `left_out` are soft rules that could not be priced on a problem of this size, and why. `matrix` (m + 1, m + 1), home
    last, replaces idle travel between points, and the prices of moves, where costs are given by a table. `orders` tells
    hard orders and blocks that `before` was made of from others, where it was made of such. `told` is what the
    statements came to before candidates became sites, for a problem of these and more.
    """

    n: int
    first: Ints
    site_contour: Ints
    site_candidate: Ints
    candidate_site: Ints
    pierce_um: Ints
    end_um: Ints
    site_cost: Ints
    home_um: Ints
    travel_weight: float
    before: Bools
    block: Ints
    conditions: tuple[Condition, ...]
    soft_groups: tuple[SoftGroup, ...]
    lags: tuple[Lag, ...]
    general: tuple[AtLeast, ...]
    ids: tuple[str, ...]
    crossings: Crossings = field(default_factory=Crossings)
    pace: Durations = field(default_factory=Durations)
    links: Links = field(default_factory=Links)
    moves: MovePrices = field(default_factory=MovePrices)
    matrix: Ints | None = None
    left_out: tuple[tuple[str, str], ...] = ()
    orders: bytes = b""
    told: LoweredStatements = field(default_factory=LoweredStatements, repr=False)

    @property
    def m(self) -> int:
        """Number of sites."""
        return len(self.site_contour)

    def sites(self, contour: int) -> range:
        """Site numbers of a contour."""
        return range(int(self.first[contour]), int(self.first[contour + 1]))

    def sites_of(self, contours: Ints | Sequence[int]) -> Ints:
        """Site numbers of several contours, one after the other."""
        chosen = np.asarray(contours, dtype=np.int64)
        return concat_ranges(self.first[chosen], self.first[chosen + 1] - self.first[chosen])

    @property
    def looks_one_back(self) -> bool:
        """Whether the cost of a step depends on nothing but the set already cut and the last site.

        Lags and general statements look further back than that.
        """
        return self.further_back is None

    @property
    def further_back(self) -> About | None:
        """The first statement that looks further back than a set and the last site tell; None where none does."""
        lags = (lag.about for lag in self.lags if lag.cuts > 1 or lag.seconds > 0)
        return next(lags, self.general[0].about if self.general else None)

    @property
    def order_density(self) -> float:
        """Share of the pairs of contours that hard orders decide."""
        return float(self.before.sum()) / max(1, self.n * (self.n - 1) // 2)

    def successors(self) -> Bools:
        """Matrix (n + 1, n + 1): which contour may directly follow which; n is the machine's home."""
        return self.followers().whole()

    def followers(self) -> Followers:
        """The same, as bits: for large problems."""
        return known_followers(self.before, self.block, self.apart(), self.moves.barred)

    def apart(self) -> list[tuple[int, int]]:
        """Contours that hard lags of several cuts keep from following each other, whichever comes first."""
        return [(lag.first, lag.second) for lag in self.lags if lag.weight is None and lag.cuts > 0]

    def travel(self, leave: Ints | Sequence[int], reach: Ints | Sequence[int]) -> Ints:
        """Cost matrix of the moves from the end of each site in `leave` (k,) to the pierce of each in `reach` (l,).

        Idle travel, or a link where there is one, and the price of the move, `UNLAWFUL` where it is none. Home is
        site m. Whole µm, or whatever unit `matrix` has.
        """
        if self.matrix is not None:
            table = np.asarray(self.matrix[np.ix_(np.asarray(leave), np.asarray(reach))], dtype=np.int64)
        else:
            ends, pierces = self._at(self.end_um, leave), self._at(self.pierce_um, reach)
            table = np.empty((len(ends), len(pierces)), dtype=np.int64)
            rows = max(1, AT_ONCE // max(1, len(pierces)))
            room = np.empty((2, rows, len(pierces)))
            for k in range(0, len(ends), rows):
                some = ends[k : k + rows]
                far, up = room[:, : len(some)]
                for axis, away in enumerate((far, up)):
                    np.subtract.outer(some[:, axis], pierces[:, axis], out=away)
                    away *= away
                far += up
                np.sqrt(far, out=far)
                far *= self.travel_weight
                table[k : k + rows] = np.rint(far, out=far)
        if len(self.links):
            self.links.laid_over(table, np.asarray(leave), np.asarray(reach))
        if self.matrix is None and len(self.moves.price):
            self.moves.price.add_to(table, np.asarray(leave, dtype=np.int64), np.asarray(reach, dtype=np.int64))
        return table

    def legs(self, leave: Ints | Sequence[int], reach: Ints | Sequence[int]) -> Ints:
        """Cost of the move from the end of `leave[k]` to the pierce of `reach[k]`, (k,); home is site m."""
        if self.matrix is not None:
            cost = np.asarray(self.matrix[leave, reach], dtype=np.int64)
        else:
            gap = self._at(self.end_um, leave) - self._at(self.pierce_um, reach)
            cost = np.asarray(np.rint(self.travel_weight * np.sqrt((gap**2).sum(axis=1))), dtype=np.int64)
        if len(self.links):
            row = self.links.rows_of(np.asarray(leave), np.asarray(reach))
            cost = np.where(row >= 0, self.links.cost[row], cost)
        if self.matrix is None and len(self.moves.price):
            cost = cost + self.moves.price.each(np.asarray(leave, dtype=np.int64), np.asarray(reach, dtype=np.int64))
        return cost

    def _at(self, points_um: Ints, sites: Ints | Sequence[int]) -> Floats:
        """The points of some sites, home included, (k, 2)."""
        chosen = np.asarray(sites, dtype=np.int64)
        at = np.empty((len(chosen), 2))
        home = chosen == self.m
        at[home], at[~home] = self.home_um, points_um[chosen[~home]]
        return at

    def ends(self) -> Ints:
        """Where the torch is after every site and at home, (m + 1, 2), µm."""
        return np.vstack([self.end_um, self.home_um])

    def pierces(self) -> Ints:
        """Where every site is pierced, and home, (m + 1, 2), µm."""
        return np.vstack([self.pierce_um, self.home_um])
