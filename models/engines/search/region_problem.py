"""Makes the smaller problem of a region: with all rules, at the same price but for what no order of it changes."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from kerfwise.arrays import Bools, Ints, concat_ranges
from kerfwise.models.engines.search.state.conditions import Demands
from kerfwise.models.engines.search.state.route_state import SearchTables
from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.crossings import FORBIDDEN, Crossings, in_order
from kerfwise.models.problem.moves import MovePrices
from kerfwise.models.problem.precedence import transitive
from kerfwise.models.problem.problem import Durations, Links, Problem
from kerfwise.rules.statements import About


class Contractor:
    """Makes regions of one problem.

    Parameters
    ----------
    problem
        One that is `regional`, or `mergeable`.
    fields
        The same for kernels.
    """

    def __init__(self, problem: Problem, fields: SearchTables) -> None:
        self._problem = problem
        orders = fields.orders
        self._sooner, self._later = orders.covers, np.repeat(np.arange(problem.n), np.diff(orders.covers_first))
        self._asked = RegionConditions(fields.demands)
        self._crossed = CrossedBy(problem)

    def region(self, route: Ints, free: Bools, starts: bool = False, ends: bool = False) -> Region:
        """The region of the contours that are `free` (n,), whole blocks, on a lawful route.

        `starts` keeps the first piece first, `ends` the last one last.
        """
        loose = free[self._problem.site_contour[route]]
        pieces = Pieces.of(self._problem, route, loose | np.append(True, loose[:-1]), loose)
        return self._of(pieces, starts, ends)

    def merged(self, route: Ints, other: Ints) -> Region:
        """The region in which all arcs that two lawful routes share, from site to site, are taken for granted.

        A good route shares most of its arcs with another one. Where they differ is what is left to find out, and a
        search of that alone goes on faster and moves whole stretches at once (Cook and Seymour 2003). Where they differ
        within a block, its pieces are those of no others.
        """
        following = np.full(self._problem.m, -1, dtype=np.int64)
        following[other[:-1]] = other[1:]
        begins = np.append(True, following[route[:-1]] != route[1:])
        block = self._problem.block[self._problem.site_contour[route]]
        inner = np.append(False, block[1:] == block[:-1])
        parted = np.isin(block, block[begins & inner])
        begins |= ~inner & (parted | np.append(False, parted[:-1]))
        return self._of(Pieces.of(self._problem, route, begins, parted), False, False)

    def _of(self, pieces: Pieces, starts: bool, ends: bool) -> Region:
        problem = self._problem
        before = self._orders(pieces, starts, ends)
        matrix = problem.travel(np.append(pieces.tails, problem.m), np.append(pieces.heads, problem.m))
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
            pace=Durations(),
            links=Links(),
            moves=MovePrices(),
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


@dataclass(frozen=True, eq=False, slots=True)
class Region:
    """`problem` has a contour for each one that is free, and one for each stretch between: a *piece*.

    `pieces[k]` lists the sites of piece k in cutting order. A contour alone keeps all its sites, and `head[s]` is the
    site that site s of the smaller problem stands for; of a stretch it is the first. `route` is the route that it was
    made of, in sites of the smaller problem.
    """

    problem: Problem
    pieces: tuple[Ints, ...]
    head: Ints
    route: Ints

    def whole(self, route: Ints) -> Ints:
        """A route through the smaller problem as one through the problem it was made from."""
        parts = [
            self.head[s : s + 1] if len(self.pieces[p]) == 1 else self.pieces[p]
            for s, p in zip(route.tolist(), self.problem.site_contour[route].tolist(), strict=True)
        ]
        return np.concatenate(parts)


# A route cut into pieces: free contours, and the stretches between them.


@dataclass(frozen=True, eq=False, slots=True)
class Pieces:
    """Pieces in the order of the route, numbered so; those of piece k in the smaller problem are `first[k]` … .

    `sites` are those on the route by piece. By new site: `heads` and `tails` are the first and the last site of what it
    stands for, `site_piece` its piece. `new_site` (m + 1,) is the new number of a site that is a head, `new_tail` of
    one that is a tail, else -1, home the last. By piece: `alone` says that it is one contour with all its sites, `free`
    that it is to stay in the block of its first contour, `leader` is that contour. By contour: `of_contour` is its
    piece, `place` where on the route it stands, `on_route` its site there. `order` are the contours of `whole_route`,
    which is `route` in new sites.
    """

    sites: tuple[Ints, ...]
    first: Ints
    heads: Ints
    tails: Ints
    site_piece: Ints
    new_site: Ints
    new_tail: Ints
    alone: Bools
    free: Bools
    leader: Ints
    of_contour: Ints
    place: Ints
    on_route: Ints
    order: Ints
    whole_route: Ints
    route: Ints

    @classmethod
    def of(cls, problem: Problem, route: Ints, begins: Bools, loose: Bools) -> Pieces:
        """The pieces of a route, which begin where `begins` says; `loose` are free contours, both by place."""
        n, m = problem.n, problem.m
        order = problem.site_contour[route]
        starts = np.flatnonzero(begins)
        sites = tuple(np.split(route, starts[1:]))
        length = np.diff(np.append(starts, n))
        alone, leader = length == 1, order[starts]
        size = np.where(alone, np.diff(problem.first)[leader], 1)
        first = np.append(0, np.cumsum(size)).astype(np.int64)
        site_piece = np.repeat(np.arange(len(starts), dtype=np.int64), size)
        begin = np.where(alone, problem.first[leader], route[starts])
        end = np.where(alone, problem.first[leader], route[starts + length - 1])
        nth = np.arange(first[-1]) - first[site_piece]
        heads, tails = begin[site_piece] + nth, end[site_piece] + nth
        of_contour, place, on_route = (np.empty(n, dtype=np.int64) for _ in range(3))
        of_contour[order] = np.cumsum(begins) - 1
        place[order], on_route[order] = np.arange(n), route
        new_site, new_tail = (np.full(m + 1, -1, dtype=np.int64) for _ in range(2))
        new_site[heads] = new_tail[tails] = np.arange(first[-1])
        new_site[m] = new_tail[m] = first[-1]
        return cls(
            sites, first, heads, tails, site_piece, new_site, new_tail, alone, loose[starts], leader,
            of_contour, place, on_route, order, route, new_site[route[starts]],
        )  # fmt: skip


# Conditions of a problem as conditions of a region.

ABOUT = About("region", (), "what the whole problem asks")


class RegionConditions:
    """The conditions of one problem."""

    def __init__(self, demands: Demands) -> None:
        self._demands = demands
        self._row = np.repeat(np.arange(len(demands.contour)), np.diff(demands.member_first))

    def of(self, pieces: Pieces, before: Bools, site_cost: Ints) -> list[Condition]:
        """What they ask of pieces; what they cost by a site in any order is added to `site_cost`.

        What the order within a piece settles, or orders between pieces (`before`), is left out.
        """
        demands, row = self._demands, self._row
        contour, site = demands.contour, demands.site
        piece = pieces.of_contour[contour]
        alone = pieces.alone[piece]
        taken = (site < 0) | alone | (site == pieces.on_route[contour])
        member, weight = demands.member, demands.weight
        other, here = pieces.of_contour[member], piece[row]
        same = other == here
        sooner = np.where(same, pieces.place[member] < pieces.place[contour[row]], before[other, here])
        open_ = ~same & ~sooner & ~before[here, other]
        count = len(contour)
        bound = demands.bound - _summed(row, np.where(sooner, weight, 0), count)
        low = _summed(row, np.where(open_, np.minimum(weight, 0), 0), count)
        high = _summed(row, np.where(open_, np.maximum(weight, 0), 0), count)
        unsure = taken & (low < bound) & (bound <= high)
        never = taken & (high < bound) & alone & (site >= 0)
        priced = never & (demands.cost >= 0)
        np.add.at(site_cost, pieces.new_site[site[priced]], demands.cost[priced])
        found = []
        for k in np.flatnonzero(unsure | (never & (demands.cost < 0))).tolist():
            weights: dict[int, int] = {}
            for e in range(demands.member_first[k], demands.member_first[k + 1]):
                if open_[e]:
                    weights[int(other[e])] = weights.get(int(other[e]), 0) + int(weight[e])
            at = int(pieces.new_site[site[k]]) if alone[k] and site[k] >= 0 else None
            cost = None if demands.cost[k] < 0 else int(demands.cost[k])
            key = tuple(weights), tuple(weights.values()), int(bound[k])
            found.append(Condition(int(piece[k]), *key, ABOUT, at, cost))
        return found


def _summed(row: Ints, values: Ints, count: int) -> Ints:
    """Sums by row, exact."""
    total = np.zeros(count, dtype=np.int64)
    np.add.at(total, row, values)
    return total


# Moves over parts that are out, as crossings between pieces and as conditions on what a piece moves over.


class CrossedBy:
    """The crossings of one problem."""

    def __init__(self, problem: Problem) -> None:
        rows = problem.crossings
        self._m = problem.m
        by_move = in_order(rows.moves(problem.m))
        self._rows = rows if by_move is None else rows.only(by_move)
        self._move = self._rows.moves(problem.m)
        self._from = np.searchsorted(self._rows.leave, np.arange(problem.m + 2))

    def between(self, pieces: Pieces) -> Crossings:
        """Crossings of the moves from piece to piece."""
        if not len(self._rows):
            return self._rows
        leaves = np.append(pieces.tails, self._m)
        chosen = concat_ranges(self._from[leaves], self._from[leaves + 1] - self._from[leaves])
        chosen = chosen[pieces.new_site[self._rows.reach[chosen]] >= 0]
        rows = self._rows.only(chosen)
        found = Crossings(
            pieces.new_tail[rows.leave],
            pieces.new_site[rows.reach],
            pieces.of_contour[rows.over],
            rows.cost,
            rows.statement,
        )
        piece = np.append(pieces.site_piece, -1)
        return found.only((piece[found.leave] != piece[found.reach]) | (piece[found.leave] < 0))

    def within(self, pieces: Pieces, before: Bools) -> list[Condition]:
        """What the moves within pieces cost for what may be out before: conditions on the piece."""
        if not len(self._rows):
            return []
        route = pieces.whole_route
        piece = pieces.of_contour[pieces.order]
        inner = np.flatnonzero(piece[1:] == piece[:-1])
        move = route[inner] * (self._m + 1) + route[inner + 1]
        low, high = (np.searchsorted(self._move, move, side=side) for side in ("left", "right"))
        here, rows = np.repeat(piece[inner], high - low), concat_ranges(low, high - low)
        other, cost = pieces.of_contour[self._rows.over[rows]], self._rows.cost[rows]
        unsure = (other != here) & ~before[other, here] & ~before[here, other]
        return [
            Condition(p, (q,), (-1,), 0, ABOUT, cost=None if c == FORBIDDEN else c)
            for p, q, c in zip(here[unsure].tolist(), other[unsure].tolist(), cost[unsure].tolist(), strict=True)
        ]
