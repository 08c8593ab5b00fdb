"""A problem as the flat arrays that compiled kernels read."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..problem import Problem
from .crossed import Crossed, make_crossed
from .demands import Demands, make_demands
from .groups import Groups, make_groups
from .lags import Lags, make_lags
from .legs import Legs, make_legs
from .literals import Literals, make_literals
from .orders import Orders, make_orders


class Tables(NamedTuple):
    """Everything that stays as it is during a search."""

    legs: Legs
    orders: Orders
    demands: Demands
    crossed: Crossed
    groups: Groups
    lags: Lags
    literals: Literals


def make_tables(problem: Problem, travel: NDArray[np.int64] | None = None) -> Tables:
    """The arrays of a problem; `travel` (m + 1, m + 1), home last, instead of distances in the plane."""
    legs = make_legs(problem, travel)
    return Tables(
        legs,
        make_orders(problem, legs),
        make_demands(problem),
        make_crossed(problem, priced=legs.travel.size > 0),
        make_groups(problem),
        make_lags(problem),
        make_literals(problem),
    )
