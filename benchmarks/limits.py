"""Whether limits hold: seconds by the clock that `kerfwise solve` takes, and what its process holds at the most.

Usage: python benchmarks/limits.py [--plates 115:10 308:20 1000:30] [--memory GB] [--seed 1] [--processor]
           > docs/time-limits.md

Made plates (examples/gen_sheet.py) under the default profile, cut zone after zone and without zones. Every plate is
solved within so many seconds by the command itself, in a process of its own, once compiled kernels are kept. Prints the
page: the whole command, from starting Python to the last file, by how much that misses its limit, and what of it was
planning. Seconds by the clock mean something only where nothing else runs. With --processor the command itself counts
seconds of the processor in their place, on one thread but for the bound that is looked for beside a plan: about what a
machine takes by the clock that has nothing else to do, however busy this one is.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import kerfwise
from kerfwise.examples.gen_sheet import make_sheet

PAGE = """\
# Limits by the clock

Made by `python benchmarks/limits.py --plates {plates} --memory {memory:g} --seed {seed}{processor}` with kerfwise
{kerfwise}, Python {python}, {system}.
{clock}

Made plates under the default profile, cut zone after zone and without zones, solved by `kerfwise solve --time-limit S
--memory GB`, each in a process of its own, compiled kernels kept. The limit is for the whole command: it starts Python,
reads the nest, works out facts, plans, checks, and writes program, plan and picture. `command` is how long that took;
by how much it missed its limit stands beside it, below 0 where it ended earlier. `planned in` is the part from the
stated rules to the plan that the program is written of; where there are zones, plans without them and by other zones
are in it. `rest` is all but that. The gap is to what had been proven when it ended, empty where nothing was. Memory is
the most that the process held, the interpreter and its libraries included; `--memory` caps the tables of the engines.
"""
HEAD = """\
| plate | limit, s | command, s | over the limit, s | planned in, s | rest, s | gap | memory, MB |
|---|---:|---:|---:|---:|---:|---:|---:|"""
WARM_S = 5.0
"""A first run, within as many seconds, compiles what is missing and is not counted."""
BY_CLOCK = "Programs that run beside it make the bounds lower and the command longer."
BY_PROCESSOR = """\
Seconds are those of the processor, which the limit counts here in the place of those by the clock: about what a machine
that has nothing else to do takes by the clock."""
RUN = """\
import sys, time, types
from kerfwise.cli import main
from kerfwise.jobs.time_limits import CommandLimit
from kerfwise.models import jit as kernels
if sys.argv.pop(1) == "processor":
    kernels.time = types.SimpleNamespace(monotonic=time.process_time)
over, planned = CommandLimit.over, []
def told(limit):
    planned.append(limit.planned_s)
    return over(limit)
CommandLimit.over = told
try:
    main(sys.argv[1:])
finally:
    from kerfwise.apps.bench.bench_child import peak_mb
    compiled_s = kernels.time.monotonic() - kernels.counted_s()
    print(*planned, time.process_time(), compiled_s, f"{peak_mb():.0f}")
"""
"""The command, which prints last the seconds of its planning, those of the processor, those in which it compiled what
the first run did not need, and its memory."""


@dataclass(frozen=True)
class Kept:
    """What a run within `limit_s` took, s; `gap` is None where nothing is proven."""

    plate: str
    limit_s: float
    planned_s: float
    command_s: float
    gap: float | None
    memory_mb: float

    def __str__(self) -> str:
        gap = "" if self.gap is None else f"{self.gap:.1%}"
        over, rest_s = f"{self.command_s - self.limit_s:+.1f}", self.command_s - self.planned_s
        return (
            f"| {self.plate} | {self.limit_s:g} | {self.command_s:.1f} | {over} | {self.planned_s:.1f} | "
            f"{rest_s:.1f} | {gap} | {self.memory_mb:.0f} |"
        )


def run(nest: Path, plate: str, limit_s: float, options: Sequence[str], processor: bool = False) -> Kept:
    """Solve a nest by the command, which counts seconds of the processor where that is asked for.

    Raises
    ------
    RuntimeError
        If the command does not end with a program.
    """
    plan = nest.with_suffix(".plan.json")
    files = ["-o", str(nest.with_suffix(".nc")), "--plan", str(plan), "--picture", str(nest.with_suffix(".svg"))]
    asked = ["solve", str(nest), *files, "--time-limit", f"{limit_s:g}", *options]
    words = [sys.executable, "-c", RUN, "processor" if processor else "clock", *asked]
    threads = {"NUMBA_NUM_THREADS": "1"} if processor else {}
    began_s = time.monotonic()
    done = subprocess.run(words, capture_output=True, encoding="utf-8", check=False, env={**os.environ, **threads})
    command_s = time.monotonic() - began_s
    if done.returncode != 0:
        raise RuntimeError(f"kerfwise {' '.join(asked)} ended with {done.returncode}: {done.stderr}")
    gap = json.loads(plan.read_text(encoding="utf-8"))["solve"].get("gap")
    planned_s, processor_s, compiled_s, memory_mb = map(float, done.stdout.splitlines()[-1].split())
    command_s = (processor_s if processor else command_s) - compiled_s
    return Kept(plate, limit_s, planned_s, command_s, gap, memory_mb)


def main() -> None:
    """Print the page, every row as it comes."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--plates", nargs="+", default=["115:10", "308:20", "1000:30"], metavar="CONTOURS:S")
    parser.add_argument("--memory", type=float, default=2.0, metavar="GB")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--processor", action="store_true", help="count seconds of the processor")
    given = parser.parse_args()
    system = f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores"
    told = {"plates": " ".join(given.plates), "memory": given.memory, "seed": given.seed, "system": system}
    told |= {"kerfwise": kerfwise.__version__, "python": platform.python_version()}
    by_processor = {"processor": " --processor", "clock": BY_PROCESSOR}
    told |= by_processor if given.processor else {"processor": "", "clock": BY_CLOCK}
    print(f"{PAGE.format(**told)}\n{HEAD}", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        for contours, limit in (plate.split(":") for plate in given.plates):
            nest = Path(folder) / f"{contours}.json"
            nest.write_text(json.dumps(make_sheet(given.seed, int(contours))), encoding="utf-8", newline="\n")
            for name, off in (("", []), (", no zones", ["--set", "rules.zone-order=off"])):
                options = ["--memory", f"{given.memory:g}", "--seed", str(given.seed), *off]
                run(nest, "", min(WARM_S, float(limit)), options, given.processor)
                print(run(nest, f"{contours} contours{name}", float(limit), options, given.processor), flush=True)


if __name__ == "__main__":
    main()
