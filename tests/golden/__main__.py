"""Plans, programs and verdicts of some cases, held against what is kept of them: what has changed, in words.

Usage: python -m kerfwise.tests.golden [--renew] [--texts] [CASE…]

Exit code 1 if anything means something else than before. Other wording is counted, and shown with --texts, which also
makes it count. --renew keeps what is there now; with --texts it keeps the new wording, and nothing else.
"""

from __future__ import annotations

import argparse
import difflib
import fnmatch
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

from kerfwise.tests.golden import kept
from kerfwise.tests.golden.compare import changes
from kerfwise.tests.golden.run import Ran, cases, timed

SHOWN = 14


def main(argv: list[str] | None = None) -> int:
    """Run the cases that are named, or all; the exit code."""
    arguments = argparse.ArgumentParser(prog="python -m kerfwise.tests.golden", description=__doc__)
    arguments.formatter_class = argparse.RawDescriptionHelpFormatter
    arguments.add_argument("cases", nargs="*", metavar="CASE", help="a name, or a pattern such as 'tabs*'; else all")
    arguments.add_argument("--renew", action="store_true", help="keep what is there now")
    arguments.add_argument("--texts", action="store_true", help="other wording counts, and is shown")
    arguments.add_argument("--into", type=Path, metavar="DIR", help="leave what the cases write in this folder")
    arguments.add_argument("--processes", type=int, default=2, help="cases that run at the same time (default 2)")
    arguments.add_argument("-v", "--verbose", action="store_true", help="show all changes of a case, and its seconds")
    given = arguments.parse_args(argv)
    every = cases()
    chosen = {n: c for n, c in every.items() if not given.cases or any(fnmatch.fnmatch(n, p) for p in given.cases)}
    if not chosen:
        arguments.error(f"no case is called {', '.join(given.cases)}; there are {', '.join(every)}")
    began = time.perf_counter()
    changed, reworded, failed = 0, 0, 0
    for ran, seconds in _all(chosen, given.into, given.processes):
        old, old_texts = kept.read(ran.name)
        differ = [] if old is None else changes(old, ran.means)
        lines = ["nothing is kept of this case yet: --renew keeps it"] if old is None else differ
        words = _reworded(old_texts or "", ran.texts)
        changed += bool(lines)
        failed += "error" in ran.means
        reworded += bool(words)
        _tell(ran.name, lines, words if given.texts else [], given.verbose, seconds)
        if given.renew and "error" not in ran.means:
            kept.write(ran.name, None if given.texts and old is not None else ran.means, ran.texts)
    for name in sorted(kept.names() - set(every)) if not given.cases else ():
        changed += 1
        print(f"{name}: the case is not there any more; --renew removes what is kept of it")
        if given.renew:
            kept.remove(name)
    print(
        f"{len(chosen)} cases in {time.perf_counter() - began:.0f} s: {changed} changed, {reworded} with other texts"
        + ("; kept as they are now" if given.renew else "")
    )
    counted = changed if not given.texts else changed + reworded
    return 1 if failed or (counted and not given.renew) else 0


def _all(chosen: dict[str, dict[str, object]], into: Path | None, processes: int) -> Iterator[tuple[Ran, float]]:
    """The cases as they are finished, in the order of the table."""
    with ProcessPoolExecutor(processes, get_context("spawn")) as pool:
        yield from (one.result() for one in [pool.submit(timed, n, c, into) for n, c in chosen.items()])


def _reworded(old: str, new: str) -> list[str]:
    """Lines of text that went, and that came."""
    lines = difflib.unified_diff(old.splitlines(), new.splitlines(), lineterm="", n=0)
    return [line for line in lines if not line.startswith(("---", "+++", "@@"))]


def _tell(name: str, changed: list[str], words: list[str], verbose: bool, seconds: float) -> None:
    if verbose and not changed and not words:
        print(f"{name}: as before ({seconds:.1f} s)", flush=True)
    for title, lines in ((name, changed), (f"{name}, texts", words)):
        if lines:
            print(f"{title}:" + (f" ({seconds:.1f} s)" if verbose else ""))
            shown = lines if verbose else lines[:SHOWN]
            print("\n".join(f"  {line}" for line in shown), flush=True)
            if len(lines) > len(shown):
                print(f"  … and {len(lines) - len(shown)} more: -v")


if __name__ == "__main__":
    sys.exit(main())
