"""A known route as a complete hint: a value for every variable."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise

from ortools.sat.python.cp_model import CpModel, IntVar

from kerfwise.models.problem.evaluate import general_holds, missing_ms, times_ms
from kerfwise.models.problem.problem import Problem

from .arcs import ArcLiterals
from .crossed import OpenCrossing
from .variables import Variables


def add_hint(model: CpModel, problem: Problem, arcs: ArcLiterals, v: Variables, route: Sequence[int]) -> None:
    """Hint at this route (sites in cutting order)."""
    picked = set(route)
    order = [int(problem.site_contour[s]) for s in route]
    position = {contour: k for k, contour in enumerate(order)}
    tour = set(pairwise([problem.m, *route, problem.m]))
    taken = {a for a, leg in enumerate(zip(arcs.tail.tolist(), arcs.head.tolist(), strict=True)) if leg in tour}
    values = {
        **_values(v.pick, (s in picked for s in range(problem.m))),
        **_values(v.travel, (a in taken for a in range(len(v.travel)))),
        **_values(v.follow.values(), _steps(v, pairwise([problem.n, *order, problem.n]))),
        **_values(v.position, (position[i] for i in range(problem.n))),
        **_values(v.broken.values(), (_unmet(problem, k, order, picked) for k in v.broken)),
        **_values(
            v.failed.values(), (not general_holds(problem, problem.general[k], position, picked) for k in v.failed)
        ),
        **_values(v.missing.values(), (_lacking(problem, k, position) for k in v.missing)),
        **_values(v.over.values(), (_crosses(v.crossings[k], taken, position) for k in v.over)),
    }
    if v.begin:
        times = times_ms(problem, route)
        values |= _values(v.begin, (times[i][0] for i in range(problem.n)))
        values |= _values(v.late.values(), (missing_ms(problem.lags[k], times) for k in v.late))
    for (i, j), literal in v.order.items():
        if isinstance(literal, IntVar):
            values[literal.index] = int(position[i] < position[j])
    hint = model.proto.solution_hint
    hint.vars.extend(values.keys())
    hint.values.extend(values.values())


def _values(variables: Iterable[IntVar], values: Iterable[int]) -> dict[int, int]:
    return {variable.index: int(value) for variable, value in zip(variables, values, strict=True)}


def _steps(v: Variables, taken: Iterable[tuple[int, int]]) -> list[int]:
    on_route = set(taken)
    return [step in on_route for step in v.follow]


def _unmet(problem: Problem, k: int, order: Sequence[int], picked: set[int]) -> bool:
    condition = problem.conditions[k]
    if condition.when is not None and condition.when not in picked:
        return False
    return not condition.met(set(order[: order.index(condition.contour)]))


def _crosses(crossing: OpenCrossing, taken: set[int], position: dict[int, int]) -> bool:
    return position[crossing.over] < position[crossing.leave] and not taken.isdisjoint(crossing.arcs)


def _lacking(problem: Problem, k: int, position: dict[int, int]) -> int:
    lag = problem.lags[k]
    return max(0, lag.cuts + 1 - abs(position[lag.first] - position[lag.second]))
