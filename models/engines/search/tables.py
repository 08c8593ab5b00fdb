"""A problem as the flat arrays that compiled kernels read."""

from __future__ import annotations

from typing import NamedTuple

from kerfwise.models.problem.problem import Problem

from .arcs import ArcCosts, make_arcs
from .crossed import Crossed, make_crossed
from .demands import Demands, make_demands
from .groups import Groups, make_groups
from .lags import Lags, make_lags
from .legs import Legs, make_legs
from .literals import Literals, make_literals
from .orders import OrderLists, make_orders


class SearchTables(NamedTuple):
    """Everything that stays as it is during a search."""

    legs: Legs
    orders: OrderLists
    demands: Demands
    crossed: Crossed
    groups: Groups
    lags: Lags
    literals: Literals
    arcs: ArcCosts


def make_tables(problem: Problem) -> SearchTables:
    """The arrays of a problem."""
    legs = make_legs(problem)
    return SearchTables(
        legs,
        make_orders(problem, legs),
        make_demands(problem),
        make_crossed(problem, priced=legs.travel.size > 0),
        make_groups(problem),
        make_lags(problem),
        make_literals(problem),
        make_arcs(problem, legs),
    )
