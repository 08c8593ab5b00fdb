"""What is left of the cost of every move once a linear program has its bound: a bound on each single plan.

A plan costs as much as the bound of a linear program by flows, and what its multipliers leave of each of its moves, at
least: what it pays for orders, conditions and contours is in the bound already (Lagrangian relaxation: Geoffrion 1974).
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Floats, Ints
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.solution import Incumbent, made_s
from kerfwise.models.engines.tuning import REDUCED_LEAST_GAIN as LEAST_GAIN
from kerfwise.models.engines.tuning import REDUCED_MOST_SITES as MOST_SITES
from kerfwise.models.engines.tuning import REDUCED_PATIENCE as PATIENCE
from kerfwise.models.problem.problem import Problem

from .flow import CutLoop
from .move_costs import Stopped
from .network import Multipliers, Network, left_of, network_of

NEVER = 1 << 38
"""µm: what is unlawful in a table costs that, or more; any plan costs less."""
MOST_UM = 1 << 50
"""No plan is so dear, so that no move leaves the program."""
GRAIN = 64.0
"""Multipliers are multiples of 1 / 64: sums of them and of whole costs are then exact in doubles."""


class Proving(NamedTuple):
    """Multipliers of the program of a network."""

    network: Network
    multipliers: Multipliers


@dataclass(frozen=True, eq=False, slots=True)
class ReducedCosts:
    """A plan costs `bound` and the `dear` of all its moves in the network at least, µm.

    `dear` (m + 1, m + 1), home last, is never negative; `NEVER` where no plan has the move.
    """

    bound: int
    dear: Ints
    work: float
    by: Proving

    @property
    def network(self) -> Network:
        """What the moves are of."""
        return self.by.network


def reduced_costs(
    problem: Problem, plan: Incumbent, most_um: int, deadline: Deadline, earlier: Proving | None = None
) -> ReducedCosts | None:
    """Solve the linear program of a problem, and say what it leaves of every move.

    Parameters
    ----------
    problem
        Moves that cost `NEVER` or more are none.
    plan
        A lawful one; its cost is as high as a bound can be.
    most_um
        No plan that costs more is wanted: a condition that is dearer is not broken.
    deadline
        The round in which its work is spent is finished. Asked every round.
    earlier
        Multipliers of such a problem: where only moves from and to home cost something else, they stay.

    Returns
    -------
    None where there are too many sites, or no time for a first solution.
    """

    def in_time() -> bool:
        return deadline("bound", plan.cost, None)

    try:
        network = network_of(problem, plan.route, most_um, MOST_SITES, in_time)
        if network.problem.m > MOST_SITES:
            return None
        network = replace(network, cost=np.where(network.cost < NEVER, network.cost, np.inf))
        if earlier is not None and _alike(network, earlier.network):
            return _reduced(earlier._replace(network=network), made_s(network.cost.size))
        loop = CutLoop(network, plan, deadline, in_time, MOST_UM)
        with suppress(Stopped):
            loop.run(PATIENCE, LEAST_GAIN)
    except Stopped:
        return None
    if loop.proving is None:
        return None
    return _reduced(Proving(network, loop.proving), loop.flow.work)


def _alike(one: Network, other: Network) -> bool:
    """Whether two networks differ in moves from and to home alone."""

    def held(network: Network) -> tuple[NDArray[Any], ...]:
        problem, inside = network.problem, network.cost[:-1, :-1]
        return network.sites, network.sooner, network.later, problem.before, problem.block, inside

    same = all(map(np.array_equal, held(one), held(other)))
    return same and one.problem.conditions == other.problem.conditions


def _reduced(by: Proving, work: float) -> ReducedCosts:
    network, given = by
    price, paid = np.rint(given.price * GRAIN) / GRAIN, np.floor(given.paid * GRAIN) / GRAIN
    bound, least, left = left_of(network, given._replace(price=price, paid=paid))
    left -= least[np.append(network.problem.site_contour, network.problem.n)]
    dear = np.full(left.shape, NEVER, dtype=np.int64)
    lawful = np.isfinite(left)
    dear[lawful] = np.floor(np.minimum(left[lawful], NEVER)).astype(np.int64)
    return ReducedCosts(int(np.floor(bound)), dear, work, by)


def entering(network: Network, travel: Ints) -> Ints:
    """What it costs to come to every site of a network from elsewhere, (rows, m), as `Network.cost` is counted.

    `travel` (rows, sites) is what it costs to come to every site of the whole problem. `NEVER` where no plan does.
    """
    inside = network.inside
    part: Floats = travel[:, network.sites].astype(np.float64) + network.problem.site_cost
    inside.come_through(travel[:, inside.inner].astype(np.float64), part)
    part[:, ~np.isfinite(network.cost[-1, :-1])] = np.inf
    cost: Ints = np.minimum(part, NEVER).astype(np.int64)
    return cost
