"""General statements that refuse moves one after the other, as the search reads them: there may be very many."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.encoder.geometry.tolerances import cost_um
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.statements import AtLeast, Steps

from .jit_tools import compiled, flatten, ints

HARD = -1  # a cost that cannot be paid


class Chains(NamedTuple):
    """Moves of which a route may not make all. Those that begin with that from i to j are `of[i * n + j]` … of n.

    Chain k costs `cost[k]` where all moves from `leave` to `reach`, `first[k]` …, are made beside.
    """

    of: Ints
    cost: Ints
    first: Ints
    leave: Ints
    reach: Ints


def is_chain(s: AtLeast) -> bool:
    """Whether a statement refuses moves of which a route may make all but one, whatever is picked."""
    moves = all(isinstance(x, Steps) and x.least == x.most == 1 for x in s.literals)
    return moves and s.when is None and set(s.weights) == {-1} and s.bound == 1 - len(s.literals)


def make_chains(problem: Problem) -> Chains:
    """The chains among the general statements of a problem."""
    n = problem.n
    chains = [
        ([(x.i, x.j) for x in s.literals if isinstance(x, Steps)], HARD if s.weight is None else cost_um(s.weight))
        for s in problem.general
        if is_chain(s)
    ]
    chains.sort(key=lambda chain: chain[0][0])
    begun = [i * n + j for ((i, j), *_), _ in chains]
    beside = [move for moves, _ in chains for move in moves[1:]]
    return Chains(
        of=np.searchsorted(begun, np.arange(n * n + 1 if chains else 0)),
        cost=ints([cost for _, cost in chains]),
        first=flatten([[0] * (len(moves) - 1) for moves, _ in chains])[0],
        leave=ints([i for i, _ in beside]),
        reach=ints([j for _, j in beside]),
    )


@compiled
def chains_made(chains: Chains, order: Ints, position: Ints) -> tuple[int, int]:
    """Cost, and number of hard ones, of the chains that an order of all contours makes."""
    cost, broken, n = 0, 0, len(order)
    for p in range(n - 1 if len(chains.cost) > 0 else 0):
        move = order[p] * n + order[p + 1]
        for k in range(chains.of[move], chains.of[move + 1]):
            made = True
            for e in range(chains.first[k], chains.first[k + 1]):
                made = made and position[chains.reach[e]] == position[chains.leave[e]] + 1
            if made and chains.cost[k] < 0:
                broken += 1
            elif made:
                cost += chains.cost[k]
    return cost, broken
