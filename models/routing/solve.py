"""Solves a routing instance by the engines that solve nests."""

from __future__ import annotations

from dataclasses import dataclass

from kerfwise.encoder.errors import InputError
from kerfwise.models.engines.portfolio import run_portfolio
from kerfwise.models.engines.solution import Progress, SolveOptions
from kerfwise.models.engines.watch import Watch
from kerfwise.models.problem.magnitude import MOST_UM, dearest_um
from kerfwise.models.problem.simplify import simplify

from .instance import Instance


@dataclass(frozen=True, slots=True)
class Answer:
    """A tour in the file's own vertex numbers, empty if none was found, and what is proven of the best tour's cost.

    `bound` is None where nothing is proven, `infeasible` says that no tour keeps the orders.
    """

    tour: tuple[int, ...]
    cost: int | None
    bound: int | None
    infeasible: bool
    notes: tuple[str, ...]

    @property
    def proven(self) -> bool:
        """Whether no tour is cheaper."""
        return self.infeasible or (self.cost is not None and self.bound is not None and self.bound >= self.cost)


def solve_instance(instance: Instance, options: SolveOptions, progress: Progress | None = None) -> Answer:
    """The best tour found within the limits.

    Raises
    ------
    InputError
        If the costs of the instance could overflow.
    """
    if sum(dearest_um(instance.problem).values()) > MOST_UM:
        raise InputError(
            f"a tour could cost over {MOST_UM:,}, too much to be counted exactly: make the weights smaller"
        )
    problem = simplify(instance.problem)
    known = run_portfolio(problem, options, Watch(options, progress))
    bound = known.bound_um if known.proved_by else None
    if known.incumbent is None:
        return Answer((), None, bound, known.infeasible, tuple(known.notes))
    cost = known.incumbent.cost
    tour = instance.tour([int(problem.site_candidate[s]) for s in known.incumbent.route])
    return Answer(tour, cost, None if bound is None else min(bound, cost), False, tuple(known.notes))
