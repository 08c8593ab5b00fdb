"""Who lays the parts: kerfwise itself, Pavlov's method, and sparrow after either where that is asked for."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Literal, get_args

from kerfwise.encoder.errors import InputError
from kerfwise.jobs.given import Tell
from kerfwise.nesting import sparrow
from kerfwise.nesting.allot import Layout
from kerfwise.nesting.denser import denser
from kerfwise.nesting.rounds import Effort, Method, layouts
from kerfwise.nesting.shapes import Shapes
from kerfwise.nesting.wanted import Spacing, Wanted

from .watching import Watching

Engine = Literal["own", "pavlov", "sparrow"]
ENGINES: tuple[Engine, ...] = get_args(Engine)
NO_SPYRROW = "the engine sparrow needs spyrrow, which is not installed: pip install 'kerfwise[nest]'"
SECONDS_A_SHEET = 10.0
"""What sparrow has for each sheet where no limit is given."""
ALONE = "each alone"
"""How layouts are marked that have no blocks where edges could be cut once."""
_OWN_SHARE = 0.25
_OTHERS_SHARE = 0.5
"""Share of the rounds, or of the time, that those have beside the engine asked for where layouts are weighed."""


def expect_engine(engine: str) -> None:
    """Say before the work that there is no such engine, or that it is not installed."""
    if engine not in ENGINES:
        raise InputError(f"unknown engine {engine!r}: expected {', '.join(ENGINES)}")
    if engine == "sparrow" and not sparrow.installed():
        raise InputError(NO_SPYRROW)


def ranked_layouts(
    wanted: Wanted, spacing: Spacing, effort: Effort, engine: Engine, watching: Watching, tell: Tell
) -> list[Layout]:
    """Layouts, the best first. The engine sparrow counts seconds, so that two runs of it may differ."""
    method: Method = "pavlov" if engine == "pavlov" else "own"
    effort = replace(effort, method=method)
    if engine != "sparrow":
        return layouts(wanted, spacing, effort, watching, lambda: watching.stopped)
    limit_s = effort.time_s
    own = effort if limit_s is None else replace(effort, time_s=_OWN_SHARE * limit_s)
    ranked = layouts(wanted, spacing, own, watching, lambda: watching.stopped)
    best = ranked[0]
    if watching.stopped:
        return ranked
    seconds = SECONDS_A_SHEET * len(best.sheets) if limit_s is None else (1 - _OWN_SHARE) * limit_s
    shapes = Shapes(wanted.types, spacing.gap_mm, spacing.common)
    made = denser(best, shapes, seconds, effort.seed, tell, lambda: watching.going("sparrow packs strips"))
    return ranked if made is best else [replace(made, by="sparrow"), *ranked]


def varied_layouts(
    wanted: Wanted, spacing: Spacing, effort: Effort, engine: Engine, watching: Watching, tell: Tell
) -> list[list[Layout]]:
    """Layouts for weighing: those of the engine asked for, and of others, each group the best first.

    The others are Pavlov's method, or kerfwise's own where Pavlov's was asked for; and, where edges are cut once, parts
    that lie alone.
    """
    return list(_groups(wanted, spacing, effort, engine, watching, tell))


def _groups(
    wanted: Wanted, spacing: Spacing, effort: Effort, engine: Engine, watching: Watching, tell: Tell
) -> Iterator[list[Layout]]:
    less = replace(effort, rounds=max(1, round(effort.rounds * _OTHERS_SHARE)))
    if effort.time_s is not None:
        effort, less = (replace(effort, time_s=effort.time_s * share) for share in (1 - _OTHERS_SHARE, 0.25))
    yield ranked_layouts(wanted, spacing, effort, engine, watching, tell)
    if watching.stopped:
        return
    yield ranked_layouts(wanted, spacing, less, "own" if engine == "pavlov" else "pavlov", watching, tell)
    if spacing.common is not None and not watching.stopped:
        alone = ranked_layouts(wanted, replace(spacing, common=None), less, "own", watching, tell)
        yield [replace(layout, spacing=spacing, by=f"{layout.by}, {ALONE}") for layout in alone]
