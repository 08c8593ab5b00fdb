"""The tables of docs/phases.md: phases by size, before and after, and starts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from kerfwise.benchmarks.phase_clock import AFTER, ALL, BUT_PLANNING, BY_CLOCK, JUDGED, MEMORY, PHASES, REST, STARTED

Spent = dict[str, Any]
"""Seconds by phase and what goes with them, see `phase_clock.spent`; `contours` is how many there are."""


@dataclass(frozen=True)
class Start:
    """What a start took."""

    cpu_s: float
    kernels: int


def exponent(sizes: tuple[float, float], seconds: tuple[float, float]) -> str:
    """By what power of the size it grew, "" where it is too quick to say.

    Examples
    --------
    >>> exponent((100, 1000), (1.0, 100.0)), exponent((100, 1000), (0.01, 0.02))
    ('2.0', '')
    """
    if min(seconds) < 0.05:
        return ""
    return f"{math.log(seconds[1] / seconds[0]) / math.log(sizes[1] / sizes[0]):.1f}"


WHOLE = (*PHASES, REST, ALL, BUT_PLANNING, BY_CLOCK, MEMORY)
FIRST = (STARTED, *PHASES, REST, ALL, JUDGED, AFTER, MEMORY)
"""The rows, of whole plans and of first ones."""


def phase_table(runs: Sequence[Sequence[Spent]], names: Sequence[str] = WHOLE) -> str:
    """Rows of phases by those names; `runs` has for each size what each checkout took."""
    heads, aligned = ["phase"], ["---"]
    for of_size in runs:
        told = f"{of_size[-1]['contours']:.0f}"
        heads += [f"{told}, before", "after", "^"] if len(of_size) > 1 else [told, "^"]
        aligned += ["---:"] * (len(of_size) + 1)
    rows = []
    for name in names:
        cells = [name]
        for k, of_size in enumerate(runs):
            cells += [_cell(run, name) for run in of_size]
            pair = (runs[k - 1][-1], of_size[-1]) if k else None
            cells.append(_growth(pair, name) if pair and name != MEMORY else "")
        rows.append(cells)
    return _lines([heads, aligned, *rows])


def _cell(run: Spent, name: str) -> str:
    """Seconds, or MB, of a phase; more than that where it was ended meanwhile, a stroke where it was before."""
    if name in run.get("missing", ()) or name not in run:
        return "–"
    told = f"{run[name]:.0f}" if name == MEMORY else f"{run[name]:.2f}"
    return f"> {told}" if _cut_short(run, name) else told


def _cut_short(run: Spent, name: str) -> bool:
    """Whether a process was ended before, or in, a phase, or while what counts for all phases was counted."""
    of_all = name in (REST, ALL, BUT_PLANNING, BY_CLOCK, JUDGED, AFTER, MEMORY)
    return bool(run.get("ended")) and (of_all or name in run["running"] or name in run["missing"])


def _growth(pair: tuple[Spent, Spent], name: str) -> str:
    one, two = pair
    if name not in one or name not in two or _cut_short(one, name) or _cut_short(two, name):
        return ""
    return exponent((one["contours"], two["contours"]), (one[name], two[name]))


def start_table(rows: Sequence[tuple[str, Sequence[tuple[Start, Start]]]]) -> str:
    """Rows of starts: cold and warm, of each checkout."""
    several = len(rows[0][1]) > 1
    heads, aligned = ["nest"], ["---"]
    for when in ("before", "after") if several else ("",):
        of = f", {when}" if when else ""
        heads += [f"cold{of}, s", f"kernels{of}", f"warm{of}, s"]
        aligned += ["---:"] * 3
    body = []
    for name, pairs in rows:
        cells = [name]
        for cold, warm in pairs:
            cells += [f"{cold.cpu_s:.1f}", str(cold.kernels), f"{warm.cpu_s:.1f}"]
        body.append(cells)
    return _lines([heads, aligned, *body])


def _lines(rows: Sequence[Sequence[str]]) -> str:
    return "\n".join(f"| {' | '.join(cells)} |" for cells in rows)
