"""What each number of `models/engines/tuning.py` is worth: made half as large, and half as large again.

Usage: python -m kerfwise.benchmarks.tuning [NAME …] [--work W] [--only PATTERN …] [--kept rows.json] > docs/tuning.md

Made plates (examples/gen_sheet.py) under the default profile, with and without zones, and with lags of two cuts, are
each solved within so much work (deterministic seconds, so that other programs change no figure), by a process of its
own for every value. A row of numbers is changed as a whole; a whole number stays one, and is 1 at the least. Rows that
the file `--kept` has already are not made again.
"""

from __future__ import annotations

import argparse
import ast
import json
import subprocess
import sys
import tokenize
from collections.abc import Iterator
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

import kerfwise
from kerfwise.models.engines import tuning

PAGE = """\
# What the engines' numbers are worth

Made by `python -m kerfwise.benchmarks.tuning{given} > docs/tuning.md` with kerfwise {kerfwise}. Every number that the
engines go by stands in `models/engines/tuning.py`, with its unit and reason. Each of these was made half as large, and
half as large again, and {count} problems were solved anew within {work:g} deterministic seconds each: {problems}.

| number | value | half of it | half as much again |
|---|---:|---|---|
{rows}

*cost* and *bound* are changes of their sum over all problems, in %: a positive cost is dearer, a positive bound better.
*s* are processor seconds, where they change by more than a tenth; other programs on the machine have a part in those.
Names that are not listed were not measured: they say what a machine does in a second, how large tables may become, or
how often somebody is asked.
"""
PROBLEMS = ("zones 41 1", "zones 115 5", "free 41 1", "free 60 3", "free 115 5", "lags 16 1")
WORK = 3.0
SHOWN = 0.05
"""Changes of fewer % are not shown."""
CHILD = """\
import json, sys, time
from kerfwise.models.engines import tuning
for name, value in json.loads(sys.argv[1]).items():
    setattr(tuning, name, tuple(value) if isinstance(value, list) else value)
from kerfwise.benchmarks.tuning import solve
print(json.dumps(solve(sys.argv[2].split(","), float(sys.argv[3]))))
"""
"""Changed before anything reads it."""


def numbers() -> Iterator[tuple[str, Any]]:
    """Names and values of all numbers."""
    with tokenize.open(tuning.__file__) as file:
        tree = ast.parse(file.read())
    for node in tree.body:
        if isinstance(node, ast.Assign):
            for part in ast.walk(node.targets[0]):
                if isinstance(part, ast.Name):
                    yield part.id, getattr(tuning, part.id)


def scaled(value: Any, factor: float) -> Any:
    """A number, or a row of them, so many times as large."""
    if isinstance(value, tuple):
        return tuple(scaled(part, factor) for part in value)
    return max(1, round(value * factor)) if isinstance(value, int) else value * factor


def solve(problems: list[str], work: float) -> dict[str, float]:
    """Sums of costs and bounds, µm, and processor seconds."""
    import time

    from kerfwise.benchmarks import engines
    from kerfwise.models.engines.portfolio import run_portfolio
    from kerfwise.models.engines.solution import SolveOptions

    total = {"cost": 0.0, "bound": 0.0, "s": 0.0}
    for name in problems:
        kind, contours, seed = name.split()
        problem = engines.made(kind, int(contours), int(seed))
        began_s = time.process_time()
        found = run_portfolio(problem, SolveOptions(work=work))
        total["s"] += time.process_time() - began_s
        total["bound"] += found.bound_um
        total["cost"] += found.incumbent.cost if found.incumbent is not None else 1e12
    return total


def measured(changed: dict[str, Any], problems: list[str], work: float) -> dict[str, float]:
    """The same with some numbers changed, in a process of its own; kernels that read them are compiled anew."""
    command = [sys.executable, "-c", CHILD, json.dumps(changed), ",".join(problems), str(work)]
    done = subprocess.run(command, capture_output=True, encoding="utf-8", check=False)
    if done.returncode:
        return {}
    return dict(json.loads(done.stdout.splitlines()[-1]))


def words(known: dict[str, float], now: dict[str, float]) -> str:
    """What has changed."""
    if not now:
        return "ends in an error"
    share = {name: (now[name] / known[name] - 1) * 100 for name in known}
    parts = [f"{name} {share[name]:+.2f}%" for name in ("cost", "bound") if abs(share[name]) >= SHOWN]
    parts += [f"s {share['s']:+.0f}%"] if abs(share["s"]) > 10 else []
    return ", ".join(parts) or "–"


def main() -> int:
    """Measure, and print the page."""
    arguments = argparse.ArgumentParser(description=str(__doc__).splitlines()[0])
    arguments.add_argument("names", nargs="*", help="patterns of names; else all")
    arguments.add_argument("--work", type=float, default=WORK)
    arguments.add_argument("--only", nargs="+", default=list(PROBLEMS), metavar="PROBLEM")
    arguments.add_argument("--kept", type=Path)
    given = arguments.parse_args()
    kept: dict[str, dict[str, float]] = {}
    if given.kept is not None and given.kept.exists():
        kept = json.loads(given.kept.read_text(encoding="utf-8"))

    def at(label: str, changed: dict[str, Any]) -> dict[str, float]:
        if label not in kept:
            kept[label] = measured(changed, given.only, given.work)
            if given.kept is not None:
                given.kept.write_text(json.dumps(kept, indent=1), encoding="utf-8")
        return kept[label]

    known, rows = at("as they are", {}), []
    for name, value in numbers():
        if not given.names or any(fnmatchcase(name, pattern) for pattern in given.names):
            cells = (words(known, at(f"{name} x {factor}", {name: scaled(value, factor)})) for factor in (0.5, 1.5))
            rows.append(f"| `{name}` | {value} | {' | '.join(cells)} |")
    options = "".join(f" '{name}'" if "*" in name else f" {name}" for name in given.names)
    print(
        PAGE.format(
            given=options, kerfwise=kerfwise.__version__, count=len(given.only), work=given.work,
            problems=", ".join(given.only), rows="\n".join(rows),
        ),
        end="",
    )  # fmt: skip
    return 0


if __name__ == "__main__":
    sys.exit(main())
