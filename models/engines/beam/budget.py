"""What a beam may spend: operations, seconds, and as long as the listener lets it."""

from __future__ import annotations

import time

from kerfwise.models.engines.solution import Incumbent, Progress

OPERATIONS_PER_S = 3e8


class Empty(Exception):
    """A limit is reached."""


class Budget:
    """Counts operations against `work`, seconds against `time_s`."""

    def __init__(self, work: float, time_s: float | None, progress: Progress | None) -> None:
        self._most, self._time_s, self._progress = work * OPERATIONS_PER_S, time_s, progress
        self._operations = 0
        self._began_s = time.monotonic()

    @property
    def spent(self) -> float:
        """Deterministic seconds so far."""
        return self._operations / OPERATIONS_PER_S

    @property
    def share_spent(self) -> float:
        """Share of the work, or of the time if that is more."""
        share = self._operations / max(self._most, 1)
        return share if self._time_s is None else max(share, self._passed_s / max(self._time_s, 1e-3))

    def left(self, share: float) -> float:
        """Operations that are a share of what is left."""
        return share * max(0.0, 1.0 - self.share_spent) * self._most

    def pay(self, operations: int, incumbent: Incumbent | None = None, bound: int | None = None) -> None:
        """Count, tell the listener, and raise `Empty` at a limit."""
        self._operations += operations
        cost = None if incumbent is None else incumbent.cost
        heard = self._progress is None or self._progress("beam", cost, bound)
        if not heard or self.share_spent >= 1.0:
            raise Empty

    def mark(self) -> tuple[int, float]:
        """Where it stands, for `times`."""
        return self._operations, self._passed_s

    def times(self, mark: tuple[int, float]) -> float:
        """How many times what was spent since `mark` can be spent once more."""
        operations = self._operations - mark[0]
        times = (self._most - self._operations) / max(operations, 1)
        if self._time_s is not None:
            times = min(times, (self._time_s - self._passed_s) / max(self._passed_s - mark[1], 1e-3))
        return times

    @property
    def _passed_s(self) -> float:
        return time.monotonic() - self._began_s
