"""Whether contours can be cut at the positions that locks give them: asked of all orders that are known, at once.

A small model of its own: every run of contours that are cut in one go is an interval of the order, and no two overlap.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ortools.sat.python.cp_model import INFEASIBLE, CpModel, CpSolver

WORK = 5.0
"""CP-SAT's deterministic seconds; where they do not show that there is no room, there counts as being some."""


def no_room(
    names: Sequence[str],
    runs: Sequence[Sequence[str]],
    orders: Sequence[tuple[str, str]],
    at: Mapping[str, int],
) -> bool:
    """Whether no order of the names keeps the runs together, all orders (before, after), and the positions from 1 on.

    Examples
    --------
    >>> no_room("abc", (), [("a", "c"), ("b", "c")], {"c": 2}), no_room("abc", (), [("a", "c")], {"c": 2})
    (True, False)
    """
    run_of = {name: (name,) for name in names} | {name: tuple(run) for run in runs for name in run}
    model = CpModel()
    begin = {run: model.new_int_var(1, len(names) + 1 - len(run), "") for run in dict.fromkeys(run_of.values())}
    model.add_no_overlap(model.new_fixed_size_interval_var(first, len(run), "") for run, first in begin.items())
    place = {}
    for run, first in begin.items():
        within = {name: model.new_int_var(0, len(run) - 1, "") for name in run}
        model.add_all_different(within.values())
        for name, offset in within.items():
            place[name] = first + offset
    for before, after in orders:
        model.add(place[before] < place[after])
        one, other = run_of[before], run_of[after]
        if one != other:
            model.add(begin[one] + len(one) <= begin[other])
    for name, position in at.items():
        model.add(place[name] == position)
    solver = CpSolver()
    solver.parameters.num_workers = 1
    solver.parameters.random_seed = 1
    solver.parameters.max_deterministic_time = WORK
    return bool(solver.solve(model) == INFEASIBLE)
