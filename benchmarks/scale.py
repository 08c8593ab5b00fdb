"""How fast plans of large nests come, how good they are after a while, and how memory and time grow.

Usage: python benchmarks/scale.py [--contours 115 308 1000 10000] [--seconds 10 30 120] > docs/scale.md

Made plates (examples/gen_sheet.py, seed 1) under the default profile, which cuts zone after zone, and without zones.
All order rules are on. No-tip-travel, which looks at every single move, is off. The clock of `first plan` runs from
the nest read: facts, statements, problem and search. Every plate has a process of its own.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import platform
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import kerfwise
from kerfwise.encoder.readers import ReadOptions
from kerfwise.encoder.readers.json_nest import read_json
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.jobs.ask import ask, facts_of
from kerfwise.jobs.bench.memory import peak_mb
from kerfwise.models.engines.portfolio import run_portfolio
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.engines.watch import Watch
from kerfwise.models.physics.timing.choose import feeds_of
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.simplify import simplify
from kerfwise.rules.profile.profile import load_profile

PAGE = """\
# Large nests

Made by `python benchmarks/scale.py --contours {contours} --seconds {seconds} > docs/scale.md` with kerfwise {kerfwise},
Python {python}, {system}, plates of `examples/gen_sheet.py`, seed 1, kernels compiled beforehand. Costs are objectives
in m: idle travel, what soft rules cost, and 1000 m for every excuse.
All order rules are hard; no-tip-travel is off.

Zone after zone a plan is proven in the time that its sets take, which grows with the number of zones. Without zones the
sets are too many, and what is not proven is bounded by flows. Their linear programs take the longer the more sites
there are; beyond 9000 sites, or 3000 with less than 30 s for them, a contour stands for all of its own, what rules ask
of the metal that holds a part is left out, and the bound stays far below. [Where the gap comes from](gap.md) shows what
is left as statements go.

| plate | facts to problem, s | first plan, s | {heads} | bound after {last:g} s | gap | proven, s | memory, MB |
|---|---:|---:|{rules}---:|---:|---:|---:|
{rows}
"""


@dataclass(frozen=True)
class Job:
    """A plate, with or without zones, and the times to look at it, s after the search began."""

    contours: int
    zones: bool
    seconds: tuple[float, ...]


@dataclass(frozen=True)
class Seen:
    """What came of it: costs in m at the times asked for, None where there was no plan yet."""

    contours: int
    posed_s: float
    first_s: float | None
    costs_m: tuple[float | None, ...]
    bound_m: float | None
    proven_s: float | None
    memory_mb: float


def run(job: Job) -> Seen:
    """Plan one plate for as long as the last of the times."""
    profile = load_profile()
    off = ["no-tip-travel"] + ([] if job.zones else ["zone-order"])
    rules = {name: replace(profile.rules[name], strength="off", weight=None) for name in off}
    profile = replace(profile, rules={**profile.rules, **rules})
    nest = read_json(json.dumps(make_sheet(1, job.contours)).encode(), ReadOptions())
    started = time.perf_counter()
    asked = ask(facts_of(nest, profile), profile)
    problem = simplify(
        make_problem(asked.facts, asked.stated.statements, profile.home_on(asked.facts.nest), feeds_of(profile))
    )
    posed = time.perf_counter()
    seen: list[tuple[float, int]] = []

    def note(engine: str, cost_um: int | None, bound_um: int | None) -> bool:
        if cost_um is not None and (not seen or cost_um < seen[-1][1]):
            seen.append((time.perf_counter(), cost_um))
        return True

    options = SolveOptions(time_s=job.seconds[-1])
    known = run_portfolio(problem, options, Watch(options, note))
    ended = time.perf_counter()
    if known.incumbent is not None:
        note("", known.incumbent.cost, None)
    costs = [[cost for at, cost in seen if at - posed <= s] for s in job.seconds[:-1]]
    costs.append([cost for _, cost in seen])
    return Seen(
        asked.facts.n,
        posed - started,
        seen[0][0] - started if seen else None,
        tuple(min(before) / 1e6 if before else None for before in costs),
        known.bound_um / 1e6 if known.proved_by else None,
        ended - posed if known.proven else None,
        peak_mb(),
    )


def row(job: Job, seen: Seen) -> str:
    """One line of the table."""
    cost, bound = seen.costs_m[-1], seen.bound_m
    gap = "" if cost is None or bound is None else f"{(cost - bound) / cost:.2%}"
    cells = [
        f"{seen.contours} contours{'' if job.zones else ', no zones'}",
        f"{seen.posed_s:.1f}",
        "none" if seen.first_s is None else f"{seen.first_s:.1f}",
        *("none" if c is None else f"{c:.2f}" for c in seen.costs_m),
        "" if bound is None else f"{bound:.2f}",
        gap,
        "" if seen.proven_s is None else f"{seen.proven_s:.1f}",
        f"{seen.memory_mb:.0f}",
    ]
    return f"| {' | '.join(cells)} |"


def page(jobs: Sequence[Job], seen: Sequence[Seen]) -> str:
    """The whole page."""
    seconds = jobs[0].seconds
    return PAGE.format(
        contours=" ".join(str(c) for c in dict.fromkeys(job.contours for job in jobs)),
        seconds=" ".join(f"{s:g}" for s in seconds),
        kerfwise=kerfwise.__version__,
        python=platform.python_version(),
        system=f"{platform.system()} {platform.machine()}, {multiprocessing.cpu_count()} cores",
        heads=" | ".join(f"after {s:g} s" for s in seconds),
        last=seconds[-1],
        rules="---:|" * (len(seconds) + 1),
        rows="\n".join(row(job, s) for job, s in zip(jobs, seen, strict=True)),
    )


def main() -> None:
    """Print the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--contours", type=int, nargs="+", default=[115, 308, 1000, 10_000])
    parser.add_argument("--seconds", type=float, nargs="+", default=[10.0, 30.0, 120.0])
    given = parser.parse_args()
    jobs = [Job(c, zones, tuple(given.seconds)) for c in given.contours for zones in (True, False)]
    seen = []
    context = multiprocessing.get_context("spawn")
    for job in [Job(20, True, (2.0,)), *jobs]:  # the first compiles kernels where that was never done
        with context.Pool(1) as pool:
            seen.append(pool.apply(run, (job,)))
            print(row(job, seen[-1]), file=sys.stderr, flush=True)
    print(page(jobs, seen[1:]), end="")


if __name__ == "__main__":
    main()
