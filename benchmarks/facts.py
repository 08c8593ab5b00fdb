"""How long the facts of a nest take in CPU seconds, family by family, from 100 to 10,000 contours.

Usage: python benchmarks/facts.py [--seed S] [--contours N …] [--candidates K]

Sheets are made by examples/gen_sheet.py. The last column is the exponent of growth: 1 is linear, 2 quadratic, fitted
to the sizes from 1000 contours up. The number of level-ahead pairs itself grows as about n^1.5 on a sheet that
grows in both directions; no way of listing them all can grow slower.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from kerfwise.benchmarks.plates import made_plate
from kerfwise.encoder.candidates.candidate import Candidate
from kerfwise.encoder.facts import FactOptions, compute
from kerfwise.encoder.nest import Nest

SIZES = (100, 300, 1000, 3000, 10000)
FIT_FROM = 1000
FAMILIES = {
    "outlines": ("outlines_of",),
    "containment": ("parents_of", "closure_of"),
    "long parts": ("long_parts",),
    "offcut, heat, start side": ("edge_gaps", "offcuts", "heat", "start_side"),
    "shadows": ("level_ahead",),
    "hulls": ("hull_pairs",),
    "zones": ("zones_of",),
    "neighbours": ("cells_of", "outlook_of", "surroundings_of"),
    "stretches": ("runs_of", "stretch_of"),
}
"""Family → the functions of `compute_facts` that it is made by."""


def plain_candidates(nest: Nest, each: int) -> tuple[Candidate, ...]:
    """Evenly spread entries without leads, in turn cw and ccw."""
    made = []
    for number, contour in enumerate(nest.contours):
        length_mm = contour.curve.length_mm
        for k in range(each):
            entry_mm = length_mm * k / each
            at = contour.curve.point_at(entry_mm)
            made.append(Candidate(number, entry_mm, at, "ccw" if k % 2 else "cw", at, None, None, at, cut_mm=length_mm))
    return tuple(made)


def seconds_by_family(nest: Nest, candidates: tuple[Candidate, ...]) -> dict[str, float]:
    """Run `compute_facts` once with a clock around each of its steps."""
    spent = dict.fromkeys(FAMILIES, 0.0)
    plain = {name: getattr(compute, name) for names in FAMILIES.values() for name in names}

    def timed(family: str, step: Callable[..., Any]) -> Callable[..., Any]:
        def run(*arguments: Any) -> Any:
            begin = time.process_time()
            result = step(*arguments)
            spent[family] += time.process_time() - begin
            return result

        return run

    for family, names in FAMILIES.items():
        for name in names:
            setattr(compute, name, timed(family, plain[name]))
    begin = time.process_time()
    compute.compute_facts(nest, FactOptions(), candidates)
    whole = time.process_time() - begin
    for name, step in plain.items():
        setattr(compute, name, step)
    return {**spent, "all": whole}


def exponent(sizes: list[int], seconds: list[float]) -> str:
    """Slope of log seconds over log contours, "" when fewer than two sizes are large enough."""
    large = [(n, s) for n, s in zip(sizes, seconds, strict=True) if n >= FIT_FROM and s > 0]
    if len({n for n, _ in large}) < 2:
        return ""
    n, s = np.log(np.array(large)).T
    return f"{np.polyfit(n, s, 1)[0]:.2f}"


def main() -> None:
    """Measure and print the table."""
    arguments = argparse.ArgumentParser(description=str(__doc__).splitlines()[0])
    arguments.add_argument("--seed", type=int, default=1)
    arguments.add_argument("--contours", type=int, nargs="+", default=list(SIZES))
    arguments.add_argument("--candidates", type=int, default=16, help="of each contour; 0 for none")
    given = arguments.parse_args()

    seconds_by_family(made_plate(20, given.seed), ())  # libraries load and warm up before the clock counts
    sizes, runs = [], []
    for contours in given.contours:
        nest = made_plate(contours, given.seed)
        sizes.append(len(nest.contours))
        runs.append(seconds_by_family(nest, plain_candidates(nest, given.candidates)))

    table = Table(title=f"CPU seconds for the facts, {given.candidates} candidates a contour, seed {given.seed}")
    table.add_column("contours")
    for size in sizes:
        table.add_column(str(size), justify="right")
    table.add_column("exponent", justify="right")
    for family in (*FAMILIES, "all"):
        seconds = [run[family] for run in runs]
        table.add_row(
            family, *(f"{s:.3f}" for s in seconds), exponent(sizes, seconds), end_section=family == "stretches"
        )
    Console().print(table)


if __name__ == "__main__":
    main()
