"""How many nests a minute: one `kerfwise solve` after the other, a batch in processes, a batch on a Dask cluster.

`python -m kerfwise.benchmarks.batch [NESTS] > table.md` prints the table of docs/batch.md. Each way plans the same
small nests with the same work, from a cold start to the last file, in folders that are deleted. Kernels are compiled
beforehand, as they are once on a machine. The files of all ways are compared, byte by byte: the exit code is 1 where
they differ. Nobody else should use the cores meanwhile. Needs the extra kerfwise[cluster].
"""

from __future__ import annotations

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

from kerfwise.benchmarks.dask_here import cluster
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.models.kernels import machine_cores

NESTS, WORK = 200, 0.5
CONTOURS = (4, 6, 8, 10, 12)
PROFILE = "plasma-carbon-steel"
KERFWISE = (sys.executable, "-m", "kerfwise")
ENDINGS = (".nc", ".plan.json", ".svg")


@dataclass(frozen=True, slots=True)
class Measured:
    """A way to plan all nests: seconds by the clock and of the processor, workers among it, and the files it wrote."""

    way: str
    wall_s: float
    cpu_s: float
    files: dict[str, bytes]


def write_nests(folder: Path, nests: int) -> None:
    """Sheets of 4 to 12 contours, each another."""
    folder.mkdir()
    for k in range(nests):
        sheet = make_sheet(k + 1, CONTOURS[k % len(CONTOURS)], (900.0, 600.0))
        (folder / f"nest{k + 1:04d}.json").write_text(json.dumps(sheet), encoding="utf-8", newline="\n")


def solved(given: Path, out: Path) -> None:
    """`kerfwise solve` of one nest after the other."""
    out.mkdir()
    for nest in sorted(given.iterdir()):
        run(["solve", str(nest), "-p", PROFILE, "--work", str(WORK)], out)


def batch(given: Path, out: Path, *more: str) -> None:
    """One `kerfwise batch`."""
    run(["batch", str(given), "-p", PROFILE, "-o", str(out), "--work", str(WORK), *more], given.parent)


def run(arguments: Sequence[str], folder: Path) -> None:
    """kerfwise with these arguments in a folder; a refusal is no answer, but measured like one."""
    done = subprocess.run([*KERFWISE, *arguments], cwd=folder, capture_output=True, check=False)
    if done.returncode not in (0, 1):
        raise RuntimeError(done.stderr.decode(errors="replace"))


def measured(way: str, given: Path, out: Path) -> Measured:
    """One way from a cold start to its end."""
    began_s, before = time.monotonic(), os.times()
    name, _, count = way.partition(", ")
    workers = int(count.split()[0]) if count else 0
    if name == "shell loop of solve":
        solved(given, out)
    elif name == "batch":
        batch(given, out, "--jobs", str(workers))
    else:
        with cluster(given.parent, workers) as (address, _):
            batch(given, out, "--scheduler", address)
    wall_s, after = time.monotonic() - began_s, os.times()
    cpu_s = after.children_user + after.children_system - before.children_user - before.children_system
    files = {path.name: path.read_bytes() for path in out.rglob("*") if path.name.endswith(ENDINGS)}
    return Measured(way, wall_s, cpu_s, files)


def table(nests: int, rows: Sequence[Measured]) -> str:
    """A line a way: how long, how many nests a minute, how many times as many as the first."""
    about = f"{nests} nests of {CONTOURS[0]} to {CONTOURS[-1]} contours, work {WORK:g}, kernels compiled beforehand"
    where = (
        f"Python {platform.python_version()}, {platform.system()} {platform.machine()}, {len(machine_cores())} cores"
    )
    lines = [
        f"{about}; {where}.",
        "",
        "| way | s | processor s | nests a minute | times |",
        "|---|---:|---:|---:|---:|",
    ]
    for row in rows:
        figures = (
            f"{row.wall_s:.0f} | {row.cpu_s:.0f} | {60 * nests / row.wall_s:.1f} | {rows[0].wall_s / row.wall_s:.2f}"
        )
        lines.append(f"| {row.way} | {figures} |")
    return "\n".join(lines)


def main() -> int:
    """Measure every way and print the table."""
    nests = int(sys.argv[1]) if len(sys.argv) > 1 else NESTS
    ways = (
        "shell loop of solve",
        "batch, 1 job",
        "batch, 2 jobs",
        "batch on Dask, 1 worker",
        "batch on Dask, 2 workers",
    )
    with tempfile.TemporaryDirectory(prefix="kerfwise-", ignore_cleanup_errors=True) as name:
        folder = Path(name)
        given = folder / "nests"
        write_nests(given, nests)
        (folder / "warm").mkdir()
        run(["solve", str(given / "nest0001.json"), "-p", PROFILE, "--work", str(WORK)], folder / "warm")
        rows = [measured(way, given, folder / f"out{k}") for k, way in enumerate(ways)]
    print(table(nests, rows))
    differing = [row.way for row in rows if row.files != rows[0].files]
    for way in differing:
        print(f"the files of {way} are not those of {rows[0].way}", file=sys.stderr)
    return int(bool(differing))


if __name__ == "__main__":
    sys.exit(main())
