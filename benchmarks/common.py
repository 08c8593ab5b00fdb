"""What common cuts save: grids a kerf apart with every edge cut once, against the same parts with a web between them.

Usage: python -m kerfwise.benchmarks.common [--grids 3x4 5x8 10x20] [--mixed 60] [--work 20] > common-cuts.md

Rows x columns of rectangles 100 x 60 mm, parts of four widths in staggered rows, and a made plate of all kinds of parts
(examples/gen_sheet.py, seed 1), under the shipped profile of a laser. Each program is checked; one that fails ends the
run.
"""

from __future__ import annotations

import argparse
import json
import platform
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import kerfwise
from kerfwise.benchmarks.plates import checked_plan
from kerfwise.encoder.nest import Nest, Part
from kerfwise.encoder.readers import ReadOptions
from kerfwise.encoder.readers.json_nest import read_json
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.sections import Common, Cuts

PROFILE = "laser-st10kp-2mm"
WEB_MM, EDGE_MM = 12.0, 30.0
WIDE_MM, HIGH_MM = 100.0, 60.0
STAGGERED = ((100.0, 60.0, 140.0, 80.0), (60.0, 140.0, 80.0, 100.0), (140.0, 80.0, 100.0, 60.0))
"""Widths of parts, row by row."""
PAGE = """\
# What common cuts save

Made by `python -m kerfwise.benchmarks.common --grids {grids} --mixed {mixed} --work {work:g} > docs/common-cuts.md`
with kerfwise {kerfwise}, Python {python}: rows × columns of rectangles {wide:g} × {high:g} mm, parts of four widths in
staggered rows, and a plate of `examples/gen_sheet.py`, seed 1, under the shipped profile `{profile}`. With common
cuts ([how](common.md)) parts stand one kerf apart ({kerf:g} mm), without them {web:g} mm: nearer there is no room for a
pierce between them. On the mixed plate only straight edges within a column are one kerf apart (`--web`): columns,
discs, and parts that lie in others keep their {web:g} mm.

A plan with common cuts has the least time, a plain one the least idle travel. The gap is what is not proven, of a
plan's own cost. The processor's seconds are those of the whole run: facts, plan, program and check.

| parts | cuts | pierces | cut, m | idle, m | program, s | gap | processor, s |
|---|---|---:|---:|---:|---:|---:|---:|
{rows}
"""


@dataclass(frozen=True)
class Row:
    """One plan: what it is of, and what it comes to."""

    name: str
    common: bool
    pierces: int
    cut_mm: float
    idle_mm: float
    program_s: float
    gap: float | None
    spent_s: float

    def __str__(self) -> str:
        cells = (
            self.name, "common" if self.common else "plain", str(self.pierces), f"{self.cut_mm / 1000:.2f}",
            f"{self.idle_mm / 1000:.2f}", f"{self.program_s:.0f}",
            "–" if self.gap is None else "0" if self.gap == 0 else f"{self.gap:.2%}", f"{self.spent_s:.0f}",
        )  # fmt: skip
        return f"| {' | '.join(cells)} |"


def widths_of(size: str) -> list[tuple[float, ...]]:
    """The widths of equal rectangles, row by row, of a size such as 5x8."""
    rows, columns = map(int, size.split("x"))
    return [(WIDE_MM,) * columns] * rows


def in_rows(widths_mm: list[tuple[float, ...]], web_mm: float) -> Nest:
    """Rectangles of equal height in rows from the bottom up."""
    parts: list[Part] = []
    for number, row in enumerate(widths_mm):
        x, y = EDGE_MM, EDGE_MM + number * (HIGH_MM + web_mm)
        for wide in row:
            parts.append(part(f"P{len(parts) + 1}", rect(x, y, wide, HIGH_MM)))
            x += wide + web_mm
    longest = max(sum(row) + web_mm * len(row) for row in widths_mm)
    return nest(longest + 2 * EDGE_MM, len(widths_mm) * (HIGH_MM + web_mm) + 2 * EDGE_MM, *parts)


def mixed(contours: int, web_mm: float) -> Nest:
    """A plate of all kinds of parts, straight edges in a column so far apart."""
    return read_json(json.dumps(make_sheet(1, contours, gap_mm=WEB_MM, web_mm=web_mm)).encode(), ReadOptions())


def plant(common: bool) -> Profile:
    """The laser's profile."""
    return replace(load_profile(PROFILE), cuts=Cuts(common=Common(shortest_mm=20.0)) if common else Cuts())


def row(name: str, sheet: Nest, common: bool, work: float) -> Row:
    """Plan and check a sheet.

    Raises
    ------
    SystemExit
        If its program does not pass the check.
    """
    profile, began_s = plant(common), time.process_time()
    made = checked_plan(name, sheet, profile, work)
    totals = made.plan.totals
    return Row(
        name,
        common,
        totals.pierces,
        totals.cut_mm,
        totals.idle_mm,
        totals.time_s,
        made.plan.solve.gap,
        time.process_time() - began_s,
    )


def main() -> None:
    """Print the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--grids", nargs="+", default=["3x4", "5x8", "10x20"])
    parser.add_argument("--mixed", type=int, default=60, metavar="CONTOURS")
    parser.add_argument("--work", type=float, default=20.0)
    given = parser.parse_args()
    kerf_mm = plant(common=True).material.kerf_mm
    sheets: list[tuple[str, Callable[[float], Nest]]] = [
        (size.replace("x", " × "), partial(in_rows, widths_of(size))) for size in given.grids
    ]
    sheets.append(("staggered", partial(in_rows, [STAGGERED[k % len(STAGGERED)] for k in range(6)])))
    sheets.append((f"mixed, {len(mixed(given.mixed, WEB_MM).contours)} contours", partial(mixed, given.mixed)))
    rows = []
    for name, sheet_with in sheets:
        for common in (False, True):
            sheet = sheet_with(kerf_mm if common else WEB_MM)
            rows.append(str(row(name, sheet, common, given.work)))
            print(rows[-1], file=sys.stderr, flush=True)
    page = PAGE.format(
        grids=" ".join(given.grids),
        mixed=given.mixed,
        work=given.work,
        kerfwise=kerfwise.__version__,
        python=platform.python_version(),
        wide=WIDE_MM,
        high=HIGH_MM,
        web=WEB_MM,
        kerf=kerf_mm,
        profile=PROFILE,
        rows="\n".join(rows),
    )
    print(page, end="")


if __name__ == "__main__":
    main()
