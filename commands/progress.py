"""Progress on a terminal, silence in a pipe, and Ctrl-C that keeps the best plan so far."""

from __future__ import annotations

import sys
import time
from types import TracebackType
from typing import Self

from kerfwise.encoder.geometry.tolerances import UM_PER_MM
from kerfwise.jobs.progress import Listener


class ProgressLine(Listener):
    """Listens to the engines and shows what they have reached; answers False once the user has pressed Ctrl-C."""

    def __init__(self) -> None:
        super().__init__()
        self.status = None
        if sys.stderr.isatty():
            from rich.console import Console

            from .terminal import bare

            self.status = Console(file=bare(sys.stderr)).status("starting")

    def __call__(self, engine: str, cost_um: int | None, bound_um: int | None) -> bool:
        if self.status is not None:
            self.status.update(self._line(engine, cost_um, bound_um))
        return super().__call__(engine, cost_um, bound_um)

    def __enter__(self) -> Self:
        super().__enter__()
        if self.status is not None:
            self.status.__enter__()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self.status is not None:
            self.status.__exit__(kind, error, trace)
        super().__exit__(kind, error, trace)

    def _line(self, engine: str, cost_um: int | None, bound_um: int | None) -> str:
        line = f"{time.monotonic() - self.started:5.1f} s  {engine}"
        if cost_um is not None:
            line += f"  incumbent {cost_um / UM_PER_MM / 1000:.3f} m"
        if bound_um:
            line += f"  bound {bound_um / UM_PER_MM / 1000:.3f} m"
        return line + "  (Ctrl-C keeps the best so far)"
