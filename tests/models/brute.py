"""The cheapest lawful route by trying every one: what each engine must agree with on tiny problems."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import permutations, product

from kerfwise.models.engines.solution import Incumbent
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.models.problem.problem import Problem


def cheapest(problem: Problem) -> Incumbent | None:
    """A cheapest lawful route, or None if every route breaks a hard statement."""
    found = ((route_cost(problem, route), route) for route in lawful(problem))
    best = min(found, default=None)
    return None if best is None else Incumbent(best[1], best[0])


def lawful(problem: Problem) -> Iterator[tuple[int, ...]]:
    """Every route that breaks nothing."""
    for order in permutations(range(problem.n)):
        if any(problem.before[j, i] for k, j in enumerate(order) for i in order[:k]):
            continue
        for route in product(*(problem.sites(i) for i in order)):
            if not broken(problem, route):
                yield route
