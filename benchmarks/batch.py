"""How many nests a minute: one `kerfwise solve` after the other, a batch in processes, a batch on a Dask cluster.

`python -m kerfwise.benchmarks.batch [--nests 200] [--ways WAY…] [--into FOLDER] > table.md` prints the table of
docs/batch.md. Each way plans the same small nests with the same work, from a cold start to the last file. Kernels are
compiled beforehand, as they are once on a machine. The files of all ways are compared, byte by byte: the exit code is
1 where they differ. Nobody else should use the cores meanwhile. Needs the extra kerfwise[cluster].

With `--into FOLDER` what was measured is kept there, way by way: the command can be stopped, and the same command
measures what is missing. `--ways` takes some of the ways only, by their numbers in the table:
`--nests 1000 --ways 2 3` holds two processes against one.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import platform
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from kerfwise.benchmarks.dask_here import cluster
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.models.jit import machine_cores

NESTS, WORK = 200, 0.5
CONTOURS = (4, 6, 8, 10, 12)
PROFILE = "plasma-carbon-steel"
KERFWISE = (sys.executable, "-m", "kerfwise")
ENDINGS = (".nc", ".plan.json", ".svg")
WAYS = (
    "shell loop of solve",
    "batch, 1 job",
    "batch, 2 jobs",
    "batch on Dask, 1 worker",
    "batch on Dask, 2 workers",
)


@dataclass(frozen=True, slots=True)
class Measured:
    """A way to plan all nests: seconds by the clock and of the processor, workers among it, and its files by sha256."""

    way: str
    wall_s: float
    cpu_s: float
    files: dict[str, str]


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
    shutil.rmtree(out, ignore_errors=True)  # of a run that was stopped
    began_s, before = time.monotonic(), os.times()
    name, _, count = way.partition(", ")
    workers = int(count.split()[0]) if count else 0
    if name == WAYS[0]:
        solved(given, out)
    elif name == "batch":
        batch(given, out, "--jobs", str(workers))
    else:
        with cluster(given.parent, workers) as (address, _):
            batch(given, out, "--scheduler", address)
    wall_s, after = time.monotonic() - began_s, os.times()
    cpu_s = after.children_user + after.children_system - before.children_user - before.children_system
    found = sorted(path for path in out.rglob("*") if path.name.endswith(ENDINGS))
    files = {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in found}
    return Measured(way, wall_s, cpu_s, files)


def kept(way: str, folder: Path) -> Measured:
    """What was measured of a way in this folder before; else it is measured now."""
    number = WAYS.index(way) + 1
    record = folder / f"way{number}.json"
    if record.is_file():
        return Measured(**json.loads(record.read_text(encoding="utf-8")))
    made = measured(way, folder / "nests", folder / f"out{number}")
    record.write_text(json.dumps(asdict(made), indent=1), encoding="utf-8", newline="\n")
    print(f"{way}: {made.wall_s:.0f} s, {made.cpu_s:.0f} processor s", file=sys.stderr)
    return made


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


def rows_of(nests: int, ways: Sequence[str], folder: Path) -> list[Measured]:
    """Every way, in a folder that may hold what was measured before.

    Raises ValueError if the folder is of another number of nests.
    """
    folder.mkdir(parents=True, exist_ok=True)
    given, whole = folder / "nests", folder / "warm.txt"
    if not whole.is_file():
        shutil.rmtree(given, ignore_errors=True)
        write_nests(given, nests)
        (folder / "warm").mkdir(exist_ok=True)
        run(["solve", str(given / "nest0001.json"), "-p", PROFILE, "--work", str(WORK)], folder / "warm")
        whole.write_text(str(nests), encoding="utf-8", newline="\n")
    if (there := int(whole.read_text(encoding="utf-8"))) != nests:
        raise ValueError(f"{folder} is of {there} nests: give another folder, or --nests {there}")
    return [kept(way, folder) for way in ways]


def main() -> int:
    """Measure every way and print the table."""
    options = argparse.ArgumentParser(description=(__doc__ or "").split("\n", 1)[0])
    options.add_argument("--nests", type=int, default=NESTS)
    options.add_argument("--ways", type=int, nargs="+", choices=range(1, len(WAYS) + 1), metavar="WAY")
    options.add_argument("--into", type=Path, metavar="FOLDER")
    asked = options.parse_args()
    ways = [WAYS[number - 1] for number in asked.ways or range(1, len(WAYS) + 1)]
    with tempfile.TemporaryDirectory(prefix="kerfwise-", ignore_cleanup_errors=True) as name:
        try:
            rows = rows_of(asked.nests, ways, (asked.into or Path(name)).resolve())
        except ValueError as error:
            options.error(str(error))
    print(table(asked.nests, rows))
    differing = [row.way for row in rows if row.files != rows[0].files]
    for way in differing:
        print(f"the files of {way} are not those of {rows[0].way}", file=sys.stderr)
    return int(bool(differing))


if __name__ == "__main__":
    sys.exit(main())
