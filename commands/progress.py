"""Progress on a terminal, silence in a pipe, and Ctrl-C that keeps the best plan so far."""

from __future__ import annotations

import time

from kerfwise.encoder.geometry.tolerances import UM_PER_MM
from kerfwise.jobs.progress import Listener
from kerfwise.models.jit import counted_s
from kerfwise.postproc.report.legend import counted
from kerfwise.rules.statements import EXEMPTION_MM

from .terminal import status_line


def first_told(seconds: float, first_mm: float, last_mm: float) -> str:
    """When the first plan was there, and how much more it cost than what was found in the end.

    Examples
    --------
    >>> first_told(0.8, 1031.0, 1000.0)
    'first plan after 0.8 s, 3.1 % above what was found in the end'
    >>> first_told(0.8, 2_001_000.0, 1000.0)
    'first plan after 0.8 s, with 2 excuses more than what was found in the end'
    """
    more = round(first_mm // EXEMPTION_MM) - round(last_mm // EXEMPTION_MM)
    if more > 0:
        return f"first plan after {seconds:.1f} s, with {counted(more, 'excuse')} more than what was found in the end"
    above = max(0.0, first_mm - last_mm) / max(last_mm % EXEMPTION_MM, 1.0)
    return f"first plan after {seconds:.1f} s, {100 * above:.1f} % above what was found in the end"


class ProgressLine(Listener):
    """Listens to the engines and shows what they have reached; answers False once the user has pressed Ctrl-C."""

    def __init__(self) -> None:
        super().__init__(shown=status_line("starting"))
        self._first: tuple[float, float] | None = None

    def __call__(self, engine: str, cost_um: int | None, bound_um: int | None) -> bool:
        if self._first is None and cost_um is not None:
            self._first = counted_s(), cost_um / UM_PER_MM
        if self.shown is not None:
            self.shown.update(self._line(engine, cost_um, bound_um))
        return super().__call__(engine, cost_um, bound_um)

    def first_line(self, objective_mm: float, began_s: float) -> str:
        """When the first plan was there since `began_s`, and how far from the last; "" where nobody has watched."""
        if self.shown is None or self._first is None:
            return ""
        return first_told(self._first[0] - began_s, self._first[1], objective_mm)

    def _line(self, engine: str, cost_um: int | None, bound_um: int | None) -> str:
        line = f"{time.monotonic() - self.started:5.1f} s  {engine}"
        if cost_um is not None:
            line += f"  incumbent {cost_um / UM_PER_MM / 1000:.3f} m"
        if bound_um:
            line += f"  bound {bound_um / UM_PER_MM / 1000:.3f} m"
        return line + "  (Ctrl-C keeps the best so far)"
