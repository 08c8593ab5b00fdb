"""Who lays the parts: kerfwise itself, and sparrow after it where that is asked for."""

from __future__ import annotations

from dataclasses import replace
from typing import Protocol

from kerfwise.encoder.errors import InputError
from kerfwise.jobs.given import Tell
from kerfwise.nesting import sparrow
from kerfwise.nesting.allot import Layout
from kerfwise.nesting.denser import denser
from kerfwise.nesting.rounds import Effort, layouts
from kerfwise.nesting.shapes import Shapes
from kerfwise.nesting.wanted import Spacing, Wanted

NO_SPYRROW = "the engine sparrow needs spyrrow, which is not installed: pip install 'kerfwise[nest]'"
SECONDS_A_SHEET = 10.0
"""What sparrow has for each sheet where no limit is given."""
_OWN_SHARE = 0.25


class Watching(Protocol):
    """Told after each round, and asked while sparrow packs; both say whether to go on, `stopped` that not."""

    stopped: bool

    def __call__(self, number: int, best: Layout) -> bool:
        """After a round."""
        ...

    def going(self, doing: str) -> bool:
        """While something else is done."""
        ...


def expect_engine(engine: str) -> None:
    """Say before the work that an engine is not installed."""
    if engine == "sparrow" and not sparrow.installed():
        raise InputError(NO_SPYRROW)


def ranked_layouts(
    wanted: Wanted, spacing: Spacing, effort: Effort, engine: str, watching: Watching, tell: Tell
) -> list[Layout]:
    """Layouts, the best first. The engine sparrow counts seconds, so that two runs of it may differ."""
    if engine != "sparrow":
        return layouts(wanted, spacing, effort, watching, lambda: watching.stopped)
    limit_s = effort.time_s
    own = effort if limit_s is None else replace(effort, time_s=_OWN_SHARE * limit_s)
    ranked = layouts(wanted, spacing, own, watching, lambda: watching.stopped)
    best = ranked[0]
    seconds = SECONDS_A_SHEET * len(best.sheets) if limit_s is None else (1 - _OWN_SHARE) * limit_s
    shapes = Shapes(wanted.types, spacing.gap_mm)
    made = denser(best, shapes, seconds, effort.seed, tell, lambda: watching.going("sparrow packs strips"))
    return ranked if made is best else [made, *ranked]
