"""A smaller problem that stands for a part of a route."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.models.problem.problem import Problem


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
