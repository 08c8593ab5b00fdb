"""What a plan costs: idle travel, and the penalties of soft statements, in whole µm."""

from __future__ import annotations

from collections.abc import Iterator

from ortools.sat.python.cp_model import CpModel, LinearExpr, LinearExprT

from kerfwise.encoder.geometry.microns import UM_PER_MM
from kerfwise.models.problem.problem import Problem

from .arcs import ArcLiterals
from .constraints import inner
from .variables import Variables


def set_objective(model: CpModel, problem: Problem, arcs: ArcLiterals, v: Variables) -> None:
    """Minimise idle travel and penalties."""
    terms = [
        _travel(arcs, v),
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


def _travel(arcs: ArcLiterals, v: Variables) -> LinearExprT:
    return LinearExpr.weighted_sum(v.travel, arcs.cost.tolist())


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
    """Soft lags cost by the cut or the ms that is missing; soft general statements and moves over parts cost once."""
    return LinearExpr.weighted_sum(
        [*v.missing.values(), *v.failed.values(), *v.over.values(), *v.late.values()],
        [
            *(round((problem.lags[k].weight or 0.0) * UM_PER_MM) for k in v.missing),
            *(round((problem.general[k].weight or 0.0) * UM_PER_MM) for k in v.failed),
            *(v.crossings[k].cost for k in v.over),
            *(round(problem.lags[k].weight or 0.0) for k in v.late),
        ],
    )
