"""What the cost of a plan is made of: travel, and every breach of a soft rule with its price and place."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from kerfwise.encoder.geometry.tolerances import UM_PER_MM, cost_um
from kerfwise.models.plan.plan import Prices
from kerfwise.models.problem.crossings import FORBIDDEN
from kerfwise.models.problem.evaluate import (
    broken_conditions,
    broken_moves,
    general_holds,
    missing_ms,
    pieces,
    route_cost,
    times_ms,
)
from kerfwise.rules.statements import About, Move, by_kind

from .context import PlanContext


def price_split(setting: PlanContext) -> Prices:
    """The parts of a plan's objective, mm: they sum up to what the route costs; breaches of one sentence are one.

    Breaches come by rule, those of the dearest rule first, and in the order of the plan.
    """
    found: dict[About, float] = {}
    for about, um in _paid(setting):
        found[about] = found.get(about, 0.0) + um / UM_PER_MM
    of_rule: dict[str, float] = {}
    for about, mm in found.items():
        of_rule[about.rule] = of_rule.get(about.rule, 0.0) + mm
    breaches = sorted(((about, mm) for about, mm in found.items() if mm), key=lambda of: -of_rule[of[0].rule])
    whole_mm = route_cost(setting.problem, setting.route) / UM_PER_MM
    rows = tuple((about.rule, about.contours, about.sentence, mm) for about, mm in breaches)
    return Prices(whole_mm - sum(found.values()), rows)


def _paid(setting: PlanContext) -> Iterator[tuple[About, int]]:
    """What each soft statement costs on the plan's route, µm."""
    problem, route, order = setting.problem, setting.route, setting.order
    kinds = by_kind(setting.stated.statements)
    used, candidates = set(route), set(setting.candidates)
    for forbid in kinds.forbid:
        if forbid.weight is not None and forbid.candidate in candidates:
            yield forbid.about, cost_um(forbid.weight)
    for cost, about in broken_conditions(problem, route):
        if cost is not None:
            yield about, cost
    for group in problem.soft_groups:
        yield group.about, group.cost * (pieces(order, group.contours) - 1)
    number = {id(s): k for k, s in enumerate(problem.moves.statements)}  # several of one rule as it states them
    for move, k in sorted(broken_moves(problem, route), key=lambda of: number[id(of[0])]):
        if move.weight is not None:
            yield _of_move(setting, move, order[k], order[k + 1]), cost_um(move.weight)
    place = {c: k for k, c in enumerate(order)}
    times = times_ms(problem, route) if any(lag.seconds for lag in problem.lags) else {}
    for lag in problem.lags:
        if lag.weight is not None:
            missing = max(0, lag.cuts - (abs(place[lag.first] - place[lag.second]) - 1))
            yield lag.about, missing * cost_um(lag.weight) + round(lag.weight) * missing_ms(lag, times)
    for s in problem.general:
        if s.weight is not None and not general_holds(problem, s, place, used):
            yield s.about, cost_um(s.weight)
    over = {s.over: s.about for s in kinds.crossing}
    rows = problem.crossings
    if len(rows):
        stops = np.array([problem.m, *route, problem.m])
        step = {leg: k for k, leg in enumerate(pairwise(stops.tolist()))}
        on_route = np.isin(rows.leave, stops) & np.isin(rows.reach, stops)
        for k in np.flatnonzero(on_route).tolist():
            taken = step.get((int(rows.leave[k]), int(rows.reach[k])))
            contour, cost = int(rows.over[k]), int(rows.cost[k])
            if taken is not None and place[contour] < taken and cost != FORBIDDEN:
                yield over.get(contour) or over[None], cost  # what was out from the start is any contour that is cut


def _of_move(setting: PlanContext, s: Move, leave: int, reach: int) -> About:
    """What a statement about many moves says of one of them."""
    if len(s.leave) == len(s.reach) == 1:
        return s.about
    ids = setting.name(leave), setting.name(reach)
    return About(s.about.rule, ids, f"{ids[1]} directly follows {ids[0]}: {s.about.sentence}")
