"""What each number of `models/engines/tuning.py` is worth: made half as large, and half as large again.

Usage: python -m kerfwise.benchmarks.tuning [NAME …] [--work W] [--only PATTERN …] [--kept rows.json [--so-far]]
       > docs/tuning.md

Made plates (examples/gen_sheet.py) under the default profile, with and without zones, and with lags of two cuts, are
each solved within so much work (deterministic seconds, so that other programs change no figure); where kernels read a
number, by a process of its own. A row of numbers is changed as a whole; a whole number stays one, and is 1 at the
least. Rows that the file `--kept` has already are not made again; `--so-far` prints those and makes no others.
"""

from __future__ import annotations

import argparse
import ast
import json
import shlex
import subprocess
import sys
import textwrap
import tokenize
from collections.abc import Callable, Iterator
from fnmatch import fnmatchcase
from functools import cache, partial
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

import kerfwise
from kerfwise.models.engines import tuning

if TYPE_CHECKING:
    from kerfwise.models.problem.problem import Problem

PAGE = """\
# What the engines' numbers are worth

Made by `python -m kerfwise.benchmarks.tuning{given} > docs/tuning.md` with kerfwise {kerfwise}. Every number that the
engines go by stands in `models/engines/tuning.py`, with its unit and reason. Each of these was made half as large, and
half as large again, and {count} problems were solved anew within {work:g} deterministic seconds each: {problems}.

| number | value | half of it | half as much again |
|---|---:|---|---|
{rows}

*cost* and *bound* are changes of their sum over all problems, in %: a positive cost is dearer, a positive bound better.
{measured} of {all} numbers were measured, and {same} of these change neither by {shown:g} % or more:
{idle}.
"""
PROBLEMS = ("zones 41 1", "zones 115 5", "free 41 1", "free 60 3", "free 115 5", "lags 16 1")
WORK = 3.0
SHOWN = 0.1
"""Changes of fewer % are not shown."""
NONE = "–"
CHILD = """\
import json, sys
from kerfwise.models.engines import tuning
for name, value in json.loads(sys.argv[1]).items():
    setattr(tuning, name, tuple(value) if isinstance(value, list) else value)
from kerfwise.benchmarks.tuning import solve
print(json.dumps(solve(sys.argv[2].split(","), float(sys.argv[3]))))
"""
"""Changed before anything reads it: for numbers that are part of compiled kernels."""
ENGINES = "kerfwise.models.engines"


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


@cache
def plate(name: str) -> Problem:
    """A problem by its name, such as "zones 41 1"."""
    from kerfwise.benchmarks import engines

    kind, contours, seed = name.split()
    return engines.made(kind, int(contours), int(seed))


def solve(problems: list[str], work: float) -> dict[str, float]:
    """Sums of costs and bounds, µm, and processor seconds."""
    import time

    from kerfwise.models.engines.portfolio import run_portfolio
    from kerfwise.models.engines.solution import SolveOptions

    total = {"cost": 0.0, "bound": 0.0, "s": 0.0}
    for name in problems:
        problem = plate(name)
        began_s = time.process_time()
        found = run_portfolio(problem, SolveOptions(work=work))
        total["s"] += time.process_time() - began_s
        total["bound"] += found.bound_um
        total["cost"] += found.incumbent.cost if found.incumbent is not None else 1e12
    return total


def places(name: str) -> tuple[list[tuple[ModuleType, str]], bool]:
    """Where the engines have a number, each with its name there, and whether a compiled kernel reads it."""
    found, compiled = [], False
    for module in [module for key, module in sorted(sys.modules.items()) if key.startswith(ENGINES)]:
        if module is tuning or module.__file__ is None:
            continue
        for node in ast.parse(Path(module.__file__).read_text(encoding="utf-8")).body:
            if isinstance(node, ast.ImportFrom) and node.module == f"{ENGINES}.tuning":
                found += [(module, alias.asname or alias.name) for alias in node.names if alias.name == name]
        for _, there in [place for place in found if place[0] is module]:
            kernels = [kernel.py_func.__code__ for kernel in vars(module).values() if hasattr(kernel, "py_func")]
            compiled = compiled or any(there in code.co_names for code in kernels)
    return [*found, (tuning, name)], compiled


def measured(name: str, value: Any, problems: list[str], work: float) -> dict[str, float]:
    """What `solve` gives with another value of a number."""
    there, compiled = places(name)
    if compiled:
        command = [sys.executable, "-c", CHILD, json.dumps({name: value}), ",".join(problems), str(work)]
        done = subprocess.run(command, capture_output=True, encoding="utf-8", check=False)
        return {} if done.returncode else dict(json.loads(done.stdout.splitlines()[-1]))
    known = [getattr(module, at) for module, at in there]
    try:
        for module, at in there:
            setattr(module, at, value)
        return solve(problems, work)
    except Exception:  # a number that no longer fits those beside it
        return {}
    finally:
        for (module, at), was in zip(there, known, strict=True):
            setattr(module, at, was)


def words(known: dict[str, float], now: dict[str, float]) -> str:
    """What has changed."""
    if not now:
        return "ends in an error"
    share = {name: (now[name] / known[name] - 1) * 100 for name in known}
    parts = [f"{name} {share[name]:+.2f}%" for name in ("cost", "bound") if abs(share[name]) >= SHOWN]
    return ", ".join(parts) or NONE


def main() -> int:
    """Measure, and print the page."""
    arguments = argparse.ArgumentParser(description=str(__doc__).splitlines()[0])
    arguments.add_argument("names", nargs="*", help="patterns of names; else all")
    arguments.add_argument("--work", type=float, default=WORK)
    arguments.add_argument("--only", nargs="+", default=list(PROBLEMS), metavar="PROBLEM")
    arguments.add_argument("--kept", type=Path)
    arguments.add_argument("--so-far", action="store_true")
    given = arguments.parse_args()
    kept: dict[str, dict[str, float]] = {}
    if given.kept is not None and given.kept.exists():
        kept = json.loads(given.kept.read_text(encoding="utf-8"))

    def at(label: str, make: Callable[[], dict[str, float]]) -> dict[str, float]:
        if label not in kept:
            kept[label] = make()
            if given.kept is not None:
                given.kept.write_text(json.dumps(kept, indent=1), encoding="utf-8", newline="\n")
        return kept[label]

    if not given.so_far:
        solve(given.only, 0.1)  # kernels are compiled, libraries loaded
    known, rows, idle = at("as they are", lambda: solve(given.only, given.work)), [], []
    every = list(numbers())
    for name, value in every:
        chosen = not given.names or any(fnmatchcase(name, pattern) for pattern in given.names)
        labels = {factor: f"{name} x {factor}" for factor in (0.5, 1.5)}
        if not chosen or (given.so_far and not all(label in kept for label in labels.values())):
            continue
        cells = []
        for factor, label in labels.items():
            make = partial(measured, name, scaled(value, factor), given.only, given.work)
            cells.append(words(known, at(label, make)))
        if cells == [NONE, NONE]:
            idle.append(f"`{name}`")
        else:
            rows.append(f"| `{name}` | {value} | {' | '.join(cells)} |")
    only = "" if given.only == list(PROBLEMS) else f" --only {shlex.join(given.only)}"
    options = f" {shlex.join(given.names)}" * bool(given.names) + f" --work {given.work:g}{only}"
    options += f" --kept {shlex.quote(given.kept.name)} --so-far" * given.so_far
    print(
        PAGE.format(
            given=options, kerfwise=kerfwise.__version__, count=len(given.only), work=given.work,
            problems=", ".join(given.only), rows="\n".join(rows), measured=len(rows) + len(idle), all=len(every),
            same=len(idle), shown=SHOWN, idle=textwrap.fill(", ".join(idle), 119),
        ),
        end="",
    )  # fmt: skip
    return 0


if __name__ == "__main__":
    sys.exit(main())
