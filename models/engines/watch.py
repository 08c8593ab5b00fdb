"""When to stop: the clock, a gap that is small enough, no improvement for long enough, or the listener says so."""

from __future__ import annotations

from collections.abc import Callable

from kerfwise.models.kernels import running_s

from .solution import Progress, SolveOptions


class Watch:
    """Passes the engines' progress on, and says stop where the options do.

    Parameters
    ----------
    options
        `time_s`, `gap` and `no_improvement_s` are looked at; the rest is the engines' own.
    progress
        Who listens.
    clock
        Seconds, for tests.

    Examples
    --------
    >>> watch = Watch(SolveOptions(gap=0.1))
    >>> watch("search", 100, None), watch("ideals", 100, 89), watch("ideals", 100, 90)
    (True, True, False)
    """

    def __init__(
        self,
        options: SolveOptions,
        progress: Progress | None = None,
        clock: Callable[[], float] = running_s,
    ) -> None:
        self._options, self._progress, self._clock = options, progress, clock
        self._started = self._improved = clock()
        self._cost: int | None = None
        self._preview_cost: int | None = None
        self._bound = 0
        self.stopped = False

    @property
    def seconds(self) -> float:
        """Wall-clock time since the start, without that in which kernels were compiled."""
        return self._clock() - self._started

    def begin(self) -> None:
        """Forget costs and bounds: another problem (the same with more statements) is solved from now on."""
        self._cost, self._preview_cost, self._bound, self._improved = None, None, 0, self._clock()

    def __call__(self, engine: str, cost_um: int | None, bound_um: int | None) -> bool:
        """Note what an engine has reached, tell the listener the best of it all, and say whether to go on."""
        if cost_um is not None and (self._cost is None or cost_um < self._cost):
            self._cost, self._improved = cost_um, self._clock()
        self._bound = max(self._bound, bound_um or 0)
        heard = self._tell(engine)
        self.stopped = self.stopped or not heard or self._late() or self._enough()
        return not self.stopped

    def preview(self, engine: str, cost_um: int | None, bound_um: int | None) -> bool:
        """Tell the listener of a plan that nobody goes on from: it counts for no gap, and as no improvement."""
        if cost_um is not None and (self._preview_cost is None or cost_um < self._preview_cost):
            self._preview_cost = cost_um
        self.stopped = self.stopped or not self._tell(engine)
        return not self.stopped

    def _tell(self, engine: str) -> bool:
        """Tell the listener the best of all that was reached; whether to go on."""
        best = min((cost for cost in (self._cost, self._preview_cost) if cost is not None), default=None)
        return self._progress is None or self._progress(engine, best, self._bound or None)

    def overhear(self, bound_um: int | None) -> None:
        """Note a bound from another thread: it is passed on with whatever is told next."""
        self._bound = max(self._bound, bound_um or 0)

    def _late(self) -> bool:
        return self._options.time_s is not None and self.seconds >= self._options.time_s

    def _enough(self) -> bool:
        if self._cost is None:
            return False
        idle_s = self._options.no_improvement_s
        if idle_s is not None and self._clock() - self._improved >= idle_s:
            return True
        gap = self._options.gap
        return gap is not None and self._cost - self._bound <= gap * self._cost
