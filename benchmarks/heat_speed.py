"""How long a simulation of heat takes: two-hour programs all over a sheet of 6000 × 1500 mm, on a grid of 5 mm.

Usage: python benchmarks/heat_speed.py

At first the torch goes up and down the sheet in lines 30 mm apart, on every material: CPU seconds of one core, the
compiled kernel loaded. Then a made nest that fills the sheet is planned, and `kerfwise heat` simulates its program: CPU
seconds, seconds and memory of that command as a whole.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from kerfwise.encoder.nest import Nest, Sheet
from kerfwise.examples.gen_sheet import contour_count, make_sheet
from kerfwise.models.physics.heat import TimedPath, simulate
from kerfwise.models.physics.heat.timed_path import in_order, torch_on
from kerfwise.rules.profile.plant_sections import MATERIALS, Heat

WIDTH_MM, HEIGHT_MM, APART_MM, SECONDS = 6000.0, 1500.0, 30.0, 7200.0
PLANT = """\
based_on: plasma-carbon-steel
machine: {cut_feed: 1750 mm/min}
material: {thickness: 10 mm}
"""
"""Thicker plate, cut so slowly that a full sheet takes two hours."""
SEED, MANY = 1, 5000
"""More contours than the sheet has room for."""


def up_and_down(seconds: float) -> TimedPath:
    """One line after the other over the whole sheet."""
    ends = [(x, y) for x in np.arange(15.0, WIDTH_MM, APART_MM) for y in (10.0, HEIGHT_MM - 10.0)]
    for k in range(2, len(ends), 4):
        ends[k : k + 2] = ends[k + 1], ends[k]
    return in_order([torch_on("lines", np.array(ends), 0.0, seconds)], seconds)


@dataclass(frozen=True)
class Ran:
    """What a command printed, and what it took."""

    text: str
    cpu_s: float
    took_s: float
    memory_mb: float


def run(*arguments: str) -> Ran:
    """Run kerfwise in a process of its own, which is alone in what is measured.

    Raises
    ------
    RuntimeError
        If it does not end well.
    """
    command = [sys.executable, "-m", "kerfwise", *arguments]
    begin = time.perf_counter()
    with tempfile.TemporaryFile("w+", encoding="utf-8", newline="\n") as said:
        child = subprocess.Popen(command, stdout=said)
        _, status, used = os.wait4(child.pid, 0)
        took_s, child.returncode = time.perf_counter() - begin, os.waitstatus_to_exitcode(status)
        if child.returncode:
            raise RuntimeError(f"kerfwise {' '.join(arguments)} failed")
        said.seek(0)
        kilobytes = used.ru_maxrss / (1024 if sys.platform == "darwin" else 1)
        return Ran(said.read(), used.ru_utime + used.ru_stime, took_s, kilobytes / 1024)


def real_program(nest: dict[str, Any], folder: Path) -> tuple[Ran, float]:
    """`kerfwise heat` on the program of a nest that kerfwise plans beforehand; and how long that program takes, s."""
    files = [str(folder / name) for name in ("nest.json", "plant.yaml", "out.nc")]
    Path(files[0]).write_text(json.dumps(nest), encoding="utf-8", newline="\n")
    Path(files[1]).write_text(PLANT, encoding="utf-8", newline="\n")
    run("solve", files[0], "-p", files[1], "-o", files[2])
    total_s = json.loads(run("time", files[0], files[2], "-p", files[1], "--json").text)["total_s"]
    return run("heat", files[0], files[2], "-p", files[1], "--json"), total_s


def main() -> None:
    """Print a row for every material, then one for the program."""
    nest = Nest(Sheet.rectangle(WIDTH_MM, HEIGHT_MM), ())
    simulate(nest, up_and_down(1.0), Heat(), 6.0)  # the kernel is loaded before the clock counts
    print("| material | CPU seconds | peak, °C | energy not accounted for |\n|---|---:|---:|---:|")
    for material in MATERIALS:
        begin = time.process_time()
        result = simulate(nest, up_and_down(SECONDS), replace(Heat(), material=material), 6.0)
        took = time.process_time() - begin
        print(f"| {material} | {took:.1f} | {result.run.peak_c.max():.0f} | {result.energy_error:.1e} |", flush=True)

    made = make_sheet(SEED, MANY, (WIDTH_MM, HEIGHT_MM))
    with tempfile.TemporaryDirectory() as folder:
        ran, total_s = real_program(made, Path(folder))
    found = json.loads(ran.text)
    print("\n| contours | program, min | CPU seconds | seconds | memory, MB | peak, °C | overheats |")
    print("|---:|---:|---:|---:|---:|---:|---:|")
    cells = [f"{contour_count(made)}", f"{total_s / 60:.0f}", f"{ran.cpu_s:.1f}", f"{ran.took_s:.1f}"]
    cells += [f"{ran.memory_mb:.0f}", f"{found['peak_c']:.0f}", f"{found['overheats']}"]
    print(f"| {' | '.join(cells)} |")


if __name__ == "__main__":
    main()
