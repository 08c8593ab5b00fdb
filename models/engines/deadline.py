"""How long something may go on, in one object that is handed down: work, seconds, memory, and who may say stop."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from kerfwise.models.jit import running_s

from .solution import TABLE_BYTES, SolveOptions


class Progress(Protocol):
    """Called now and then by an engine; returns False to ask it to stop with what it has."""

    def __call__(self, engine: str, cost_um: int | None, bound_um: int | None) -> bool: ...


@dataclass(frozen=True, slots=True)
class Enough:
    """What is reached is enough where the bound is within a share of the cost, or no better plan came for so long."""

    gap: float | None = None
    no_improvement_s: float | None = None

    def reached(self, cost: int, bound: int, waited_s: float) -> bool:
        """Whether such a cost is, with a bound, after so many seconds without a better one."""
        if self.no_improvement_s is not None and waited_s >= self.no_improvement_s:
            return True
        return self.gap is not None and cost - bound <= self.gap * cost


class Deadline:
    """So much work, so many seconds from now on, so many bytes, and a listener who may say stop before.

    Engines tell it what they have reached and ask whether to go on: it is a `Progress`. A part of it, made by `within`
    and the like, tells the whole, so that whatever ends the whole ends the part. Work that a part spends is the part's
    alone; who made it says what of it the whole has spent.

    Parameters
    ----------
    work
        Deterministic seconds.
    time_s
        Seconds by the clock; without them the clock does not count.
    listener
        Told the best cost and bound so far; ends it with False.
    enough
        What is taken before the end.
    most_bytes
        What tables may take.
    per_s
        Operations that are a deterministic second; work is spent in operations.
    timed
        Whether parts of it that are made by `within` have seconds although it has none of its own.
    clock
        Seconds, for tests.

    Examples
    --------
    >>> deadline = Deadline(2.0)
    >>> deadline.spend(1.5)
    >>> deadline.left, deadline.part(0.5).left
    (0.5, 0.25)

    >>> deadline = Deadline(enough=Enough(gap=0.1))
    >>> deadline("search", 100, None), deadline("ideals", 100, 89), deadline("ideals", 100, 90)
    (True, True, False)
    """

    def __init__(
        self,
        work: float = math.inf,
        time_s: float | None = None,
        listener: Progress | None = None,
        *,
        enough: Enough | None = None,
        most_bytes: float = TABLE_BYTES,
        per_s: float = 1.0,
        timed: bool = False,
        clock: Callable[[], float] = running_s,
    ) -> None:
        self.work, self.time_s, self.most_bytes, self.per_s = work, time_s, most_bytes, per_s
        self.operations, self.operations_spent = work * per_s, 0.0
        self.engine: str = listener.engine if isinstance(listener, Deadline) else ""
        """Who asks by `go`."""
        self.stopped = False
        """Whether the listener said stop, or what is reached is enough; not whether the time is over."""
        self._listener, self._enough, self.clock = listener, enough or Enough(), clock
        self.timed = timed or time_s is not None
        self._began_s = self._improved_s = clock()
        self._cost: int | None = None
        self._preview_cost: int | None = None
        self._bound = 0

    @staticmethod
    def of(
        options: SolveOptions,
        listener: Progress | None = None,
        most_bytes: float = TABLE_BYTES,
        clock: Callable[[], float] | None = None,
    ) -> Deadline:
        """As much as a solve under these options may spend: the work, or the time if that is limited."""
        return Deadline(
            options.work if options.time_s is None else math.inf,
            options.time_s,
            listener,
            enough=Enough(options.gap, options.no_improvement_s),
            most_bytes=most_bytes,
            clock=clock or (listener.clock if isinstance(listener, Deadline) else running_s),
        )

    # Parts of it.

    def within(self, work: float, most_bytes: float | None = None, listener: Progress | None = None) -> Deadline:
        """So much work, and as many seconds where they count; a `listener` may stand between it and the whole."""
        return self._part(work, work if self.timed else None, most_bytes, 1.0, listener)

    def counting(self, work: float, per_s: float = 1.0, most_bytes: float | None = None) -> Deadline:
        """So much work, in operations of which so many are a second; no seconds but those of the whole."""
        return self._part(work, None, most_bytes, per_s)

    def part(self, share: float) -> Deadline:
        """A share of what is left."""
        time_s = None if self.time_s is None else self.left_s * share
        return self._part((self.operations - self.operations_spent) / self.per_s * share, time_s, None, self.per_s)

    def _part(
        self,
        work: float,
        time_s: float | None,
        most_bytes: float | None,
        per_s: float,
        listener: Progress | None = None,
    ) -> Deadline:
        return Deadline(
            work,
            time_s,
            listener or self,
            most_bytes=self.most_bytes if most_bytes is None else most_bytes,
            per_s=per_s,
            timed=self.timed,
            clock=self.clock,
        )

    # What is spent of it, and what is left.

    @property
    def seconds(self) -> float:
        """Seconds by the clock since it began, without those in which kernels were compiled."""
        return self.clock() - self._began_s

    @property
    def left_s(self) -> float:
        """Seconds by the clock, infinitely many where they do not count."""
        return math.inf if self.time_s is None else self.time_s - self.seconds

    @property
    def spent(self) -> float:
        """Deterministic seconds so far."""
        return self.operations_spent / self.per_s

    @property
    def left(self) -> float:
        """Deterministic seconds, or seconds by the clock if they are fewer; not above 0 when all is spent."""
        return min((self.operations - self.operations_spent) / self.per_s, self.left_s)

    def spend(self, operations: float) -> None:
        """Count work; the clock counts by itself."""
        self.operations_spent += operations

    def mark(self) -> tuple[float, float]:
        """Where it stands, for `times`."""
        return self.operations_spent, self.seconds

    def times(self, mark: tuple[float, float]) -> float:
        """How many times what was spent since `mark` can be spent once more."""
        operations = self.operations_spent - mark[0]
        times = (self.operations - self.operations_spent) / max(operations, 1)
        return times if self.time_s is None else min(times, self.left_s / max(self.seconds - mark[1], 1e-3))

    # What was reached, and whether to go on.

    def __call__(self, engine: str, cost_um: int | None, bound_um: int | None) -> bool:
        """Note what an engine has reached, tell the listener the best of it all, and say whether to go on."""
        if cost_um is not None and (self._cost is None or cost_um < self._cost):
            self._cost, self._improved_s = cost_um, self.clock()
        self.overhear(bound_um)
        heard = self._tell(engine)
        waited_s = self.clock() - self._improved_s
        enough = self._cost is not None and self._enough.reached(self._cost, self._bound, waited_s)
        self.stopped = self.stopped or not heard or enough
        return not self.stopped and self.left_s > 0

    def go(self) -> bool:
        """Whether `engine` may go on, which has reached nothing new."""
        return self(self.engine, None, None)

    def preview(self, engine: str, cost_um: int | None, bound_um: int | None) -> bool:
        """Tell the listener of a plan that nobody goes on from: it counts for no gap, and as no improvement."""
        if cost_um is not None and (self._preview_cost is None or cost_um < self._preview_cost):
            self._preview_cost = cost_um
        self.stopped = self.stopped or not self._tell(engine)
        return not self.stopped

    def overhear(self, bound_um: int | None) -> None:
        """Note a bound from another thread: it is passed on with whatever is told next."""
        self._bound = max(self._bound, bound_um or 0)

    def begin(self) -> None:
        """Forget costs and bounds: another problem (the same with more statements) is solved from now on."""
        self._cost, self._preview_cost, self._bound, self._improved_s = None, None, 0, self.clock()

    def _tell(self, engine: str) -> bool:
        """Tell the listener the best of all that was reached; whether to go on."""
        best = min((cost for cost in (self._cost, self._preview_cost) if cost is not None), default=None)
        return self._listener is None or self._listener(engine, best, self._bound or None)
