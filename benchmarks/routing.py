"""How kerfwise fares on the field's own routing benchmarks.

Usage: python benchmarks/routing.py FOLDER --best-known CSV [--time-limit S] [--seed N] [--also SET=S …]
           [--remarks TEXT.md …] > docs/routing.md

FOLDER holds a folder for every set, with `.pcglns` and `.sop` files in it, gzipped or not; the CSV has columns set,
instance and best_upper. Prints the page: every instance run once by the default engine, judged, beside the best cost
known; what is worse than that comes first, then remarks that people wrote, and what
`sparse_orders.py` printed. `--also cnc=1` runs a set once more, with
another limit.
"""

from __future__ import annotations

import argparse
import datetime
import os
import platform
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

import kerfwise
from kerfwise.jobs.bench import BenchJob, BenchResult, BestKnown, gap_to, measure, read_best_known, results_in_all
from kerfwise.models.routing import is_instance

PAGE = """\
# Routing benchmarks

The core of kerfwise solves the precedence-constrained generalised travelling salesman problem, and with one vertex a
cluster the sequential ordering problem. These are the field's instances, run by

    python benchmarks/routing.py FOLDER --best-known CSV --time-limit {limit:g} --seed {seed}{also}

on {date}, kerfwise {kerfwise} at commit {commit}, Python {python}, numba {numba}, OR-Tools {ortools}, {machine}.
Every instance has a process of its own; its clock runs from the file read to the answer, with compiled kernels loaded.
Tours are judged by code that shares nothing with the engines. A cost is proven where the engine showed that no tour
is cheaper; elsewhere the bound that it did prove stands beside it. Memory is the most that the process held,
some {base:.0f} MB of it the interpreter and its libraries. One instance: `kerfwise bench FILE --time-limit {limit:g}`.

{summary}

## Where it is worse than the best known

{worse}
{remarks}
{sets}
"""


@dataclass(frozen=True)
class Run:
    """One instance of one set; `set` says the limit too where a set is run with several."""

    set: str
    result: BenchResult
    best: float | None

    @property
    def gap(self) -> float | None:
        """To the best known cost."""
        return gap_to(self.result, self.best)

    def __str__(self) -> str:
        r = self.result
        gap = "" if self.gap is None else f"{self.gap:+.2%}"
        bound = "yes" if r.proven else "" if r.bound is None else f"≥ {r.bound:g}"
        best = "" if self.best is None else f"{self.best:g}"
        cost = "none" if r.cost is None else f"{r.cost:g}"
        return f"| {r.instance} | {cost} | {best} | {gap} | {bound} | {r.seconds:.1f} | {r.memory_mb:.0f} |"


HEAD = "| instance | cost | best known | gap | proven | s | MB |\n|---|---:|---:|---:|---:|---:|---:|\n"


@dataclass(frozen=True)
class Limits:
    """Seconds for every instance of every set; `also`: sets to run again, with how many seconds."""

    limit_s: float
    seed: int
    also: tuple[tuple[str, float], ...]


def run_set(name: str, folder: Path, best: BestKnown, limit_s: float, seed: int) -> list[Run]:
    """Every instance of a folder, as a set of that name."""
    runs = []
    for path in sorted(folder.iterdir()):
        if is_instance(path):
            runs.append(Run(name, measure(BenchJob(str(path), seed=seed, time_s=limit_s)), best.of(path)))
            print(runs[-1], file=sys.stderr, flush=True)
    return runs


def page(runs: Sequence[Run], limits: Limits, remarks: Sequence[Path] = ()) -> str:
    """The whole page."""
    names = list(dict.fromkeys(run.set for run in runs))
    of = {name: [run for run in runs if run.set == name] for name in names}
    worse = [run for run in runs if run.gap is None or run.gap > 0]
    lines = [
        f"- **{name}**: {results_in_all([r.result for r in of[name]], [r.best for r in of[name]])}" for name in names
    ]
    return PAGE.format(
        limit=limits.limit_s,
        seed=limits.seed,
        also="".join(f" --also {name}={seconds:g}" for name, seconds in limits.also)
        + (f" --remarks {' '.join(text.name for text in remarks)}" if remarks else ""),
        remarks="".join(f"\n{text.read_text(encoding='utf-8')}" for text in remarks),
        date=datetime.date.today().isoformat(),
        kerfwise=kerfwise.__version__,
        commit=_commit(),
        python=platform.python_version(),
        numba=version("numba"),
        ortools=version("ortools"),
        machine=f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores",
        base=min(run.result.memory_mb for run in runs),
        summary="\n".join(lines),
        worse="| set " + HEAD.replace("|---|", "|---|---|", 1) + "\n".join(f"| {r.set} {r}" for r in worse)
        if worse
        else "Nowhere.",
        sets="\n\n".join(f"## {name}\n\n{HEAD}" + "\n".join(map(str, of[name])) for name in names),
    )


def _commit() -> str:
    here = Path(kerfwise.__file__).parent
    said = subprocess.run(
        ["git", "rev-parse", "--short", "HEAD"], cwd=here, capture_output=True, encoding="utf-8", check=False
    )
    return said.stdout.strip() or "unknown"


def main() -> None:
    """Print the page; every result as it comes on standard error."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--best-known", type=Path, required=True)
    parser.add_argument("--time-limit", type=float, default=30.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--also", type=_set_and_seconds, action="append", default=[], metavar="SET=S")
    parser.add_argument("--remarks", type=Path, nargs="+", default=[], metavar="TEXT.md")
    given = parser.parse_args()
    best = read_best_known(given.best_known)
    limits = Limits(given.time_limit, given.seed, tuple(given.also))
    runs = []
    for name, seconds in limits.also:
        runs += run_set(f"{name} in {seconds:g} s", given.folder / name, best, seconds, limits.seed)
    for folder in sorted(path for path in given.folder.iterdir() if path.is_dir()):
        runs += run_set(folder.name, folder, best, limits.limit_s, limits.seed)
    print(page(runs, limits, given.remarks), end="")


def _set_and_seconds(text: str) -> tuple[str, float]:
    name, seconds = text.split("=")
    return name, float(seconds)


if __name__ == "__main__":
    main()
