"""What must hold of a plan, one family a function."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from ortools.sat.python.cp_model import CpModel, LinearExpr, LiteralT

from ...rules.statements import Before
from ..crossings import FORBIDDEN
from ..problem import Problem
from .arcs import Arcs, arc_ms
from .variables import Variables, open_crossings


def add_constraints(model: CpModel, problem: Problem, arcs: Arcs, v: Variables) -> None:
    """Everything that is hard, and what ties soft statements to their penalties."""
    _one_site_a_contour(model, problem, v)
    _one_round_trip(model, v)
    _travel_joins_contours(model, arcs, v)
    _travel_joins_picked_sites(model, problem, arcs, v)
    _positions_follow_the_route(model, problem, v)
    _positions_differ(model, v)
    _orders_hold(model, problem, v)
    _blocks_stay_together(model, problem, v)
    _order_literals_agree_with_positions(model, v)
    _conditions_are_met(model, problem, v)
    _lags_are_kept(model, problem, v)
    _general_statements_hold(model, problem, v)
    _moves_over_parts_are_paid_for(model, problem, arcs, v)
    _the_clock_runs_along_the_route(model, problem, arcs, v)
    _cooling_takes_its_time(model, problem, v)


def _one_site_a_contour(model: CpModel, problem: Problem, v: Variables) -> None:
    """Every contour is cut by exactly one of its sites."""
    for i in range(problem.n):
        model.add_exactly_one(v.pick[s] for s in problem.sites(i))


def _one_round_trip(model: CpModel, v: Variables) -> None:
    """The route leads from home once through every contour and back.

    Over contours rather than sites: smaller, and its subtour cuts are stronger, since no contour is left out.
    """
    model.add_circuit([(i, j, literal) for (i, j), literal in v.follow.items()])


def _travel_joins_contours(model: CpModel, arcs: Arcs, v: Variables) -> None:
    """If j follows i, the torch travels along exactly one arc from i to j."""
    for (i, j), a, b in zip(arcs.groups.tolist(), arcs.first[:-1].tolist(), arcs.first[1:].tolist(), strict=True):
        if b > a + 1:
            model.add_exactly_one([v.follow[i, j].negated(), *v.travel[a:b]])


def _travel_joins_picked_sites(model: CpModel, problem: Problem, arcs: Arcs, v: Variables) -> None:
    """The torch comes to every picked site once and leaves it once; to others it does not come."""
    for ends in (arcs.tail, arcs.head):
        by_site = np.argsort(ends, kind="stable")
        starts = np.searchsorted(ends[by_site], np.arange(problem.m + 1)).tolist()
        for s in range(problem.m):
            here = by_site[starts[s] : starts[s + 1]].tolist()
            model.add_exactly_one([v.pick[s].negated(), *(v.travel[a] for a in here)])


def _positions_follow_the_route(model: CpModel, problem: Problem, v: Variables) -> None:
    """Contours that follow each other have positions that do."""
    for (i, j), literal in v.follow.items():
        if i == problem.n:
            model.add(v.position[j] == 0).only_enforce_if(literal)
        elif j == problem.n:
            model.add(v.position[i] == problem.n - 1).only_enforce_if(literal)
        else:
            model.add(v.position[j] == v.position[i] + 1).only_enforce_if(literal)


def _positions_differ(model: CpModel, v: Variables) -> None:
    """No two contours have the same position (implied by the route)."""
    model.add_all_different(v.position)


def _orders_hold(model: CpModel, problem: Problem, v: Variables) -> None:
    """What must come before comes before; orders that others imply are left out."""
    steps = problem.before.astype(np.float32)
    for i, j in np.argwhere(problem.before & ~((steps @ steps) > 0)).tolist():
        model.add(v.position[i] < v.position[j])


def _blocks_stay_together(model: CpModel, problem: Problem, v: Variables) -> None:
    """Within a contiguous block the route takes one step less than there are contours."""
    for block, size in zip(*np.unique(problem.block, return_counts=True), strict=True):
        if size > 1:
            model.add(LinearExpr.sum(inner(v, np.flatnonzero(problem.block == block).tolist())) == int(size) - 1)


def inner(v: Variables, members: Sequence[int]) -> list[LiteralT]:
    """Literals of the steps from one member to another."""
    return [v.follow[i, j] for i in members for j in members if (i, j) in v.follow]


def _order_literals_agree_with_positions(model: CpModel, v: Variables) -> None:
    """i is before j exactly if its position is lower."""
    for (i, j), literal in v.order.items():
        model.add(v.position[i] < v.position[j]).only_enforce_if(literal)
        if (i, j) in v.follow:
            model.add_implication(v.follow[i, j], literal)


def _conditions_are_met(model: CpModel, problem: Problem, v: Variables) -> None:
    """When a contour is cut (by the site given), enough of its members are already out, or the penalty is due."""
    for k, condition in enumerate(problem.conditions):
        if condition.cost is not None and k not in v.broken:
            continue
        given = [] if condition.when is None else [v.pick[condition.when]]
        excused = [v.broken[k].negated()] if k in v.broken else []
        literals = [v.before(member, condition.contour) for member in condition.members]
        _at_least(model, literals, condition.weights, condition.bound, [*given, *excused])


def _lags_are_kept(model: CpModel, problem: Problem, v: Variables) -> None:
    """Enough other cuts lie between two contours, less those that are missing at a penalty."""
    for k, lag in enumerate(problem.lags):
        if lag.cuts == 0 or (lag.weight is not None and k not in v.missing):
            continue
        apart = lag.cuts + 1 - v.missing[k] if k in v.missing else lag.cuts + 1
        for i, j in ((lag.first, lag.second), (lag.second, lag.first)):
            model.add(v.position[j] - v.position[i] >= apart).only_enforce_if(v.before(i, j))
            if k in v.missing and (i, j) in v.follow:
                model.add(v.missing[k] >= lag.cuts).only_enforce_if(v.follow[i, j])


def _general_statements_hold(model: CpModel, problem: Problem, v: Variables) -> None:
    """Statements over any literals hold (when the candidate given is used), or the penalty is due."""
    for k, statement in enumerate(problem.general):
        given = [] if statement.when is None else [_picked(problem, v, statement.when)]
        excused = [v.failed[k].negated()] if k in v.failed else []
        literals = [
            v.before(lit.i, lit.j) if isinstance(lit, Before) else _picked(problem, v, lit.c)
            for lit in statement.literals
        ]
        _at_least(model, literals, statement.weights, statement.bound, [*given, *excused])


def _moves_over_parts_are_paid_for(model: CpModel, problem: Problem, arcs: Arcs, v: Variables) -> None:
    """A move over a part that is out by then costs, or is not made."""
    rows, m = problem.crossings, problem.m
    move = {leg: v.travel[a] for a, leg in enumerate(zip(arcs.tail.tolist(), arcs.head.tolist(), strict=True))}
    undecided = set(open_crossings(problem, arcs))
    for k, (leave, reach, over) in enumerate(
        zip(rows.leave.tolist(), rows.reach.tolist(), rows.over.tolist(), strict=True)
    ):
        if (leave, reach) not in move:
            continue
        taken = move[leave, reach]
        if k in undecided:
            is_out = v.before(over, int(problem.site_contour[leave]))
            price = [v.over[k]] if k in v.over else []
            model.add_bool_or([~taken, ~is_out, *price])
        elif rows.cost[k] == FORBIDDEN and is_out_by(problem, over, leave, reach, m):
            model.add(taken == 0)


def is_out_by(problem: Problem, over: int, leave: int, reach: int, m: int) -> bool:
    """Whether the hard orders alone put contour `over` out before the move from site `leave` to site `reach`."""
    if leave == m:
        return False
    contour = int(problem.site_contour[leave])
    return reach == m or over == contour or bool(problem.before[over, contour])


def _the_clock_runs_along_the_route(model: CpModel, problem: Problem, arcs: Arcs, v: Variables) -> None:
    """The next cut begins when this one and the move to it are done."""
    if not v.begin:
        return
    takes = problem.pace.cut_ms.tolist()
    for a, (tail, head, ms) in enumerate(
        zip(arcs.tail.tolist(), arcs.head.tolist(), arc_ms(problem, arcs).tolist(), strict=True)
    ):
        if head == problem.m:
            continue
        begin = v.begin[int(problem.site_contour[head])]
        if tail == problem.m:
            model.add(begin == ms).only_enforce_if(v.travel[a])
        else:
            earlier = v.begin[int(problem.site_contour[tail])]
            model.add(begin == earlier + takes[tail] + ms).only_enforce_if(v.travel[a])


def _cooling_takes_its_time(model: CpModel, problem: Problem, v: Variables) -> None:
    """Enough seconds lie between two cuts, less those that are missing at a penalty."""
    for k, lag in enumerate(problem.lags):
        if lag.seconds <= 0:
            continue
        short = v.late.get(k, 0)
        for i, j in ((lag.first, lag.second), (lag.second, lag.first)):
            sites = list(problem.sites(i))
            takes = LinearExpr.weighted_sum([v.pick[s] for s in sites], problem.pace.cut_ms[sites].tolist())
            waited = v.begin[j] - v.begin[i] - takes
            model.add(waited >= round(lag.seconds * 1000) - short).only_enforce_if(v.before(i, j))


def _picked(problem: Problem, v: Variables, candidate: int) -> LiteralT:
    site = int(problem.candidate_site[candidate])
    return False if site < 0 else v.pick[site]


def _at_least(
    model: CpModel, literals: Sequence[LiteralT], weights: Sequence[int], bound: int, given: Sequence[LiteralT]
) -> None:
    """The weighted sum of the literals reaches the bound whenever all of `given` are true."""
    model.add(LinearExpr.weighted_sum(literals, weights) >= bound).only_enforce_if(*given)
