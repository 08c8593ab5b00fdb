"""How soon there is a plan: the first one, one within 5 % and 1 % of the last, and the proof; beside plain strategies.

Usage: python -m kerfwise.benchmarks.first_plans [--contours 16 40 115 308 1000] [--nests FILE…] [--seed 1] [--work 30]
       > first.md, whose table goes into docs/scale.md by hand

Plates of examples/gen_sheet.py, and nests, under the default profile. Seconds are by the clock, kernels compiled, from
the nest that is read: of the first plan with its program and the check, as `solve --first` has it, of the others until
the engines have reached them. The plain strategies keep no rule but, of the second, that what lies in a contour is cut
before it; their idle travel is beside that of the last plan.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import platform
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import kerfwise
from kerfwise.apps.bench.bench_child import load_kernels
from kerfwise.benchmarks.plates import cost, made_plate
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers import read_nest
from kerfwise.jobs.by_engine import Method
from kerfwise.jobs.inputs import Inputs
from kerfwise.jobs.progress import Listener, Reached
from kerfwise.jobs.request import facts_of, options_for
from kerfwise.pipeline import Watchers, plan_nest
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.statements import EXEMPTION_MM

NEAR = 0.05, 0.01
"""How far from the last plan, as shares of its cost without excuses."""
HEAD = """\
Made by `python -m kerfwise.benchmarks.first_plans {given}` with kerfwise {kerfwise}, Python {python}: seconds by the
clock from the nest that is read, {work:g} of work, costs in m (`+ 1`: with an excuse).

| nest | first, s | its cost | 5 %, s | 1 %, s | proof, s | last plan | idle, m | nearest neighbour | inner first |
|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|"""


@dataclass(frozen=True)
class Row:
    """What one nest took: seconds by the clock, mm; None where it was not reached."""

    name: str
    first_s: float
    first_mm: float
    near_s: tuple[float | None, ...]
    proof_s: float | None
    last_mm: float
    idle_mm: float
    nearest_mm: float
    inner_mm: float

    def __str__(self) -> str:
        seconds = ["–" if s is None else f"{s:.1f}" for s in (*self.near_s, self.proof_s)]
        lengths = [f"{mm / 1000:.2f}" for mm in (self.idle_mm, self.nearest_mm, self.inner_mm)]
        cells = [self.name, f"{self.first_s:.1f}", cost(self.first_mm), *seconds, cost(self.last_mm), *lengths]
        return f"| {' | '.join(cells)} |"


def reached_s(heard: list[tuple[float, float]], last_mm: float, near: float) -> float | None:
    """When a plan was there that is as near to the last one, of all that were heard of: seconds and costs in order.

    Examples
    --------
    >>> reached_s([(1.0, 1200.0), (2.0, 1040.0), (3.0, 1000.0)], 1000.0, 0.05)
    2.0
    """
    most_mm = last_mm + near * (last_mm % EXEMPTION_MM)
    return next((seconds for seconds, mm in heard if mm <= most_mm), None)


def plain_mm(facts: Facts, home_mm: tuple[float, float], inner_first: bool) -> float:
    """Idle travel of going on to the nearest pierce always, mm; with `inner_first` of what lies in no uncut contour."""
    contour = np.array([candidate.contour for candidate in facts.candidates])
    pierce = np.array([candidate.pierce for candidate in facts.candidates])
    left, at, total = np.ones(facts.n, dtype=np.bool_), np.array(home_mm), 0.0
    while left.any():
        waits = ~left
        if inner_first:
            waits[facts.parent[left & (facts.parent >= 0)]] = True
        away = np.where(waits[contour], np.inf, np.hypot(*(pierce - at).T))
        chosen = int(away.argmin())
        total, left[contour[chosen]] = total + float(away[chosen]), False
        at = np.array(facts.candidates[chosen].end)
    return total + float(np.hypot(*(at - np.array(home_mm))))


def row(given: tuple[str, Nest, float]) -> Row:
    """Plan a nest twice: until there is a plan, and to the end."""
    name, nest, work = given
    profile = load_profile()
    inputs, limits = Inputs(nest, profile), options_for(nest, profile, work=work)
    plan_nest(inputs, limits, Method(first=True))  # loads what is loaded once
    began_s = time.monotonic()
    first = plan_nest(inputs, limits, Method(first=True)).made
    first_s = time.monotonic() - began_s
    heard: list[tuple[float, float]] = []
    began_s = time.monotonic()

    def hear(reached: Reached) -> None:
        if reached.objective_mm is not None:
            heard.append((time.monotonic() - began_s, reached.objective_mm))

    ended: list[float] = []
    watchers = Watchers(Listener(hear), planned=lambda _: ended.append(time.monotonic()))
    last = plan_nest(inputs, limits, watchers=watchers).made
    solved, facts = last.plan.solve, facts_of(nest, profile)
    home = profile.home_on(nest)
    return Row(
        name,
        first_s,
        first.plan.solve.objective,
        tuple(reached_s(heard, solved.objective, near) for near in NEAR),
        ended[0] - began_s if solved.status == "optimal" else None,
        solved.objective,
        last.plan.totals.idle_mm,
        plain_mm(facts, home, False),
        plain_mm(facts, home, True),
    )


def nests_of(given: argparse.Namespace) -> Iterator[tuple[str, Nest, float]]:
    """What to plan, in order."""
    for contours in given.contours:
        nest = made_plate(contours, given.seed)
        yield f"{len(nest.contours)} contours", nest, given.work
    for file in given.nests:
        yield Path(file).name, read_nest(Path(file)), given.work


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--contours", type=int, nargs="*", default=[16, 40, 115, 308, 1000])
    parser.add_argument("--nests", nargs="*", default=[])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--work", type=float, default=30.0)
    given = parser.parse_args()
    load_kernels()
    told = json.dumps(given.contours).strip("[]").replace(",", "")
    named = f"--contours {told} --nests {' '.join(given.nests)} --seed {given.seed} --work {given.work:g}"
    print(HEAD.format(given=named, kerfwise=kerfwise.__version__, python=platform.python_version(), work=given.work))
    for one in nests_of(given):
        with multiprocessing.get_context("spawn").Pool(1) as pool:
            print(pool.apply(row, (one,)), flush=True)


if __name__ == "__main__":
    main()
