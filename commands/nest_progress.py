"""What nesting shows on a terminal while it looks, and Ctrl-C that keeps the best nests so far."""

from __future__ import annotations

import sys
import time
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

from kerfwise.jobs.nesting.find_nests import Watching

if TYPE_CHECKING:
    from kerfwise.nesting.layout import Layout


class NestProgress(Watching):
    """Told after each round; answers False once the user has pressed Ctrl-C. In a pipe it is silent."""

    def __init__(self) -> None:
        super().__init__()
        self._status: Any = None
        if sys.stderr.isatty():
            from rich.console import Console

            from .terminal import bare

            self._status = Console(file=bare(sys.stderr)).status("laying parts")

    def __call__(self, number: int, best: Layout) -> bool:
        """Show the best so far; whether to go on."""
        if self._status is not None:
            whole = sum(sheet.stock.area_mm2 for sheet in best.sheets)
            used = sum(sheet.metal_mm2(best.wanted) for sheet in best.sheets) / whole if whole else 0.0
            spent = time.monotonic() - self.started
            line = f"{spent:5.1f} s  round {number}  {len(best.sheets)} sheets, {used:.1%} used"
            self._status.update(f"{line}  (Ctrl-C keeps the best so far)")
        return super().__call__(number, best)

    def going(self, doing: str) -> bool:
        """Show what is being done; whether to go on."""
        if self._status is not None:
            self._status.update(f"{time.monotonic() - self.started:5.1f} s  {doing}  (Ctrl-C keeps the best so far)")
        return super().going(doing)

    def __enter__(self) -> Self:
        super().__enter__()
        if self._status is not None:
            self._status.__enter__()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._status is not None:
            self._status.__exit__(kind, error, trace)
        super().__exit__(kind, error, trace)
