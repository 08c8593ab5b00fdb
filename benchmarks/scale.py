"""How good plans of large nests are with zones and without, what is proven of them, and what time and memory they take.

Usage: python benchmarks/scale.py [--plates 115:5,25 308:5,25 1000:10,60,600 10000:10] [--seed 1] --into docs/scale.md

Made plates (examples/gen_sheet.py) under the default profile without no-tip-travel, which looks at every single move:
cut zone after zone, and without zones. Each plate of so many contours is planned within every amount of work named,
from the start each time, in a process of its own. Work is counted in deterministic seconds, so that other programs on
the machine change no plan; what it took of the processor is beside it. The page takes the place of the one there, but
for what another command made of it.
"""

from __future__ import annotations

import argparse
import multiprocessing
import platform
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import kerfwise
from kerfwise.apps.bench.bench_child import load_kernels, peak_mb
from kerfwise.benchmarks.plates import cost, default_without, made_plate, planned_by_zones
from kerfwise.jobs.request import facts_of, make_request, options_for
from kerfwise.models.engines.solve import solve
from kerfwise.models.engines.tuning import MOST_CONTOURS
from kerfwise.rules.stating.lazy_statements import lazy_statements

OTHERS = "## Beside the planning"
"""The heading from which on the page is another command's."""
PAGE = """\
# Large nests

Made by `python benchmarks/scale.py --plates {plates} --seed {seed} --into docs/scale.md` with kerfwise {kerfwise},
Python {python}, {system}, plates of `examples/gen_sheet.py` under the default profile without no-tip-travel. Costs are
in m: idle travel and what soft rules cost, with the number of excuses beside it.

| plate | facts, processor s | work | processor s | plan | proven | bound | gap | memory, MB |
|---|---:|---:|---:|---:|---|---:|---:|---:|
{rows}

Work is in deterministic seconds, so that other programs on the machine change no plan. What it took of the processor,
all threads together, is beside it, and so are the facts, which are made before. A plan with zones is proven within its
zones, with the ways to cut that are offered: others may be better. What it took includes looking for a plan without
zones, and moving the zones along it ([what zones cost](zones.md)); beyond {most:,} contours zones stay as geometry
makes them. Without zones the sets of contours that may be out are too many for a proof, and what is not proven is
bounded by flows: [where that gap comes from](gap.md). Where a plan is proven, more work is not tried.

Without zones, a large nest is annealed whole, for half of the work at most, and then region by region: some 40 contours
that lie beside each other are laid out anew while all others keep their order, and later some 120, at first in a
quarter of a second, then slower and slower. A step is kept where the whole route is no dearer, so that more steps from
one route never end in a dearer one. Runs whose first annealing is of another length go other ways, and may end in a
dearer plan with more work, though not by much. Where there is more work than that takes (12 of search at 300 contours,
70 at 1000), short searches from nothing follow, and what they find is merged into the best route: all moves that two
routes share stay, and the rest is searched. By turns with these some 200 contours are laid out anew.

"""


@dataclass(frozen=True)
class Job:
    """A plate, with or without zones, and the works to plan it within, from less to more."""

    contours: int
    zones: bool
    works: tuple[float, ...]
    seed: int = 1


@dataclass(frozen=True)
class Seen:
    """What came of one work: costs in mm, with the weight of excuses; seconds of the processor."""

    contours: int
    facts_s: float
    work: float
    planned_s: float
    cost_mm: float
    bound_mm: float | None
    proven: bool
    memory_mb: float


def run(job: Job) -> list[Seen]:
    """Plan one plate within every work, until it is proven."""
    profile = default_without("no-tip-travel", *([] if job.zones else ["zone-order"]))
    nest = made_plate(job.contours, job.seed)
    began_s = time.process_time()
    asked = make_request(facts_of(nest, profile), profile)
    facts_s = time.process_time() - began_s
    found: list[Seen] = []
    for work in job.works:
        limits = options_for(nest, profile, work=work)
        began_s = time.process_time()
        if job.zones:
            solution = planned_by_zones(asked, profile, limits).solution
        else:
            solution = solve(asked.facts, asked.stated.statements, limits, None, lazy_statements(asked.facts, profile))
        found.append(
            Seen(
                asked.facts.n,
                facts_s,
                work,
                time.process_time() - began_s,
                solution.objective,
                solution.bound,
                solution.status == "optimal",
                peak_mb(),
            )
        )
        if found[-1].proven:
            break
    return found


def row(job: Job, seen: Seen) -> str:
    """One line of the table."""
    bound_mm = seen.bound_mm
    cells = [
        f"{seen.contours} contours{'' if job.zones else ', no zones'}",
        f"{seen.facts_s:.1f}",
        f"{seen.work:g}",
        f"{seen.planned_s:.0f}",
        cost(seen.cost_mm),
        "yes" if seen.proven else "no",
        "" if bound_mm is None else f"{bound_mm / 1000:.2f}",
        "" if bound_mm is None else f"{(seen.cost_mm - bound_mm) / seen.cost_mm:.1%}",
        f"{seen.memory_mb:.0f}",
    ]
    return f"| {' | '.join(cells)} |"


def page(jobs: Sequence[Job], rows: Sequence[str]) -> str:
    """The page, up to what another command makes of it."""
    plates = {job.contours: ",".join(f"{work:g}" for work in job.works) for job in jobs}
    return PAGE.format(
        plates=" ".join(f"{contours}:{works}" for contours, works in plates.items()),
        seed=jobs[0].seed,
        kerfwise=kerfwise.__version__,
        python=platform.python_version(),
        system=f"{platform.system()} {platform.machine()}, {multiprocessing.cpu_count()} cores",
        most=MOST_CONTOURS,
        rows="\n".join(rows),
    )


def with_others(text: str, before: str) -> str:
    """The page, with what another command made of the one before."""
    at = before.find(OTHERS)
    return text.rstrip() + "\n" if at < 0 else text + before[at:]


def main() -> None:
    """Write the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    plates = ["115:5,25", "308:5,25", "1000:10,60,600", "10000:10"]
    parser.add_argument("--plates", nargs="+", default=plates, help="contours:work,work…")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--into", type=Path, required=True)
    given = parser.parse_args()
    jobs = []
    for plate in given.plates:
        contours, works = plate.split(":")
        amounts = tuple(float(work) for work in works.split(","))
        jobs += [Job(int(contours), zones, amounts, given.seed) for zones in (True, False)]
    load_kernels()  # compiled beforehand, where that was never done
    rows = []
    context = multiprocessing.get_context("spawn")
    for job in jobs:
        with context.Pool(1) as pool:
            for seen in pool.apply(run, (job,)):
                rows.append(row(job, seen))
                print(rows[-1], file=sys.stderr, flush=True)
    before = given.into.read_text(encoding="utf-8") if given.into.exists() else ""
    given.into.write_text(with_others(page(jobs, rows), before), encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main()
