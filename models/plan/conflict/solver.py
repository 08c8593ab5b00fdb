"""CP-SAT as the look for contradictions asks it: small questions, out of one budget for all of them."""

from __future__ import annotations

from ortools.sat.python.cp_model import CpSolver

from kerfwise.models.engines.budget import Budget

DEFAULT_WORK = 200.0
"""Work for all of them, where nobody says how much."""
WORK_PER_STATEMENT = 2e-5
"""What putting a statement to CP-SAT counts for, beside the work of CP-SAT itself."""


class NotAnswered(Exception):
    """The question was too hard for the work allowed."""


def solver_within(budget: Budget, most: float) -> CpSolver:
    """A solver that stops when `most` work, or what is left, is done.

    Raises
    ------
    NotAnswered
        If nothing is left.
    """
    if budget.left <= 0:
        raise NotAnswered
    solver = quiet_solver(most)
    if budget.timed:
        solver.parameters.max_time_in_seconds = budget.left
    else:
        solver.parameters.max_deterministic_time = min(most, budget.left)
    return solver


def quiet_solver(work: float) -> CpSolver:
    """One thread, a fixed seed and a limit in deterministic time, so that the same question has the same answer."""
    solver = CpSolver()
    solver.parameters.num_workers = 1
    solver.parameters.random_seed = 1
    solver.parameters.catch_sigint_signal = False
    solver.parameters.max_deterministic_time = work
    return solver
