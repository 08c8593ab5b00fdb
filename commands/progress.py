"""Progress on a terminal, silence in a pipe, and Ctrl-C that keeps the best plan so far."""

from __future__ import annotations

import signal
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from kerfwise.models.problem.microns import UM_PER_MM


class ProgressLine:
    """Listens to the engines; answers False once the user has pressed Ctrl-C."""

    def __init__(self) -> None:
        self.interrupted = False
        self.started = time.monotonic()
        self.status = None
        if sys.stderr.isatty():
            from rich.console import Console

            self.status = Console(stderr=True).status("starting")

    def __call__(self, engine: str, cost_um: int | None, bound_um: int | None) -> bool:
        if self.status is not None:
            self.status.update(self._line(engine, cost_um, bound_um))
        return not self.interrupted

    def _line(self, engine: str, cost_um: int | None, bound_um: int | None) -> str:
        line = f"{time.monotonic() - self.started:5.1f} s  {engine}"
        if cost_um is not None:
            line += f"  incumbent {cost_um / UM_PER_MM / 1000:.3f} m"
        if bound_um:
            line += f"  bound {bound_um / UM_PER_MM / 1000:.3f} m"
        return line + "  (Ctrl-C keeps the best so far)"

    def stop(self, signum: int, frame: FrameType | None) -> None:
        """The first Ctrl-C asks the engines to stop; a second one aborts."""
        if self.interrupted:
            raise KeyboardInterrupt
        self.interrupted = True


@contextmanager
def listening() -> Iterator[ProgressLine]:
    """The progress of a solve, while it runs."""
    line = ProgressLine()
    before = signal.signal(signal.SIGINT, line.stop)
    try:
        if line.status is not None:
            with line.status:
                yield line
        else:
            yield line
    finally:
        signal.signal(signal.SIGINT, before)
