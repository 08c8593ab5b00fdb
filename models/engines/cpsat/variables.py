"""The decisions as CP-SAT variables."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from ortools.sat.python.cp_model import CpModel, IntVar, LiteralT

from kerfwise.models.problem.crossings import FORBIDDEN
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.statements import Before, plain

from .arcs import ArcLiterals
from .crossed import OpenCrossing, open_crossings
from .positions import windows
from .times import counts_seconds, linked_ms, longest_ms

Pair = tuple[int, int]


@dataclass(frozen=True, eq=False, slots=True)
class Variables:
    """Variables of one model.

    `pick[s]`: site s is used. `travel[a]`: arc a is on the route. `follow[i, j]`: contour j directly follows i (n is
    the machine's home). `position[i]` counts from 0. `order[i, j]`: contour i is cut before contour j, only for pairs
    that a statement asks about and the hard orders leave open. `broken[k]`: soft condition k is not met; `failed[k]`:
    soft general statement k does not hold; `missing[k]`: the cuts that soft lag k lacks, `late[k]` the milliseconds;
    `over[k]`: crossing k of `crossings`, a soft one, is made. `begin[i]`: when the cut of contour i begins, ms, only
    where a statement counts seconds; then `linked[i]` are the arcs of links to it, and the ms that each makes its cut
    longer.
    """

    problem: Problem
    pick: list[IntVar]
    travel: list[IntVar]
    follow: dict[Pair, IntVar]
    position: list[IntVar]
    order: dict[Pair, LiteralT]
    broken: dict[int, IntVar]
    failed: dict[int, IntVar]
    missing: dict[int, IntVar]
    late: dict[int, IntVar]
    crossings: tuple[OpenCrossing, ...]
    over: dict[int, IntVar]
    begin: list[IntVar]
    linked: list[list[tuple[int, int]]]

    def before(self, i: int, j: int) -> LiteralT:
        """Literal, or constant, that says that contour i is cut before contour j."""
        if i == j or self.problem.before[j, i]:
            return False
        return True if self.problem.before[i, j] else self.order[i, j]


def make_variables(model: CpModel, problem: Problem, arcs: ArcLiterals) -> Variables:
    """All variables of the problem over these arcs."""
    travel = [model.new_bool_var("") for _ in arcs.tail]
    crossings = open_crossings(problem, arcs)
    return Variables(
        problem=problem,
        pick=[model.new_bool_var("") for _ in range(problem.m)],
        travel=travel,
        follow=_follow(model, arcs, travel),
        position=_positions(model, problem),
        order=_orders(model, problem, crossings),
        broken={
            k: model.new_bool_var("") for k, c in enumerate(problem.conditions) if c.cost is not None and c.cost > 0
        },
        failed={k: model.new_bool_var("") for k, s in enumerate(problem.general) if s.weight is not None},
        missing={
            k: model.new_int_var(0, lag.cuts + 1, "")
            for k, lag in enumerate(problem.lags)
            if lag.weight is not None and lag.cuts > 0
        },
        late={
            k: model.new_int_var(0, round(lag.seconds * 1000), "")
            for k, lag in enumerate(problem.lags)
            if lag.weight is not None and lag.seconds > 0
        },
        crossings=crossings,
        over={k: model.new_bool_var("") for k, crossing in enumerate(crossings) if crossing.cost != FORBIDDEN},
        begin=_begins(model, problem, arcs),
        linked=linked_ms(problem, arcs) if counts_seconds(problem) else [],
    )


def _begins(model: CpModel, problem: Problem, arcs: ArcLiterals) -> list[IntVar]:
    """A clock, if a statement counts seconds."""
    if not counts_seconds(problem):
        return []
    longest = longest_ms(problem, arcs)
    return [model.new_int_var(0, longest, "") for _ in range(problem.n)]


def _follow(model: CpModel, arcs: ArcLiterals, travel: list[IntVar]) -> dict[Pair, IntVar]:
    """One literal for every two contours; where a single arc joins them it is that arc's."""
    follow: dict[Pair, IntVar] = {}
    for i, j, span in arcs.spans():
        follow[i, j] = travel[span.start] if span.stop == span.start + 1 else model.new_bool_var("")
    return follow


def _positions(model: CpModel, problem: Problem) -> list[IntVar]:
    """What must come before and after a contour bounds its position."""
    return [model.new_int_var(int(low), int(high), "") for low, high in zip(*windows(problem), strict=True)]


def _orders(model: CpModel, problem: Problem, crossings: Sequence[OpenCrossing]) -> dict[Pair, LiteralT]:
    """One literal for two contours; for all pairs of two blocks it is the same, since blocks are not mixed."""
    literals: dict[Pair, LiteralT] = {}
    order: dict[Pair, LiteralT] = {}
    block = problem.block.tolist()
    for i, j in sorted(set(_asked(problem, crossings))):
        key = (i, j) if block[i] == block[j] else (block[i], block[j])
        if key not in literals:
            literal = model.new_bool_var("")
            literals[key], literals[key[1], key[0]] = literal, literal.negated()
        order[i, j], order[j, i] = literals[key], literals[key[1], key[0]]
    return order


def _asked(problem: Problem, crossings: Sequence[OpenCrossing]) -> Iterator[Pair]:
    """Pairs (the smaller number first) whose order a statement asks about and no hard order decides."""
    pairs: list[Pair] = [(k, c.contour) for c in problem.conditions for k in c.members]
    pairs += [(lag.first, lag.second) for lag in problem.lags if lag.cuts > 1 or lag.seconds > 0]
    pairs += [(crossing.over, crossing.leave) for crossing in crossings]
    pairs += [(lit.i, lit.j) for s in problem.general for lit in plain(s.literals) if isinstance(lit, Before)]
    for i, j in pairs:
        if i != j and not problem.before[i, j] and not problem.before[j, i]:
            yield min(i, j), max(i, j)
