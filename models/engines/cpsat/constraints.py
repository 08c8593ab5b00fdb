"""What must hold of a plan, one family a function."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Sequence
from typing import assert_never

import numpy as np
from ortools.sat.python.cp_model import CpModel, IntVar, LinearExpr, LinearExprT, LiteralT

from kerfwise.models.problem.problem import Problem
from kerfwise.rules.statements import Before, Enough, Literal, Pick, Steps

from .variables import (
    ArcLiterals,
    GoOn,
    Variables,
    always,
    cuts_ms,
    distances,
    in_domain,
    moves_ms,
    windows,
    windows_of_steps,
)


def add_constraints(model: CpModel, problem: Problem, arcs: ArcLiterals, v: Variables, go_on: GoOn = always) -> None:
    """Everything that is hard, and what ties soft statements to their penalties; `go_on` is asked before each."""
    families: tuple[Callable[[], None], ...] = (
        lambda: _one_site_a_contour(model, problem, v),
        lambda: _one_round_trip(model, v),
        lambda: _travel_joins_contours(model, arcs, v),
        lambda: _travel_joins_picked_sites(model, problem, arcs, v),
        lambda: _positions_follow_the_route(model, problem, v),
        lambda: _positions_leave_room(model, problem, v),
        lambda: _orders_hold(model, problem, v),
        lambda: _blocks_stay_together(model, problem, v),
        lambda: _order_literals_agree_with_positions(model, v),
        lambda: _conditions_are_met(model, problem, v),
        lambda: _lags_are_kept(model, problem, v),
        lambda: _general_statements_hold(model, problem, v),
        lambda: _moves_over_parts_are_paid_for(model, v),
        lambda: _the_clock_runs_along_the_route(model, problem, arcs, v),
        lambda: _cooling_takes_its_time(model, problem, v),
    )
    for add_family in families:
        go_on()
        add_family()


def _one_site_a_contour(model: CpModel, problem: Problem, v: Variables) -> None:
    """Every contour is cut by exactly one of its sites."""
    for i in range(problem.n):
        model.add_exactly_one(v.pick[s] for s in problem.sites(i))


def _one_round_trip(model: CpModel, v: Variables) -> None:
    """The route leads from home once through every contour and back.

    Over contours rather than sites: smaller, and its subtour cuts are stronger, since no contour is left out.
    """
    model.add_circuit([(i, j, literal) for (i, j), literal in v.follow.items()])


def _travel_joins_contours(model: CpModel, arcs: ArcLiterals, v: Variables) -> None:
    """If j follows i, the torch travels along exactly one arc from i to j."""
    for i, j, span in arcs.spans():
        if span.stop > span.start + 1:
            model.add_exactly_one([v.follow[i, j].negated(), *v.travel[span]])


def _travel_joins_picked_sites(model: CpModel, problem: Problem, arcs: ArcLiterals, v: Variables) -> None:
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


def _positions_leave_room(model: CpModel, problem: Problem, v: Variables) -> None:
    """What must come before i or j, if j follows i, comes before both (implied; it tightens the linear programs)."""
    n = problem.n
    first, last = windows(problem)
    first_if, last_if = windows_of_steps(problem)
    bounds: dict[tuple[int, int, int], list[tuple[IntVar, int]]] = defaultdict(list)
    for (i, j), literal in v.follow.items():
        if i == n:
            bounds[j, -1, 1].append((literal, int(last[j])))
        elif j == n:
            bounds[i, 1, 0].append((literal, int(n - 1 - first[i])))
        else:
            bounds[i, 1, 0].append((literal, int(first_if[i, j] - first[i])))
            bounds[j, 1, 1].append((literal, int(first_if[i, j] + 1 - first[j])))
            bounds[i, -1, 0].append((literal, int(last[i] - last_if[i, j] + 1)))
            bounds[j, -1, 1].append((literal, int(last[j] - last_if[i, j])))
    for (i, sign, _), terms in bounds.items():
        tighter = [(literal, by) for literal, by in terms if by > 0]
        if tighter:
            moved = LinearExpr.weighted_sum([literal for literal, _ in tighter], [by for _, by in tighter])
            model.add(sign * v.position[i] >= sign * int(first[i] if sign > 0 else last[i]) + moved)


def _orders_hold(model: CpModel, problem: Problem, v: Variables) -> None:
    """What must come before comes before, with room for what must lie between."""
    first, last = windows(problem)
    apart = distances(problem)
    open_yet = (apart > 0) & (first[None, :] - last[:, None] < apart)
    for i, j in np.argwhere(open_yet).tolist():
        if apart[i, j] != 2:  # one between them: the two steps say as much
            model.add(v.position[j] >= v.position[i] + int(apart[i, j]))


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
        premise = [] if condition.when is None else [v.pick[condition.when]]
        excused = [v.broken[k].negated()] if k in v.broken else []
        literals = [v.before(member, condition.contour) for member in condition.members]
        _at_least(model, literals, condition.weights, condition.bound, [*premise, *excused])


def _lags_are_kept(model: CpModel, problem: Problem, v: Variables) -> None:
    """Enough other cuts lie between two contours, less those that are missing at a penalty.

    Two contours that follow each other lack them all; for one cut that says it all, and if hard there is no such step.
    """
    for k, lag in enumerate(problem.lags):
        pair = (lag.first, lag.second)
        if k in v.missing:
            model.add(v.missing[k] >= lag.cuts * LinearExpr.sum(inner(v, pair)))
        if lag.cuts > 1:
            apart = lag.cuts + 1 - v.missing.get(k, 0)
            for i, j in (pair, pair[::-1]):
                model.add(v.position[j] - v.position[i] >= apart).only_enforce_if(v.before(i, j))


def _general_statements_hold(model: CpModel, problem: Problem, v: Variables) -> None:
    """Statements over any literals hold (when the candidate given is used), or the penalty is due."""
    known: dict[int, LiteralT] = {}
    for k, statement in enumerate(problem.general):
        premise = [] if statement.when is None else [_picked(problem, v, statement.when)]
        excused = [v.failed[k].negated()] if k in v.failed else []
        literals = [_literal(model, problem, v, lit, known) for lit in statement.literals]
        _at_least(model, literals, statement.weights, statement.bound, [*premise, *excused])


def _moves_over_parts_are_paid_for(model: CpModel, v: Variables) -> None:
    """A move over a part that is out before it costs, or is not made."""
    for k, crossing in enumerate(v.crossings):
        is_out = v.before(crossing.over, crossing.leave)
        moves = [v.travel[a] for a in crossing.arcs]
        if k in v.over:
            model.add(LinearExpr.sum([*moves, is_out]) <= 1 + v.over[k])
        else:
            model.add_at_most_one([*moves, is_out])


def _the_clock_runs_along_the_route(model: CpModel, problem: Problem, arcs: ArcLiterals, v: Variables) -> None:
    """The next cut begins when this one and the move to it are done."""
    if not v.begin:
        return
    moves = moves_ms(problem, arcs).tolist()
    for i, j, span in arcs.spans():
        if j == problem.n:
            continue
        done = [] if i == problem.n else [v.begin[i], _cut_ms(problem, v, i)]
        moving = LinearExpr.weighted_sum(v.travel[span], moves[span])
        model.add(v.begin[j] == LinearExpr.sum([*done, moving])).only_enforce_if(v.follow[i, j])


def _cooling_takes_its_time(model: CpModel, problem: Problem, v: Variables) -> None:
    """Enough seconds lie between two cuts, less those that are missing at a penalty."""
    for k, lag in enumerate(problem.lags):
        if lag.seconds > 0:
            wait = round(lag.seconds * 1000) - v.late.get(k, 0)
            for i, j in ((lag.first, lag.second), (lag.second, lag.first)):
                cooled = LinearExpr.sum([v.begin[i], _cut_ms(problem, v, i), wait])
                model.add(v.begin[j] >= cooled).only_enforce_if(v.before(i, j))


def _cut_ms(problem: Problem, v: Variables, contour: int) -> LinearExprT:
    """Time of the cut of a contour, by the site that is picked and the link that leads to it."""
    sites = problem.sites(contour)
    span = slice(sites.start, sites.stop)
    cut = LinearExpr.weighted_sum(v.pick[span], cuts_ms(problem)[span].tolist())
    linked = v.linked[contour]
    return cut + LinearExpr.weighted_sum([v.travel[a] for a, _ in linked], [ms for _, ms in linked]) if linked else cut


def _literal(model: CpModel, problem: Problem, v: Variables, literal: Literal, known: dict[int, LiteralT]) -> LiteralT:
    """The literal of an order or a pick; of a condition in another a variable that holds if and only if that does.

    What such conditions are `known` by, by their `id`: several statements may have one in common.
    """
    match literal:
        case Before(i, j):
            return v.before(i, j)
        case Steps(i, j, 1, 1):
            return v.follow.get((i, j), False)
        case Steps(i, j, least, most):
            return in_domain(model, v.position[j] - v.position[i], least, most)
        case Pick(c):
            return _picked(problem, v, c)
        case Enough(within, weights, bound):
            if id(literal) not in known:
                holds = known[id(literal)] = model.new_bool_var("")
                total = LinearExpr.weighted_sum([_literal(model, problem, v, lit, known) for lit in within], weights)
                model.add(total >= bound).only_enforce_if(holds)
                model.add(total < bound).only_enforce_if(holds.negated())
            return known[id(literal)]
        case _:
            assert_never(literal)


def _picked(problem: Problem, v: Variables, candidate: int) -> LiteralT:
    site = int(problem.candidate_site[candidate])
    return False if site < 0 else v.pick[site]


def _at_least(
    model: CpModel, literals: Sequence[LiteralT], weights: Sequence[int], bound: int, premise: Sequence[LiteralT]
) -> None:
    """The weighted sum of the literals reaches the bound whenever all of `premise` are true."""
    model.add(LinearExpr.weighted_sum(literals, weights) >= bound).only_enforce_if(*premise)
