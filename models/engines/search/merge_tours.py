"""A child of two routes: an annealing of what they do not agree about."""

from __future__ import annotations

import numpy as np

from kerfwise.models.problem.evaluate import route_cost
from kerfwise.models.problem.problem import Problem

from .merge import merge
from .pool import Elite
from .tables import make_tables
from .walker import Walker
from .walkers import make_walker_like

LEAST = 8  # contours of a merged problem that is worth a search
EACH = 400_000  # operations for each of its contours


def merge_tours(
    problem: Problem, walker: Walker, parents: tuple[Elite, Elite], seed: tuple[int, ...], most: int
) -> tuple[Elite, int]:
    """The best route found between two, in about `most` operations at the most, and how many it took.

    If they hardly differ, the walker goes on from the better one through the whole problem.

    The walker's temperatures are taken; equal seeds and parents give equal children.
    """
    better, other = parents
    merged = merge(problem, better.route, other.route)
    if merged.problem.n < LEAST:
        walker.stand_on(better.route)
        walker.forget()
        operations = min(most, EACH * problem.n)
        walker.cool(operations)
        found = walker.take()
        return better if found is None else found, operations
    fields = make_tables(merged.problem)
    child = make_walker_like(walker, fields, seed)
    child.stand_on(merged.route)
    operations = min(most, EACH * merged.problem.n)
    child.cool(operations)
    found = child.take()
    if found is None:
        return better, operations
    route = np.ascontiguousarray(merged.whole(found.route))
    return Elite(route_cost(problem, route.tolist()), route), operations
