"""What a plan costs: idle travel, and the penalties of soft statements, in whole µm."""

from __future__ import annotations

from collections.abc import Iterator

from ortools.sat.python.cp_model import CpModel, LinearExpr, LinearExprT

from ..problem import UM_PER_MM, Problem
from .arcs import Arcs
from .constraints import inner, is_out_by
from .variables import Variables


def set_objective(model: CpModel, problem: Problem, arcs: Arcs, v: Variables) -> None:
    """Minimise idle travel and penalties."""
    terms = [
        _travel(problem, arcs, v),
        _sites(problem, v),
        _conditions(problem, v),
        *_groups(problem, v),
        _others(problem, v),
    ]
    model.minimize(LinearExpr.sum(terms))


def limit_objective(model: CpModel, least_um: int, most_um: int | None) -> None:
    """Tell the solver what is known of the cost: a proven lower bound, and the cost of a known route."""
    objective = model.proto.objective
    offset = round(objective.offset)  # the domain is that of the terms alone
    objective.domain.extend([least_um - offset, (1 << 60) if most_um is None else most_um - offset])


def _travel(problem: Problem, arcs: Arcs, v: Variables) -> LinearExprT:
    """Every arc at its cost, with what it always crosses; what it crosses only in some orders is paid for apart."""
    cost = arcs.cost.copy()
    rows = problem.crossings
    place = {leg: a for a, leg in enumerate(zip(arcs.tail.tolist(), arcs.head.tolist(), strict=True))}
    for leave, reach, over, price in zip(
        rows.leave.tolist(), rows.reach.tolist(), rows.over.tolist(), rows.cost.tolist(), strict=True
    ):
        if price > 0 and (leave, reach) in place and is_out_by(problem, over, leave, reach, problem.m):
            cost[place[leave, reach]] += price
    return LinearExpr.weighted_sum(v.travel, cost.tolist())


def _sites(problem: Problem, v: Variables) -> LinearExprT:
    """What using a site costs."""
    return LinearExpr.weighted_sum(v.pick, problem.site_cost.tolist())


def _conditions(problem: Problem, v: Variables) -> LinearExprT:
    """Every soft condition that is not met costs once."""
    return LinearExpr.weighted_sum(list(v.broken.values()), [problem.conditions[k].cost or 0 for k in v.broken])


def _groups(problem: Problem, v: Variables) -> Iterator[LinearExprT]:
    """A group in one piece has one inner step less than members; every further piece is one step fewer."""
    for group in problem.soft_groups:
        members = sorted(set(group.contours))
        steps = inner(v, members)
        yield LinearExpr.weighted_sum(steps, [-group.cost] * len(steps)) + group.cost * (len(members) - 1)


def _others(problem: Problem, v: Variables) -> LinearExprT:
    """Soft lags cost by the cut that is missing, soft general statements once."""
    return LinearExpr.weighted_sum(
        [*v.missing.values(), *v.failed.values(), *v.over.values(), *v.late.values()],
        [
            *(round((problem.lags[k].weight or 0.0) * UM_PER_MM) for k in v.missing),
            *(round((problem.general[k].weight or 0.0) * UM_PER_MM) for k in v.failed),
            *problem.crossings.cost[list(v.over)].tolist(),
            *(round(problem.lags[k].weight or 0.0) for k in v.late),
        ],
    )
