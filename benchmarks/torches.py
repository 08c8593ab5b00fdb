"""What several torches save: rows of copies, cut by one torch, by two, and by more at once.

Usage: python -m kerfwise.benchmarks.torches [--rows 4 6 8] [--columns 4] [--work 20]

Rows of plates 100 x 80 mm, each with a hole, 20 mm apart, under the default profile with the dialect linuxcnc. Of n
torches each cuts the rows of one n-th of the sheet. Each program is checked; one that fails ends the run.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import replace

from kerfwise.benchmarks.plates import checked_plan
from kerfwise.encoder.nest import Nest
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.plant_sections import Torches

WIDE_MM, HIGH_MM, WEB_MM, EDGE_MM = 100.0, 80.0, 20.0, 40.0
HEAD = "  parts  torches  idle, m  program, s  share     gap  processor, s"


def rows_of_plates(rows: int, columns: int) -> Nest:
    """Plates with a hole each, row by row from the bottom up."""
    parts = []
    for j in range(rows):
        for i in range(columns):
            x, y = EDGE_MM + i * (WIDE_MM + WEB_MM), EDGE_MM + j * (HIGH_MM + WEB_MM)
            parts.append(part(f"P{j + 1}-{i + 1}", rect(x, y, WIDE_MM, HIGH_MM), [rect(x + 35, y + 25, 30, 30)]))
    size = columns * (WIDE_MM + WEB_MM) + 2 * EDGE_MM - WEB_MM, rows * (HIGH_MM + WEB_MM) + 2 * EDGE_MM - WEB_MM
    return nest(*size, *parts)


def plan_s(rows: int, columns: int, count: int, work: float) -> tuple[float, str]:
    """How long the program takes, s, and what is to be told of it beside that.

    Raises SystemExit if the program does not pass the check.
    """
    sheet, profile = rows_of_plates(rows, columns), load_profile()
    torches = Torches(count, rows // count * (HIGH_MM + WEB_MM)) if count > 1 else Torches()
    profile = replace(profile, machine=replace(profile.machine, dialect="linuxcnc", torches=torches))
    began_s = time.process_time()
    made = checked_plan(f"{rows} × {columns}, {count} torches", sheet, profile, work)
    totals, gap = made.plan.totals, made.plan.solve.gap
    told = "–" if gap is None else "0" if gap == 0 else f"{gap:.1%}"
    spent_s = time.process_time() - began_s
    idle_m = totals.idle_mm / 1000
    return totals.time_s, f"{idle_m:7.2f}  {totals.time_s:10.0f}  {{share:5.0%}}  {told:>6}  {spent_s:12.1f}"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rows", nargs="+", type=int, default=[4, 6, 8])
    parser.add_argument("--columns", type=int, default=4)
    parser.add_argument("--work", type=float, default=20.0)
    given = parser.parse_args()
    print(HEAD)
    for rows in given.rows:
        alone_s = 0.0
        for count in (count for count in (1, 2, 3, 4) if rows % count == 0):
            took_s, told = plan_s(rows, given.columns, count, given.work)
            alone_s = alone_s or took_s
            name = f"{rows} × {given.columns}"
            print(f"{name:>7}  {count:7}  {told.format(share=took_s / alone_s)}", flush=True)


if __name__ == "__main__":
    main()
