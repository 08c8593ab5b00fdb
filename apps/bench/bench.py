"""Runs one engine on one file in a process of its own, and prints results beside the best costs known."""

from __future__ import annotations

import csv
import io
import json
import math
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.files import read_limited
from kerfwise.models.engines import Engine
from kerfwise.models.engines.tuning import MEMORY_GB

# Runs one engine on one file in a process of its own, so that its memory can be told from that of others.


@dataclass(frozen=True, slots=True)
class BenchJob:
    """What is to be run: a routing instance or a nest, and the limits (see `SolveOptions`)."""

    path: str
    engine: Engine = "portfolio"
    seed: int = 1
    work: float = 30.0
    time_s: float | None = None
    profile: str = ""
    trust: bool = False
    memory_gb: float = MEMORY_GB


@dataclass(frozen=True, slots=True)
class BenchResult:
    """What came of it.

    `cost` is in the file's own unit (mm of objective for nests), judged by code that shares nothing with the engines;
    `bound` is None where nothing is proven. `tour` holds the file's vertex numbers, contour ids for nests. `feasible`
    says that the judge found nothing wrong, `fault` what it found. `seconds` are wall-clock, from the file read to the
    answer, kernels loaded, `processor_s` those of all threads of the process in that time; `memory_mb` is the most the
    process held, the interpreter and its libraries included.
    """

    instance: str
    engine: Engine
    cost: float | None
    bound: float | None
    proven: bool
    feasible: bool
    seconds: float
    memory_mb: float
    tour: tuple[int | str, ...]
    fault: str = ""
    processor_s: float = 0.0


def measure(job: BenchJob) -> BenchResult:
    """Run a job and wait for it.

    Raises InputError if the file cannot be read, or the process dies, for example because memory runs out.
    """
    request = json.dumps({name: getattr(job, name) for name in job.__slots__})
    command = [sys.executable, "-X", "utf8", "-m", f"{__package__}.bench_child"]
    with subprocess.Popen(
        command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        encoding="utf-8",
        errors="replace",
        start_new_session=True,
        creationflags=getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0),  # the same on Windows
    ) as child:
        try:
            answer, output = child.communicate(request)
        except KeyboardInterrupt:
            child.kill()
            raise
    if child.returncode == 2:
        message, *details = output.strip().splitlines() or ["the file cannot be read"]
        raise InputError(message, details=tuple(line.removeprefix("  - ") for line in details))
    if child.returncode != 0:
        last = output.strip().splitlines()[-1:] or [f"exit code {child.returncode}"]
        raise InputError(f"the engine {job.engine} ended with an error: {last[0]}", file=job.path)
    fields = json.loads(answer)
    return BenchResult(**{**fields, "tour": tuple(fields["tour"])})


# The best costs that are known of instances, from a CSV file.

MOST_BYTES = 10_000_000
COSTS = ("best_upper", "best", "cost")


@dataclass(frozen=True, slots=True)
class BestKnown:
    """Cost by (set, instance); the set is the name of the folder that a file lies in, "" where the CSV has none."""

    costs: Mapping[tuple[str, str], float]

    def of(self, path: str | Path) -> float | None:
        """The best known cost of a file: of its set if the CSV has sets, else of its name alone."""
        path = Path(path).resolve()
        name = path.name.removesuffix(".gz").rsplit(".", 1)[0]
        return self.costs.get((path.parent.name, name), self.costs.get(("", name)))


def read_best_known(path: str | Path) -> BestKnown:
    """Read a CSV with columns `instance`, `best_upper` (or `best`, or `cost`), and, if names repeat, `set`.

    Raises InputError if the file cannot be read, a column is missing or a cost is not a number.
    """
    path = Path(path)
    try:
        text = read_limited(path, MOST_BYTES).decode("utf-8-sig")
        rows = list(csv.DictReader(io.StringIO(text, newline="")))
    except (OSError, ValueError, csv.Error) as error:  # ValueError: no UTF-8, or a name that no file can have
        raise InputError(f"cannot be read: {error}", file=path) from None
    columns = {name for name in rows[0] if name is not None} if rows else set()  # None: cells beyond the last column
    column = next((name for name in COSTS if name in columns), None)
    if column is None or "instance" not in columns:
        raise InputError(f"expected columns instance and one of {', '.join(COSTS)}; found {sorted(columns)}", file=path)
    costs: dict[tuple[str, str], float] = {}
    for number, row in enumerate(rows, start=2):
        try:
            if row[column]:
                costs[row.get("set") or "", row["instance"]] = _finite(row[column])
        except ValueError:
            raise InputError(f"{column} is not a number: {row[column]!r}", file=path, line=number) from None
    return BestKnown(costs)


def _finite(text: str) -> float:
    """The number that a text is; ValueError if it is none, or `nan` or `inf`."""
    number = float(text)
    if not math.isfinite(number):
        raise ValueError(text)
    return number


# Results as a table that is printed line by line, as its last line, and as JSON.

WIDTHS = (18, 13, 12, 12, 9, 7, 9, 9)
TITLES = ("instance", "engine", "cost", "best known", "gap", "proven", "seconds", "memory")


def head() -> str:
    """The titles."""
    return _joined(TITLES)


def line(result: BenchResult, best: float | None) -> str:
    """One result; the gap is to the best known cost."""
    bound = "" if result.bound is None else f"≥ {result.bound:g}"
    return _joined(
        (
            result.instance,
            result.engine,
            "none" if result.cost is None else f"{result.cost:g}",
            "" if best is None else f"{best:g}",
            "" if (gap := gap_to(result, best)) is None else f"{gap:+.2%}",
            "yes" if result.proven else bound,
            f"{result.seconds:.2f} s",
            f"{result.memory_mb:.0f} MB",
        )
    ) + (f"  {result.fault}" if result.fault else "")


def gap_to(result: BenchResult, best: float | None) -> float | None:
    """(cost - best) / best, None where either is not known."""
    if best is None or result.cost is None or not result.feasible:
        return None
    return (result.cost - best) / best if best else float(result.cost > 0)


def results_in_all(results: Sequence[BenchResult], bests: Sequence[float | None]) -> str:
    """How many, how good."""
    gaps = [gap for r, b in zip(results, bests, strict=True) if (gap := gap_to(r, b)) is not None]
    words = [
        f"{len(results)} runs",
        f"{sum(r.feasible for r in results)} feasible",
        f"{sum(r.proven for r in results)} proven",
    ]
    if gaps:
        words.append(f"at or under best known {sum(g <= 0 for g in gaps)} of {len(gaps)}")
        words.append(f"mean gap {sum(gaps) / len(gaps):.3%}, worst {max(gaps):.2%}")
    words.append(
        f"{sum(r.seconds for r in results):.1f} s, at most {max((r.memory_mb for r in results), default=0):.0f} MB"
    )
    return ", ".join(words)


def results_as_json(results: Sequence[BenchResult]) -> str:
    """A list of objects, one a run."""
    return json.dumps([asdict(result) for result in results], indent=1)


def _joined(cells: Sequence[str]) -> str:
    first, *rest = zip(cells, WIDTHS, strict=True)
    return first[0].ljust(first[1]) + "".join(" " + cell.rjust(width) for cell, width in rest)
