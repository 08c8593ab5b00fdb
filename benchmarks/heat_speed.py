"""How long a simulation of heat takes: a two-hour program all over a sheet of 6000 × 1500 mm, on a grid of 5 mm.

Usage: python benchmarks/heat_speed.py

The torch goes up and down the sheet in lines 30 mm apart. CPU seconds of one core, the compiled kernel loaded.
"""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np

from kerfwise.encoder.nest import Nest, Sheet
from kerfwise.models.heat import TimedPath, simulate
from kerfwise.models.heat.timed_path import in_order, torch_on
from kerfwise.rules.heat_section import Heat
from kerfwise.rules.materials import MATERIALS

WIDTH_MM, HEIGHT_MM, APART_MM, SECONDS = 6000.0, 1500.0, 30.0, 7200.0


def up_and_down(seconds: float) -> TimedPath:
    """One line after the other over the whole sheet."""
    ends = [(x, y) for x in np.arange(15.0, WIDTH_MM, APART_MM) for y in (10.0, HEIGHT_MM - 10.0)]
    for k in range(2, len(ends), 4):
        ends[k : k + 2] = ends[k + 1], ends[k]
    return in_order([torch_on("lines", np.array(ends), 0.0, seconds)], seconds)


def main() -> None:
    """Print a row for every material."""
    nest = Nest(Sheet.rectangle(WIDTH_MM, HEIGHT_MM), ())
    simulate(nest, up_and_down(1.0), Heat(), 6.0)  # the kernel is loaded before the clock counts
    print("| material | CPU seconds | peak, °C | energy not accounted for |\n|---|---:|---:|---:|")
    for material in MATERIALS:
        begin = time.process_time()
        result = simulate(nest, up_and_down(SECONDS), replace(Heat(), material=material), 6.0)
        took = time.process_time() - begin
        print(f"| {material} | {took:.1f} | {result.run.peak_c.max():.0f} | {result.energy_error:.1e} |", flush=True)


if __name__ == "__main__":
    main()
