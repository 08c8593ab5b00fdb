"""What a job may spend: work, which is the same each time, and seconds by the clock."""

from __future__ import annotations

import math
from collections.abc import Callable

from kerfwise.models.kernels import running_s

from .solution import SolveOptions


class Budget:
    """So much work, and so many seconds from now on; what is spent first counts.

    Parameters
    ----------
    work
        Deterministic seconds.
    time_s
        Wall-clock limit, s; without one the clock does not count.
    per_s
        Operations that are a deterministic second; work is spent in operations.
    clock
        Seconds, for tests.

    Examples
    --------
    >>> budget = Budget(work=2.0)
    >>> budget.spend(1.5)
    >>> budget.left, budget.part(0.5).left, budget.share_spent
    (0.5, 0.25, 0.75)
    """

    def __init__(
        self,
        work: float = math.inf,
        time_s: float | None = None,
        per_s: float = 1.0,
        clock: Callable[[], float] = running_s,
    ) -> None:
        self.per_s, self.operations, self._time_s, self._clock = per_s, work * per_s, time_s, clock
        self.operations_spent = 0.0
        self._began_s = clock()

    @staticmethod
    def of(options: SolveOptions) -> Budget:
        """As much as a solve under these options may spend: the work, or the time if that is limited."""
        return Budget(options.work if options.time_s is None else math.inf, options.time_s)

    @property
    def timed(self) -> bool:
        """Whether the clock counts."""
        return self._time_s is not None

    @property
    def spent(self) -> float:
        """Deterministic seconds so far."""
        return self.operations_spent / self.per_s

    @property
    def left(self) -> float:
        """Deterministic seconds, or seconds by the clock if they are fewer; not above 0 when all is spent."""
        return min((self.operations - self.operations_spent) / self.per_s, self._left_s)

    @property
    def share_spent(self) -> float:
        """Share of the work, or of the time if that is more."""
        share = self.operations_spent / max(self.operations, 1e-9)
        return share if self._time_s is None else max(share, self._passed_s / max(self._time_s, 1e-3))

    def spend(self, operations: float) -> None:
        """Count work; the clock counts by itself."""
        self.operations_spent += operations

    def part(self, share: float) -> Budget:
        """A share of what is left. What is spent of it by work is to be spent of this one as well."""
        time_s = self._left_s * share if self.timed else None
        return Budget((self.operations - self.operations_spent) / self.per_s * share, time_s, self.per_s, self._clock)

    def mark(self) -> tuple[float, float]:
        """Where it stands, for `times`."""
        return self.operations_spent, self._passed_s

    def times(self, mark: tuple[float, float]) -> float:
        """How many times what was spent since `mark` can be spent once more."""
        operations = self.operations_spent - mark[0]
        times = (self.operations - self.operations_spent) / max(operations, 1)
        return min(times, self._left_s / max(self._passed_s - mark[1], 1e-3)) if self.timed else times

    @property
    def _passed_s(self) -> float:
        return self._clock() - self._began_s

    @property
    def _left_s(self) -> float:
        return math.inf if self._time_s is None else self._time_s - self._passed_s
