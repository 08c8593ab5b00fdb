"""What the look for contradictions may spend in all: seconds by the clock, or work that is the same each time."""

from __future__ import annotations

import time
from collections.abc import Callable

from ortools.sat.python.cp_model import CpSolver

from kerfwise.models.engines.solution import SolveOptions

WORK_PER_STATEMENT = 2e-5
"""What putting a statement to CP-SAT counts for, beside the work of CP-SAT itself."""


class NotAnswered(Exception):
    """The question was too hard for the work allowed."""


class Purse:
    """So much work, or with `time_s` so many seconds from now on, whatever the work.

    Examples
    --------
    >>> purse = Purse(work=2.0)
    >>> purse.spend(1.5)
    >>> purse.left, purse.part(0.5).left
    (0.5, 0.25)
    """

    def __init__(
        self, work: float = 200.0, time_s: float | None = None, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._work, self._clock = work, clock
        self._until_s = None if time_s is None else clock() + time_s

    @staticmethod
    def of(options: SolveOptions) -> Purse:
        """As much as a solve under these options may spend."""
        return Purse(options.work, options.time_s)

    @property
    def left(self) -> float:
        """Work or seconds; not above 0 when all is spent."""
        return self._work if self._until_s is None else self._until_s - self._clock()

    @property
    def timed(self) -> bool:
        """Whether the clock counts."""
        return self._until_s is not None

    def part(self, share: float) -> Purse:
        """A purse with a share of what is left. What is spent of it by work is to be spent of this one as well."""
        return Purse(self.left * share, self.left * share if self.timed else None, self._clock)

    def spend(self, work: float) -> None:
        """Count work; the clock counts by itself."""
        self._work -= work

    def solver(self, most: float) -> CpSolver:
        """A solver that stops when `most` work, or what is left, is done.

        Raises
        ------
        NotAnswered
            If nothing is left.
        """
        if self.left <= 0:
            raise NotAnswered
        solver = quiet_solver(most)
        if self.timed:
            solver.parameters.max_time_in_seconds = self.left
        else:
            solver.parameters.max_deterministic_time = min(most, self.left)
        return solver


def quiet_solver(work: float) -> CpSolver:
    """One thread, a fixed seed and a limit in deterministic time, so that the same question has the same answer."""
    solver = CpSolver()
    solver.parameters.num_workers = 1
    solver.parameters.random_seed = 1
    solver.parameters.max_deterministic_time = work
    return solver
