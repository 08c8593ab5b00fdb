"""How kerfwise fares on the field's own routing benchmarks.

Usage: python benchmarks/routing.py FOLDER --best-known CSV [--time-limit S | --work W] [--seed N] [--also SET=S …]
           [--only PATTERN …] [--together] [--keep FILE] [--remarks TEXT.md …] > docs/routing.md

FOLDER holds a folder for every set, with `.pcglns` and `.sop` files in it, gzipped or not; the CSV has columns set,
instance and best_upper. Prints the page: every instance run once by the default engine, judged, beside the best cost
known; what is worse than that comes first, then remarks that people wrote, and what
`sparse_orders.py` printed. `--also cnc=1` runs a set once more, with another limit. `--only soplib/R.*.1` runs the
instances alone whose set and name fit one of the patterns; sets run again do not heed it. `--also cnc/e1x_*=30` runs
those of a set once more that fit the pattern. With `--together` all run in
one process, which saves that of each its start; memory is then the most until then. With `--work` the limits are
deterministic, so that other programs on the machine change no cost and no bound, and what they took is counted in
seconds of processor. FILE keeps each result as it comes, with the commit; what it has is not run again. Where the page
has results of several commits, every set says which its own are of.
"""

from __future__ import annotations

import argparse
import datetime
import json
import os
import platform
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from fnmatch import fnmatchcase
from importlib.metadata import version
from pathlib import Path

import kerfwise
from kerfwise.apps.bench.bench import BenchJob, BenchResult, BestKnown, gap_to, measure, read_best_known, results_in_all
from kerfwise.apps.bench.bench_child import run_in_child
from kerfwise.models.routing import is_instance

PAGE = """\
# Routing benchmarks

The core of kerfwise solves the precedence-constrained generalised travelling salesman problem, and with one vertex a
cluster the sequential ordering problem. These are the field's instances, run by

    python benchmarks/routing.py FOLDER --best-known CSV {limit} --seed {seed}{also}

on {date}, kerfwise {kerfwise} at {commit}, Python {python}, numba {numba}, OR-Tools {ortools}, {machine}.
{process} The clock runs from the file read to the answer, with compiled kernels loaded.
{counted}
Tours are judged by code that shares nothing with the engines. A cost is proven where the engine showed that no tour
is cheaper; elsewhere the bound that it did prove stands beside it, and how far the cost is above that. Where no best
known cost is published, the cost that a longer run on this page proved stands for it. Memory is the most that the
process held{so_far}, some {base:.0f} MB of it the interpreter and its libraries.
One instance: `kerfwise bench FILE {limit}`.

{summary}

## Where it is worse than the best known

{worse}
{remarks}
{sets}
"""
APART, TOGETHER = "Every instance has a process of its own.", "All instances run in one process, one after the other."
BY_CLOCK = "Limits are seconds by the clock; seconds of processor are those of all threads together."
BY_WORK = """\
Limits are in work, which is deterministic: other programs on the machine change no cost and no bound, but they do
change the seconds by the clock. A unit of work is meant to be about a second of each thread on a machine that has
nothing else to do. What was really taken stands beside it, in seconds of processor, all threads together."""


@dataclass(frozen=True)
class Run:
    """One instance of one set; `set` says the limit too where a set is run with several."""

    set: str
    result: BenchResult
    best: float | None
    commit: str = ""

    @property
    def gap(self) -> float | None:
        """To the best known cost."""
        return gap_to(self.result, self.best)

    @property
    def over_bound(self) -> float | None:
        """To the bound that was proven; None where there is none above 0."""
        return gap_to(self.result, self.result.bound) if self.result.bound else None

    def __str__(self) -> str:
        r = self.result
        gap = "" if self.gap is None else f"{self.gap:+.2%}"
        bound = "yes" if r.proven else "" if r.bound is None else f"≥ {r.bound:g}"
        over = "" if r.proven or self.over_bound is None else f"{self.over_bound:+.1%}"
        best = "" if self.best is None else f"{self.best:g}"
        cost = "none" if r.cost is None else f"{r.cost:g}"
        taken = f"{r.seconds:.1f} | {r.processor_s:.1f} | {r.memory_mb:.0f}"
        return f"| {r.instance} | {cost} | {best} | {gap} | {bound} | {over} | {taken} |"


HEAD = (
    "| instance | cost | best known | gap | proven | above that | s | processor, s | MB |\n"
    "|---|---:|---:|---:|---:|---:|---:|---:|---:|\n"
)


@dataclass(frozen=True)
class Limits:
    """For every instance of every set, seconds by the clock or `work`; `also`: sets to run again, with how much.

    `only` are patterns of SET/INSTANCE. `together` has all run in this process.
    """

    limit: float
    seed: int
    also: tuple[tuple[str, float], ...] = ()
    by_work: bool = False
    only: tuple[str, ...] = ()
    together: bool = False

    @property
    def option(self) -> str:
        """As the command line has it."""
        return f"--{'work' if self.by_work else 'time-limit'} {self.limit:g}"

    def job(self, path: Path, limit: float) -> BenchJob:
        """What is to be run."""
        if self.by_work:
            return BenchJob(str(path), seed=self.seed, work=limit)
        return BenchJob(str(path), seed=self.seed, time_s=limit)

    def wanted(self, path: Path) -> bool:
        """Whether a file is an instance that is to be run."""
        name = f"{path.parent.name}/{path.name.removesuffix('.gz').rsplit('.', 1)[0]}"
        return is_instance(path) and (not self.only or any(fnmatchcase(name, pattern) for pattern in self.only))


def run_set(name: str, folder: Path, best: BestKnown, limit: float, limits: Limits, kept: Kept) -> list[Run]:
    """Every instance of a folder that is wanted, as a set of that name."""
    run, runs = run_in_child if limits.together else measure, []
    for path in sorted(folder.iterdir()):
        if limits.wanted(path):
            job = limits.job(path, limit)
            key = f"{name} {path.name} {job.work:g} {job.time_s} {job.seed}"
            result = kept.result(key) or kept.keep(key, run(job))
            runs.append(Run(name, result, best.of(path), kept.commit(key)))
            print(runs[-1], file=sys.stderr, flush=True)
    return runs


class Kept:
    """Results as they came, and the commits that they are of; in a file, if one is named."""

    def __init__(self, file: Path | None = None) -> None:
        self._file = file
        lines = file.read_text(encoding="utf-8").splitlines() if file is not None and file.exists() else []
        self._known = {row["key"]: row for row in map(json.loads, lines)}
        self._used: dict[str, None] = {}

    def commit(self, key: str) -> str:
        """That a result is of."""
        return str(self._known[key]["commit"])

    def result(self, key: str) -> BenchResult | None:
        """What is known."""
        if (row := self._known.get(key)) is None:
            return None
        self._used[row["commit"]] = None
        return BenchResult(**{**row["result"], "tour": tuple(row["result"]["tour"])})

    def keep(self, key: str, result: BenchResult) -> BenchResult:
        """The same result, kept."""
        commit = _commit()
        row = {"key": key, "commit": commit, "result": asdict(result)}
        self._used[commit], self._known[key] = None, row
        if self._file is not None:
            with self._file.open("a", encoding="utf-8", newline="\n") as file:
                file.write(json.dumps(row) + "\n")
        return result

    @property
    def commits(self) -> str:
        """Those of all results that were asked for."""
        return ", ".join(self._used) or _commit()


def with_proven(runs: Sequence[Run]) -> list[Run]:
    """The same; where no best known cost is published, a cost that a run of the instance proved stands for it."""
    proven = {run.result.instance: run.result.cost for run in runs if run.result.proven and run.result.feasible}
    return [run if run.best is not None else replace(run, best=proven.get(run.result.instance)) for run in runs]


def page(runs: Sequence[Run], limits: Limits, remarks: Sequence[Path] = (), commits: str = "unknown") -> str:
    """The whole page."""
    names, several = list(dict.fromkeys(run.set for run in runs)), len({run.commit for run in runs}) > 1
    of = {name: [run for run in runs if run.set == name] for name in names}
    worse = [run for run in runs if not run.result.feasible or (run.gap is not None and run.gap > 0)]
    return PAGE.format(
        limit=limits.option,
        seed=limits.seed,
        also="".join(f" --also {name}={amount:g}" for name, amount in limits.also)
        + "".join(f" --only {pattern}" for pattern in limits.only)
        + (" --together" if limits.together else "")
        + (f" --remarks {' '.join(text.name for text in remarks)}" if remarks else ""),
        process=TOGETHER if limits.together else APART,
        so_far=" until then" if limits.together else "",
        counted=BY_WORK if limits.by_work else BY_CLOCK,
        remarks="".join(f"\n{text.read_text(encoding='utf-8')}" for text in remarks),
        date=datetime.date.today().isoformat(),
        kerfwise=kerfwise.__version__,
        commit=f"commit {commits}",
        python=platform.python_version(),
        numba=version("numba"),
        ortools=version("ortools"),
        machine=f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores",
        base=min(run.result.memory_mb for run in runs),
        summary="\n".join(f"- **{name}**: {_in_all(of[name])}" for name in names),
        worse="| set " + HEAD.replace("|---|", "|---|---|", 1) + "\n".join(f"| {r.set} {r}" for r in worse)
        if worse
        else "Nowhere.",
        sets="\n\n".join(
            f"## {name}\n\n{_of_commits(of[name]) if several else ''}{HEAD}" + "\n".join(map(str, of[name]))
            for name in names
        ),
    )


def _of_commits(runs: Sequence[Run]) -> str:
    """What the results of a set are of."""
    return f"At commit {', '.join(dict.fromkeys(run.commit for run in runs))}.\n\n"


def _in_all(runs: Sequence[Run]) -> str:
    """One line about the runs of a set."""
    said = results_in_all([run.result for run in runs], [run.best for run in runs])
    said += f", {sum(run.result.processor_s for run in runs):.0f} s of processor"
    above = [run.over_bound for run in runs if run.over_bound is not None]
    return said + (f", at most {max(above):.1%} above what is proven" if above else "")


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
    limit = parser.add_mutually_exclusive_group()
    limit.add_argument("--time-limit", type=float, default=30.0)
    limit.add_argument("--work", type=float)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--also", type=_set_and_amount, action="append", default=[], metavar="SET=S")
    parser.add_argument("--only", action="append", default=[], metavar="PATTERN")
    parser.add_argument("--together", action="store_true")
    parser.add_argument("--keep", type=Path, metavar="FILE")
    parser.add_argument("--remarks", type=Path, nargs="+", default=[], metavar="TEXT.md")
    given = parser.parse_args()
    best = read_best_known(given.best_known)
    by_work = given.work is not None
    amount = given.work if by_work else given.time_limit
    limits = Limits(amount, given.seed, tuple(given.also), by_work, tuple(given.only), given.together)
    runs, kept = [], Kept(given.keep)
    for name, less in limits.also:
        title = f"{name} with {less:g} of work" if by_work else f"{name} in {less:g} s"
        asked = replace(limits, only=(name,) if "/" in name else ())
        runs += run_set(title, given.folder / name.partition("/")[0], best, less, asked, kept)
    for folder in sorted(path for path in given.folder.iterdir() if path.is_dir()):
        runs += run_set(folder.name, folder, best, limits.limit, limits, kept)
    print(page(with_proven(runs), limits, given.remarks, kept.commits), end="")


def _set_and_amount(text: str) -> tuple[str, float]:
    name, amount = text.split("=")
    return name, float(amount)


if __name__ == "__main__":
    main()
