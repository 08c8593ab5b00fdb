"""Where the time of a `solve` goes, phase by phase and size by size, and how long a first and a later start take.

Usage: python benchmarks/phases.py [OTHER] [--contours 100 300 1000 3000 10000] [--work W] [--minutes M]
           [--starts NAME…] [--kept FOLDER] > docs/phases.md

OTHER is an earlier checkout; with one, each figure stands twice, before and after, from the same run. Plates are made
by examples/gen_sheet.py, seed 1. Each plate and each start has a process of its own. Seconds are those of the
processor, all threads together: other programs on the machine hardly change them. What takes more than M minutes of
those is ended: the phases that were over by then have their seconds, the others a stroke. With --kept the seconds of
each plate are kept in FOLDER, in a file for each checkout, and plates that stand there are not run again: the largest
take long.
"""

from __future__ import annotations

import argparse
import importlib
import json
import math
import os
import platform
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from kerfwise.examples.gen_sheet import contour_count, make_sheet

HERE = Path(__file__).resolve().parents[1]
PAGE = """\
# Phases

Made by `python benchmarks/phases.py{given} > docs/phases.md` with {system}.{compared}
Seconds are processor seconds of all threads together.

## From file to picture

Plates of `examples/gen_sheet.py`, seed 1, under the default profile, {work:g} of work for the planning, kernels
compiled beforehand. `^` is the exponent from the size before: 1 is linear, 2 quadratic. Memory is the most that the
process held, libraries included. Where a process was ended after {minutes:g} minutes of the processor, `>` stands
before the phase that it was in and before the sums, and a stroke where a phase had not begun.

{phases}

## Starts

`kerfwise solve` in a process of its own. A cold start finds no compiled kernels and no compiled Python files, as the
first run after an installation does. `kernels` counts what was compiled.

{starts}
"""
PHASES: dict[str, tuple[tuple[str, str], ...]] = {
    "read": (("kerfwise.encoder.readers.json_nest", "read_json"),),
    "candidates": (("kerfwise.jobs.ask", "build_with_older_kerfs"),),
    "facts": (("kerfwise.jobs.ask", "compute_facts"), ("kerfwise.jobs.ask", "contour_heat_kj")),
    "rules": (("kerfwise.jobs.ask", "state_rules"),),
    "problem": (("kerfwise.models.engines.rounds", "make_problem"), ("kerfwise.models.engines.rounds", "simplify")),
    "planning": (("kerfwise.models.engines.rounds", "run_portfolio"),),
    "looks at whole orders": (),
    "plan and its reasons": (("kerfwise.jobs.produce", "make_plan"), ("kerfwise.jobs.produce", "with_times")),
    "program": (("kerfwise.jobs.produce", "write_program"),),
    "check": (("kerfwise.jobs.produce", "judge"),),
    "picture": (("kerfwise.postproc.report", "draw"),),
}
"""Phase → the functions it is made by, where they are called from; what is called within one counts there only."""
MINUTES = 6.0
LOOK_S = 0.5
"""How often a process looks at whether it has taken too long."""
Spent = dict[str, Any]
"""Seconds by phase and what goes with them, see `spent`; `contours` is how many there are."""
REST, ALL, BUT_PLANNING, MEMORY = "all else", "all", "all but planning", "memory, MB"
STARTS: dict[str, tuple[str, ...]] = {
    "16 contours": ("e1x_6.json",),
    "16 contours, a limit of 5 s": ("e1x_6.json", "--time-limit", "5"),
    "41 contours": ("plate40.json", "--work", "5"),
}
CHILD = """
import atexit, sys, time
compiled = []
def note():
    import numba.core.event as event
    class Compiled(event.Listener):
        def on_start(self, told): compiled.append(told.data["dispatcher"].py_func.__module__)
        def on_end(self, told): pass
    event.register("numba:compile", Compiled())
class Finder:
    def find_spec(self, name, path=None, target=None):
        if name == "numba.core.registry":
            sys.meta_path.remove(self)
            import numba.core.event
            note()
sys.meta_path.insert(0, Finder())
def told():
    own = sum(name.startswith("kerfwise.") for name in compiled)
    sys.__stderr__.write(f"\\nused {time.process_time():.2f} {own}\\n")
atexit.register(told)
from kerfwise.cli import main
main()
"""


class Clock:
    """Processor seconds by phase; a phase within a phase counts for itself alone."""

    def __init__(self) -> None:
        self.seconds = dict.fromkeys(PHASES, 0.0)
        self._running: list[str] = []
        self._begun: list[str] = []
        self._since_s = time.process_time()

    @contextmanager
    def phase(self, name: str) -> Iterator[None]:
        """Count for a phase."""
        self._turn()
        self._running.append(name)
        self._begun.append(name)
        try:
            yield
        finally:
            self._turn()
            self._running.pop()

    def _turn(self) -> None:
        now_s = time.process_time()
        if self._running:
            self.seconds[self._running[-1]] += now_s - self._since_s
        self._since_s = now_s

    def so_far(self) -> tuple[dict[str, float], list[str], list[str]]:
        """Seconds of every phase up to now, those that are running, and those that were never begun."""
        self._turn()
        return dict(self.seconds), list(self._running), [name for name in PHASES if name not in self._begun]

    def around(self, name: str, step: Callable[..., Any]) -> Callable[..., Any]:
        """The same function, counted."""

        def run(*given: Any, **options: Any) -> Any:
            with self.phase(name):
                return step(*given, **options)

        return run


def spent(contours: int, work: float, told: Callable[[dict[str, Any]], None], most_s: float = math.inf) -> None:
    """Plan, write, check and draw one plate in this process; tell processor seconds by phase, and the memory.

    After `most_s` of the processor that is told and the process ended; `running` and `missing` are then the phases that
    it was in, and those that it never began.
    """
    from kerfwise.encoder.readers import ReadOptions
    from kerfwise.jobs.bench.memory import peak_mb
    from kerfwise.jobs.given import Given
    from kerfwise.jobs.main_job import plan_nest
    from kerfwise.jobs.solve_options import options_for
    from kerfwise.rules.profile.profile import load_profile

    text = json.dumps(make_sheet(1, contours)).encode()
    profile = load_profile()
    clock = Clock()
    for name, steps in PHASES.items():
        for module, step in steps:
            place = importlib.import_module(module)
            if hasattr(place, step):
                setattr(place, step, clock.around(name, getattr(place, step)))
    _around_looks(clock)
    began_s = time.process_time()

    def tell(ended: bool) -> None:
        seconds, running, missing = clock.so_far()
        whole_s = time.process_time() - began_s
        sums = {REST: whole_s - sum(seconds.values()), ALL: whole_s, BUT_PLANNING: whole_s - seconds["planning"]}
        told({**seconds, **sums, MEMORY: peak_mb(), "ended": ended, "running": running, "missing": missing})

    threading.Thread(target=_end_after, args=(began_s + most_s, tell), daemon=True).start()
    nest = importlib.import_module("kerfwise.encoder.readers.json_nest").read_json(text, ReadOptions())
    limits = options_for(nest, profile, work=work)
    made = plan_nest(Given(nest, profile), limits).made
    if not made.verdict.ok:
        raise SystemExit("the check refuses the plan")
    importlib.import_module("kerfwise.postproc.report").draw(nest, made.plan, ".svg", profile.home_on(nest))
    tell(False)


def _end_after(most_s: float, tell: Callable[[bool], None]) -> None:
    """End the process once it has taken so many seconds of the processor."""
    while time.process_time() < most_s:
        time.sleep(LOOK_S)
    tell(True)
    sys.stdout.flush()
    os._exit(0)


def _around_looks(clock: Clock) -> None:
    """Count what rules that judge a whole order find wrong with those that are tried."""
    place: Any = importlib.import_module("kerfwise.jobs.produce")
    plain = place.afterthoughts

    def counted(*given: Any) -> Callable[..., Any]:
        return clock.around("looks at whole orders", plain(*given))

    place.afterthoughts = counted


@dataclass(frozen=True)
class Start:
    """What a start took."""

    cpu_s: float
    kernels: int


class Tree:
    """A checkout, run by this Python in processes of its own, with compiled Python files and kernels of its own."""

    def __init__(self, checkout: Path, folder: Path) -> None:
        self.folder = folder
        package = folder / "package"
        package.mkdir(parents=True)
        (package / "kerfwise").symlink_to(checkout, target_is_directory=True)
        self.checkout, self.package = checkout, package

    def run(self, words: Sequence[str], kept: str, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
        """Run Python with what is kept under a name."""
        unset = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
        places = {
            "PYTHONPATH": str(self.package),
            "PYTHONPYCACHEPREFIX": str(self.folder / kept / "python"),
            "NUMBA_CACHE_DIR": str(self.folder / kept / "kernels"),
        }
        done = subprocess.run(
            [sys.executable, *words],
            cwd=cwd or self.folder,
            env={**unset, **places},
            capture_output=True,
            encoding="utf-8",
            check=False,
        )
        if done.returncode:
            raise SystemExit(f"{self.checkout}: {done.stderr[-2000:]}")
        return done

    def phases(self, contours: int, work: float, minutes: float, kept: Path | None = None) -> Spent:
        """See `spent`; from a file, or kept in one, where one is named."""
        if kept is not None and kept.exists():
            known: Spent = json.loads(kept.read_text(encoding="utf-8"))
            return known
        words = [__file__, "--one", str(contours), "--work", f"{work:g}", "--minutes", f"{minutes:g}"]
        line = self.run(words, "warm").stdout.splitlines()[-1]
        if kept is not None:
            kept.write_text(f"{line}\n", encoding="utf-8", newline="\n")
        answer: Spent = json.loads(line)
        return answer

    def start(self, words: Sequence[str], kept: str) -> Start:
        """A `solve` of an example."""
        nest, *options = words
        with tempfile.TemporaryDirectory() as out:
            path = HERE / "examples" / "nests" / nest
            done = self.run(["-c", CHILD, "solve", str(path), *options], kept, Path(out))
        cpu_s, kernels = done.stderr.rpartition("\nused ")[2].split()
        return Start(float(cpu_s), int(kernels))


def exponent(sizes: tuple[float, float], seconds: tuple[float, float]) -> str:
    """By what power of the size it grew, "" where it is too quick to say.

    Examples
    --------
    >>> exponent((100, 1000), (1.0, 100.0)), exponent((100, 1000), (0.01, 0.02))
    ('2.0', '')
    """
    if min(seconds) < 0.05:
        return ""
    return f"{math.log(seconds[1] / seconds[0]) / math.log(sizes[1] / sizes[0]):.1f}"


def phase_table(runs: Sequence[Sequence[Spent]]) -> str:
    """Rows of phases; `runs` has for each size what each checkout took."""
    heads, aligned = ["phase"], ["---"]
    for of_size in runs:
        told = f"{of_size[-1]['contours']:.0f}"
        heads += [f"{told}, before", "after", "^"] if len(of_size) > 1 else [told, "^"]
        aligned += ["---:"] * (len(of_size) + 1)
    rows = []
    for name in (*PHASES, REST, ALL, BUT_PLANNING, MEMORY):
        cells = [name]
        for k, of_size in enumerate(runs):
            cells += [_cell(run, name) for run in of_size]
            pair = (runs[k - 1][-1], of_size[-1]) if k else None
            cells.append(_growth(pair, name) if pair and name != MEMORY else "")
        rows.append(cells)
    return _lines([heads, aligned, *rows])


def _cell(run: Spent, name: str) -> str:
    """Seconds, or MB, of a phase; more than that where it was ended meanwhile, a stroke where it was before."""
    if name in run.get("missing", ()):
        return "–"
    told = f"{run[name]:.0f}" if name == MEMORY else f"{run[name]:.2f}"
    return f"> {told}" if _cut_short(run, name) else told


def _cut_short(run: Spent, name: str) -> bool:
    """Whether a process was ended before, or in, a phase, or while what counts for all phases was counted."""
    of_all = name in (REST, ALL, BUT_PLANNING, MEMORY)
    return bool(run.get("ended")) and (of_all or name in run["running"] or name in run["missing"])


def _growth(pair: tuple[Spent, Spent], name: str) -> str:
    one, two = pair
    if _cut_short(one, name) or _cut_short(two, name):
        return ""
    return exponent((one["contours"], two["contours"]), (one[name], two[name]))


def start_table(rows: Sequence[tuple[str, Sequence[tuple[Start, Start]]]]) -> str:
    """Rows of starts: cold and warm, of each checkout."""
    several = len(rows[0][1]) > 1
    heads, aligned = ["nest"], ["---"]
    for when in ("before", "after") if several else ("",):
        of = f", {when}" if when else ""
        heads += [f"cold{of}, s", f"kernels{of}", f"warm{of}, s"]
        aligned += ["---:"] * 3
    body = []
    for name, pairs in rows:
        cells = [name]
        for cold, warm in pairs:
            cells += [f"{cold.cpu_s:.1f}", str(cold.kernels), f"{warm.cpu_s:.1f}"]
        body.append(cells)
    return _lines([heads, aligned, *body])


def _lines(rows: Sequence[Sequence[str]]) -> str:
    return "\n".join(f"| {' | '.join(cells)} |" for cells in rows)


def main() -> None:
    """Print the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("other", type=Path, nargs="?")
    parser.add_argument("--contours", type=int, nargs="*", default=[100, 300, 1000, 3000, 10_000])
    parser.add_argument("--work", type=float, default=2.0)
    parser.add_argument("--starts", nargs="*", choices=list(STARTS), default=list(STARTS))
    parser.add_argument("--minutes", type=float, default=MINUTES)
    parser.add_argument("--kept", type=Path, metavar="FOLDER")
    parser.add_argument("--one", type=int, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.one is not None:
        contours = contour_count(make_sheet(1, given.one))
        spent(given.one, given.work, lambda told: print(json.dumps(told | {"contours": contours})), 60 * given.minutes)
        return
    with tempfile.TemporaryDirectory() as folder:
        checkouts = [*([given.other.resolve()] if given.other else []), HERE]
        trees = [Tree(checkout, Path(folder) / str(k)) for k, checkout in enumerate(checkouts)]
        starts: list[tuple[str, list[tuple[Start, Start]]]] = []
        for name in given.starts:
            pairs = []
            for k, tree in enumerate(trees):
                cold = tree.start(STARTS[name], f"start {len(starts)}")
                pairs.append((cold, tree.start(STARTS[name], f"start {len(starts)}")))
                print(f"{name}, checkout {k + 1}: {pairs[-1]}", file=sys.stderr, flush=True)
            starts.append((name, pairs))
        runs: list[list[Spent]] = []
        for contours in given.contours:
            files = [kept_in(given.kept, k + 2 - len(trees), contours) for k in range(len(trees))]
            for tree, file in zip(trees, files, strict=True):
                if not runs and (file is None or not file.exists()):
                    tree.phases(contours, given.work, given.minutes)  # compiles
            runs.append(
                [
                    tree.phases(contours, given.work, given.minutes, file)
                    for tree, file in zip(trees, files, strict=True)
                ]
            )
            print(runs[-1], file=sys.stderr, flush=True)
    words = [*(["OTHER"] if given.other else []), *_sizes(given, parser)]
    system = f"Python {platform.python_version()}, {platform.system()} {platform.machine()}, {os.cpu_count()} cores"
    compared = "\n`before` is an earlier checkout, OTHER, and `after` this one, in the same run."
    print(
        PAGE.format(
            given="".join(f" {word}" for word in words),
            system=system,
            compared=compared if given.other else "",
            work=given.work,
            minutes=given.minutes,
            phases=phase_table(runs) if runs else "",
            starts=start_table(starts) if starts else "",
        ),
        end="",
    )


def kept_in(folder: Path | None, which: int, contours: int) -> Path | None:
    """Where the seconds of a plate are kept."""
    return None if folder is None else folder / f"{('before', 'after')[which]}.{contours}.json"


def _sizes(given: argparse.Namespace, parser: argparse.ArgumentParser) -> list[str]:
    """What was asked for that the page would not have without being asked."""
    said = [] if given.contours == parser.get_default("contours") else ["--contours", *map(str, given.contours)]
    said += [] if given.work == parser.get_default("work") else ["--work", f"{given.work:g}"]
    return said + ([] if given.minutes == parser.get_default("minutes") else ["--minutes", f"{given.minutes:g}"])


if __name__ == "__main__":
    main()
