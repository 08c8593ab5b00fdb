"""Where the time of a `solve` goes, phase by phase and size by size, and how long a first and a later start take.

Usage: python benchmarks/phases.py [OTHER] [--contours 100 300 1000 3000 10000] [--work W] [--minutes M]
           [--starts NAME…] [--kept FOLDER] > docs/phases.md
       python benchmarks/phases.py [OTHER] --first [--contours 115 300 1000 3000 10000]

OTHER is an earlier checkout; with one, each figure stands twice, before and after, from the same run. Plates are made
by examples/gen_sheet.py, seed 1. Each plate and each start has a process of its own. Seconds are those of the
processor, all threads and processes together: other programs on the machine hardly change them. One row is by the
clock, for a machine that does nothing else. `OTHER --contours` alone compares a cold and a warm `solve` of 16 to 1000
contours. What takes more than M minutes of
those is ended: the phases that were over by then have their seconds, the others a stroke. With --kept the seconds of
each plate are kept in FOLDER, in a file for each checkout, with the kernels, and plates that stand there are not run
again: the largest take long. `--contours` without numbers measures the starts alone, `--starts` without names none.
Below the tables stands what phases_remarks.md says of them. `--first` prints one table alone: what a first plan takes
from the start of the process on, as `kerfwise solve --first` does, which goes into phases_remarks.md by hand.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from kerfwise.benchmarks import phase_clock
from kerfwise.benchmarks.checkout import Checkout
from kerfwise.benchmarks.phase_tables import FIRST, WHOLE, Spent, Start, phase_table, start_table
from kerfwise.examples.gen_sheet import make_sheet

HERE = Path(__file__).resolve().parents[1]
PAGE = """\
# Phases

Made by `python benchmarks/phases.py{given} > docs/phases.md` with {system}.{compared}
Seconds are processor seconds of all threads and processes together, but for the row by the clock.

## From file to picture

Plates of `examples/gen_sheet.py`, seed 1, under the default profile, {work:g} of work for the planning, kernels
compiled beforehand. `^` is the exponent from the size before: 1 is linear, 2 quadratic. Memory is the most that the
process held, libraries included, without what a process held that drew beside it. `by the clock` is what went by: what
is done side by side counts once, and other programs on the machine make it longer. Where a process was ended after
{minutes:g} minutes of the processor, `>` stands before the phase that it was in and before the sums, and a stroke where
a phase had not begun or a figure was not kept.

{phases}

## Starts

`kerfwise solve` in a process of its own. A cold start finds no compiled kernels and no compiled Python files, as the
first run after an installation does. `kernels` counts what it has compiled itself; seconds are of those processes, too,
that it begins.

{starts}
{remarks}"""
REMARKS = Path(__file__).with_name("phases_remarks.md")
MINUTES = 6.0
ALL_KERNELS = 1000
"""Plates of more contours take the kernels of those before them; all others, and the first, are run once to compile."""
STARTS: dict[str, tuple[str, ...]] = {
    "16 contours": ("e1x_6.json",),
    "16 contours, a limit of 5 s": ("e1x_6.json", "--time-limit", "5"),
    "41 contours": ("plate40.json", "--work", "5"),
    "115 contours": ("115", "--work", "1"),
    "308 contours": ("308", "--work", "1"),
    "1000 contours": ("1000", "--work", "1"),
}
"""What is started: an example, or a plate made of so many contours, and the options of `solve`."""
CHILD = """
import atexit, os, sys, time
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
    until = time.monotonic() + 60
    while hasattr(os, "WNOHANG") and time.monotonic() < until:
        try:
            os.waitpid(-1, os.WNOHANG)[0] or time.sleep(0.1)
        except ChildProcessError:
            break
    own = sum(name.startswith("kerfwise.") for name in compiled)
    sys.__stderr__.write(f"\\nused {own}\\n")
atexit.register(told)
from kerfwise import cli
getattr(cli, "run", cli.main)()
"""


class Tree(Checkout):
    """A checkout whose phases and starts are measured."""

    def ended(self, words: Sequence[str], kept: str, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
        """What a process said that must end well."""
        done = self.run(words, kept, cwd)
        if done.returncode:
            raise SystemExit(f"{self.tree}: {done.stderr[-2000:]}")
        return done

    def phases(
        self, contours: int, work: float, minutes: float, kept: Path | None = None, first: bool = False
    ) -> Spent:
        """See `phase_clock.spent`; from a file, or kept in one, where one is named."""
        if kept is not None and kept.exists():
            known: Spent = json.loads(kept.read_text(encoding="utf-8"))
            return known
        words = [phase_clock.__file__, str(contours), "--work", f"{work:g}", "--minutes", f"{minutes:g}"]
        words += ["--first"] if first else []
        line = self.ended(words, "warm").stdout.splitlines()[-1]
        if kept is not None:
            kept.write_text(f"{line}\n", encoding="utf-8", newline="\n")
        answer: Spent = json.loads(line)
        return answer

    def start(self, words: Sequence[str], kept: str) -> Start:
        """A `solve` of an example, or of a made plate."""
        nest, *options = words
        with tempfile.TemporaryDirectory() as out:
            path = HERE / "examples" / "nests" / nest
            if nest.isdecimal():
                path = Path(out) / "made.json"
                path.write_text(json.dumps(make_sheet(1, int(nest))), encoding="utf-8", newline="\n")
            before = os.times()
            done = self.ended(["-c", CHILD, "solve", str(path), *options], kept, Path(out))
        after = os.times()
        cpu_s = after.children_user + after.children_system - before.children_user - before.children_system
        return Start(round(cpu_s, 2), int(done.stderr.rpartition("\nused ")[2]))


def main() -> None:
    """Print the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("other", type=Path, nargs="?")
    parser.add_argument("--contours", type=int, nargs="*", default=[100, 300, 1000, 3000, 10_000])
    parser.add_argument("--work", type=float, default=2.0)
    parser.add_argument("--starts", nargs="*", choices=list(STARTS), default=list(STARTS))
    parser.add_argument("--minutes", type=float, default=MINUTES)
    parser.add_argument("--kept", type=Path, metavar="FOLDER")
    parser.add_argument("--first", action="store_true")
    given = parser.parse_args()
    if given.first:
        given.starts = []
    with tempfile.TemporaryDirectory() as folder:
        checkouts = [*([given.other.resolve()] if given.other else []), HERE]
        trees, plates = (
            [Tree(tree, (into / str(k + 2 - len(checkouts))).resolve()) for k, tree in enumerate(checkouts)]
            for into in (Path(folder), given.kept or Path(folder))
        )
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
            files = [kept_in(given.kept, k + 2 - len(plates), contours) for k in range(len(plates))]
            pairs_of = list(zip(plates, files, strict=True))
            for tree, file in pairs_of:
                if (contours <= ALL_KERNELS or not runs) and (file is None or not file.exists()):
                    tree.phases(contours, given.work, given.minutes, first=given.first)  # compiles
            runs.append(
                [tree.phases(contours, given.work, given.minutes, file, given.first) for tree, file in pairs_of]
            )
            print(runs[-1], file=sys.stderr, flush=True)
    if given.first:
        print(phase_table(runs, FIRST))
        return
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
            phases=phase_table(runs, WHOLE) if runs else "",
            starts=start_table(starts) if starts else "",
            remarks=f"\n{REMARKS.read_text(encoding='utf-8')}" if REMARKS.exists() else "",
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
