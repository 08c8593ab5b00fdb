"""What kind of problem it is: by that members are chosen, and their shares."""

from __future__ import annotations

from kerfwise.models.engines import bounds, ideals, shares
from kerfwise.models.problem.problem import Problem

from .run import Run


def density(problem: Problem) -> float:
    """Share of the pairs of contours that hard orders decide."""
    n = problem.n
    return float(problem.before.sum()) / max(1, n * (n - 1) // 2)


def carried(problem: Problem) -> bool:
    """Whether CP-SAT alone can hold all that is asked."""
    return problem.further_back is not None


def bounded_well(problem: Problem) -> bool:
    """Whether the bound by flows is worth its time: a nest, with all its sites in it."""
    return problem.m <= bounds.MOST_SITES and bool(problem.conditions or problem.lags)


def bounded_beside(run: Run) -> bool:
    """Whether the bound by flows is looked for at the same time as a better plan."""
    many = run.problem.n > shares.FLOW_FEW
    return many and bounded_well(run.problem) and not carried(run.problem) and run.options.gap is None


def priced_first(run: Run) -> bool:
    """Whether a nest is so small that the ideals with multipliers of the flow come near its best plan at once."""
    if run.options.member is not None or run.problem.n > shares.FLOW_FEW or not bounded_well(run.problem):
        return False
    return ideals.priceable(run.problem) and ideals.sets_out(run.problem, run.left() * shares.PRICED)
