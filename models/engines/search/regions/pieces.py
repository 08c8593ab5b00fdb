"""A route cut into pieces: free contours, and the stretches between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kerfwise.arrays import Bools, Ints
from kerfwise.models.problem.problem import Problem


@dataclass(frozen=True, eq=False, slots=True)
class Pieces:
    """Pieces in the order of the route, numbered so; those of piece k in the smaller problem are `first[k]` … .

    `sites` are those on the route by piece. By new site: `heads` and `tails` are the first and the last site of what it
    stands for, `site_piece` its piece. `new_site` (m + 1,) is the new number of a site that is a head, `new_tail` of
    one that is a tail, else -1, home the last. By piece: `alone` says that it is one contour with all its sites, `free`
    that it is a free one, `leader` is its first contour and `closer` its last. By contour: `of_contour` is its piece,
    `place` where on the route it stands, `on_route` its site there. `order` are the contours of `whole_route`, which
    is `route` in new sites.
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
    closer: Ints
    of_contour: Ints
    place: Ints
    on_route: Ints
    order: Ints
    whole_route: Ints
    route: Ints

    @classmethod
    def of(cls, problem: Problem, route: Ints, free: Bools) -> Pieces:
        """The pieces of a route; `free` by contour."""
        n, m = problem.n, problem.m
        order = problem.site_contour[route]
        loose = free[order]
        begins = loose | np.append(True, loose[:-1])
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
            order[starts + length - 1], of_contour, place, on_route, order, route, new_site[route[starts]],
        )  # fmt: skip
