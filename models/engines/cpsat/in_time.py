"""Whether CP-SAT may go on: its arcs, prices and model take seconds on large nests before it runs at all."""

from __future__ import annotations

from collections.abc import Callable

from kerfwise.models.engines.solution import Progress
from kerfwise.models.kernels import running_s

GoOn = Callable[[], None]
"""Asked again and again by what takes long; raises `Stopped` where it may not go on."""


class Stopped(Exception):
    """There is no time left for what was begun, or somebody said stop."""


def always() -> None:
    """There is no limit."""


def until(progress: Progress | None, deadline: float | None) -> Progress:
    """Asks `progress`, and says stop from the deadline on, a moment by `running_s`."""

    def going(engine: str, cost_um: int | None, bound_um: int | None) -> bool:
        heard = progress is None or progress(engine, cost_um, bound_um)
        return heard and (deadline is None or running_s() < deadline)

    return going


def asked(engine: str, progress: Progress, cost_um: int | None, bound_um: int) -> GoOn:
    """Asks `progress` with what is known already."""

    def go_on() -> None:
        if not progress(engine, cost_um, bound_um):
            raise Stopped

    return go_on
