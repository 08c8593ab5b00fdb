"""How soon the page answers what a move would do, on made plates: `python -m kerfwise.benchmarks.moves`.

Usage: python -m kerfwise.benchmarks.moves [--contours 16 115 308] [--moves 40] [--work 0.1]

Each contour is moved to a place near its own and to one far off. Printed are processor seconds: what is worked out once
for a plan, the median and the longest answer, without and with the look for narrow strips, and what it takes to say of
every contour why it is cut where it is, with other entries and places.
"""

from __future__ import annotations

import argparse
import json
import statistics
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

from kerfwise.encoder.readers import read_nest
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.jobs.explainer import Explainer, Mover
from kerfwise.jobs.inputs import Inputs
from kerfwise.jobs.request import options_for
from kerfwise.pipeline import plan_nest
from kerfwise.rules.profile.load import load_profile


def seconds(of: Callable[[], object]) -> float:
    """Processor seconds that a call takes."""
    began_s = time.process_time()
    of()
    return time.process_time() - began_s


def row(contours: int, moves: int, work: float) -> str:
    """A line of the table."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "plate.json")
        file.write_text(json.dumps(make_sheet(1, contours)), encoding="utf-8", newline="\n")
        nest = read_nest(file)
    given = Inputs(nest, load_profile())
    done = plan_nest(given, options_for(nest, given.profile, work=work))
    explainers: list[Explainer] = []

    def prepare() -> None:
        explainers.append(Explainer(given, done.made.plan))
        assert explainers[0].setting

    once_s = seconds(prepare)
    mover, setting = Mover(explainers[0]), explainers[0].setting
    names = [setting.name(c) for c in setting.order]
    mover.move(names[:1], 1, look=True)
    step = max(1, len(names) // moves)
    told = [f"{len(names):8d}", f"{once_s:8.2f}"]
    for look in (False, True):
        took_s = [
            seconds(partial(mover.move, [names[k]], place, look=look))
            for k in range(0, len(names), step)
            for place in (min(len(names), k + 2), len(names) - k)
        ]
        told += [f"{statistics.median(took_s):8.3f}", f"{max(took_s):8.3f}"]
    told.append(f"{seconds(lambda: [explainers[0].explain(name) for name in names]):8.2f}")
    return " ".join(told)


def main() -> None:
    """Read the command line, print the table."""
    arguments = argparse.ArgumentParser(description=str(__doc__).splitlines()[0])
    arguments.add_argument("--contours", type=int, nargs="+", default=[16, 115, 308])
    arguments.add_argument("--moves", type=int, default=40)
    arguments.add_argument("--work", type=float, default=0.1)
    given = arguments.parse_args()
    print("contours     once   median  longest  +look: median  longest  why of all")
    for contours in given.contours:
        print(row(contours, given.moves, given.work), flush=True)


if __name__ == "__main__":
    main()
