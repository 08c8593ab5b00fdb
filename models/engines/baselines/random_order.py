"""Random lawful orders: the strategy "random transitions" of Verkhoturov et al."""

from __future__ import annotations

import random

from kerfwise.encoder.errors import RulesConflict
from kerfwise.models.problem.evaluate import broken
from kerfwise.models.problem.problem import Problem

from .walk import Walk

ATTEMPTS = 200


def random_order(problem: Problem, seed: int, first_entry: bool = False) -> tuple[int, ...]:
    """A lawful route (sites): every step a contour drawn evenly from those that may come next, then one of its sites.

    With `first_entry` each contour takes the first site that is lawful then, so that routes differ by order alone.

    Raises
    ------
    RulesConflict
        If no attempt led to the end.
    """
    chance = random.Random(seed)
    for _ in range(ATTEMPTS):
        walk = Walk(problem)
        while not walk.finished:
            options = walk.options()
            if not options:
                break
            contour = chance.choice(sorted({int(problem.site_contour[s]) for s in options}))
            sites = [s for s in options if problem.site_contour[s] == contour]
            walk.take(sites[0] if first_entry else chance.choice(sites))
        if walk.finished and not broken(problem, walk.route):
            return tuple(walk.route)
    raise RulesConflict(f"no lawful order came of {ATTEMPTS} attempts at random")
