"""Where the gap of a plate without zones comes from: what is left of it when statements are taken away.

Usage: python benchmarks/gap.py [--contours 60 115] [--seconds 30] > docs/gap.md

Made plates (examples/gen_sheet.py, seed 1) under the default profile without zones and without no-tip-travel. Of every
plate the problem is solved by search alone, and bounded from below in two ways that look at whole plans, with all its
statements and with fewer.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import platform
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

import kerfwise
from kerfwise.encoder.readers import ReadOptions
from kerfwise.encoder.readers.json_nest import read_json
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.jobs.ask import ask, facts_of
from kerfwise.models.engines.bounds import complete, flow_bound
from kerfwise.models.engines.search import Searcher
from kerfwise.models.engines.solution import Progress
from kerfwise.models.physics.timing.choose import feeds_of
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.problem import Problem
from kerfwise.models.problem.simplify import simplify
from kerfwise.rules.profile.profile import load_profile

PAGE = """\
# Where the gap without zones comes from

Made by `python benchmarks/gap.py --contours {contours} --seconds {seconds:g} > docs/gap.md` with kerfwise {kerfwise},
Python {python}, {system}, plates of `examples/gen_sheet.py`, seed 1, the default profile without zones. Costs are in m.

| plate | statements | plan | bound by flows | gap | {heads} |
|---|---|---:|---:|---:|{rules}
{rows}

The plan is what search finds in {seconds:g} s, the bounds have as long each. Flows are a linear program with cuts for
orders; walks visit n contours at lawful positions, and do not come back to the so many near contours that they remember
(`models/engines/bounds`). `conditions` are those of part-rigidity and of narrow strips, `lags` what heat-lag asks of
contours cut one after the other. Both bounds see a lag of one cut; flows see conditions too, walks do not.
"""
REMEMBERED = (0, 3, 5)


@dataclass(frozen=True)
class Row:
    """What is known of one problem: costs and bounds in m."""

    contours: int
    statements: str
    plan_m: float
    flow_m: float
    walks_m: tuple[float, ...]

    def text(self) -> str:
        """A line of the table."""

        def bound(least_m: float) -> str:
            return f"{least_m:.2f} | {(self.plan_m - least_m) / self.plan_m:.1%}"

        cells = [f"{self.contours} contours", self.statements, f"{self.plan_m:.2f}", bound(self.flow_m)]
        return f"| {' | '.join([*cells, *map(bound, self.walks_m)])} |"


def fewer(problem: Problem) -> Iterator[tuple[str, Problem]]:
    """The problem, and what is left of it as statements go."""
    yield "all", problem
    problem = replace(problem, conditions=())
    yield "no conditions", problem
    problem = replace(problem, lags=())
    yield "orders alone", problem
    yield "none", replace(problem, before=np.zeros_like(problem.before), block=np.arange(problem.n))


def plate(contours: int) -> Problem:
    """The problem of a made plate without zones."""
    profile = load_profile()
    off = {rule: replace(profile.rules[rule], strength="off", weight=None) for rule in ("zone-order", "no-tip-travel")}
    profile = replace(profile, rules={**profile.rules, **off})
    nest = read_json(json.dumps(make_sheet(1, contours)).encode(), ReadOptions())
    asked = ask(facts_of(nest, profile), profile)
    return simplify(
        make_problem(asked.facts, asked.stated.statements, profile.home_on(asked.facts.nest), feeds_of(profile))
    )


def within(seconds: float) -> Progress:
    """Answers whether so many seconds are not over yet."""
    until = time.monotonic() + seconds
    return lambda engine, cost_um, bound_um: time.monotonic() < until


def look(contours: int, seconds: float) -> Iterator[Row]:
    """Plan and bound one plate, with fewer statements from row to row."""
    for statements, problem in fewer(plate(contours)):
        searcher = Searcher(problem)
        searcher.run(seconds, seconds)
        plan = searcher.best
        assert plan is not None
        flow = flow_bound(problem, plan, seconds, within(seconds))
        walks = [complete(problem, float(plan.cost), seconds, within(seconds), g).root for g in REMEMBERED]
        yield Row(problem.n, statements, plan.cost / 1e6, flow.bound / 1e6, tuple(w / 1e6 for w in walks))


def main() -> None:
    """Print the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--contours", type=int, nargs="+", default=[60, 115])
    parser.add_argument("--seconds", type=float, default=30.0)
    given = parser.parse_args()
    rows = []
    for contours in given.contours:
        for row in look(contours, given.seconds):
            rows.append(row.text())
            print(rows[-1], file=sys.stderr, flush=True)
    page = PAGE.format(
        contours=" ".join(map(str, given.contours)),
        seconds=given.seconds,
        kerfwise=kerfwise.__version__,
        python=platform.python_version(),
        system=f"{platform.system()} {platform.machine()}, {multiprocessing.cpu_count()} cores",
        heads=" | ".join(f"walks that remember {g} | gap" for g in REMEMBERED),
        rules="---:|" * (2 * len(REMEMBERED)),
        rows="\n".join(rows),
    )
    print(page, end="")


if __name__ == "__main__":
    main()
