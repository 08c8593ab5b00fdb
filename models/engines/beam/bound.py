"""What every plan still costs after a state: bounds that a child takes over from its parent in a few additions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kerfwise.arrays import Floats, Ints
from kerfwise.models.problem.problem import Problem

from .tables import way_home


@dataclass(frozen=True, eq=False, slots=True)
class Bound:
    """b bounds of one form, of which the greatest counts.

    After d contours, the last at site s, the rest of the plan costs at least `to_go[k, d, s]` and `price[k, c]` for
    every contour c that is not yet cut. `to_go` is (b, n + 1, m), `price` (b, n); after n contours `to_go` is exact,
    infinite where no lawful move leads home.
    """

    to_go: Floats
    price: Floats


def least_in_and_out(problem: Problem, travel: Ints) -> Bound:
    """Every contour left must be reached, and left again, by the least lawful move; `travel` as in `BeamTables`."""
    n, m = problem.n, problem.m
    reach, leave = travel.min(axis=0), travel.min(axis=1)
    into = np.minimum.reduceat(reach[:m] + problem.site_cost, problem.first[:-1])
    out = np.minimum.reduceat(leave[:m] + problem.site_cost, problem.first[:-1])
    to_go = np.empty((2, n + 1, m))
    to_go[0] = reach[m]
    to_go[1] = leave[:m]
    to_go[:, n] = way_home(problem, travel)
    return Bound(to_go, np.stack([into, out]).astype(np.float64))
