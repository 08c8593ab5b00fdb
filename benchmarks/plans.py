"""How good the plans are and what is proven of them, on made plates and the example nests.

Usage: python benchmarks/plans.py [--work W] > docs/benchmarks.md

Prints the benchmark page: every nest under the default profile, and made plates without zones, where the sets that
can occur are too many for a proof and the search has to carry the plan. `work` is the deterministic limit of `solve`.
"""

from __future__ import annotations

import argparse
import platform
import time
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

import kerfwise
from kerfwise.benchmarks.plates import default_without, made_plate
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers import read_nest
from kerfwise.jobs.request import facts_of, options_for
from kerfwise.models.engines.solution import Solution
from kerfwise.models.engines.solve import solve
from kerfwise.models.plan.make_plan import make_plan
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.stating.lazy_statements import lazy_statements
from kerfwise.rules.stating.state_rules import state_rules

EXAMPLES = Path(kerfwise.__file__).parent / "examples" / "nests"
PLATES = ((1, 115), (1, 300), (1, 1000))
WITHOUT_ZONES = ((1, 40), (1, 115))

PAGE = """\
# Benchmarks

Made by `python benchmarks/plans.py --work {work:g} > docs/benchmarks.md` with kerfwise {kerfwise}, OR-Tools {ortools},
Python {python}, seed 1. Seconds are wall-clock on a shared two-core machine, compiled kernels loaded: compare them
within this page only. The objective is idle
travel and what soft rules cost that are broken (an excuse of a hard one weighs 1000 m). A gap is (objective - bound) /
objective; none is given where no bound is proven. Zones stay as
geometry makes them here; `kerfwise solve` moves them where that makes a shorter plan ([what zones cost](zones.md)).
How the time grows, facts among it: [phases](phases.md).

## Under the default profile

| nest | contours | idle travel, m | objective, m | bound, m | gap | found by | proved by | facts, s | plan, s |
|---|---:|---:|---:|---:|---:|---|---|---:|---:|
{zoned}

## The same plates without zones and without no-tip-travel, all other rules as they are

| nest | contours | idle travel, m | objective, m | bound, m | gap | found by | proved by | facts, s | plan, s |
|---|---:|---:|---:|---:|---:|---|---|---:|---:|
{unzoned}
"""


@dataclass(frozen=True)
class Row:
    """One nest planned once."""

    name: str
    contours: int
    solution: Solution
    idle_mm: float
    facts_s: float
    plan_s: float

    def __str__(self) -> str:
        found, bound = self.solution.objective, self.solution.bound
        proven = "" if bound is None else f"{bound / 1000:.3f}"
        gap = "" if bound is None else f"{(found - bound) / found:.2%}"
        return (
            f"| {self.name} | {self.contours} | {self.idle_mm / 1000:.3f} | {found / 1000:.3f} | {proven} "
            f"| {gap} | {self.solution.found_by} "
            f"| {self.solution.proved_by} | {self.facts_s:.1f} | {self.plan_s:.1f} |"
        )


def plan(name: str, nest: Nest, profile: Profile, work: float) -> Row:
    """Facts, statements and a plan."""
    started = time.perf_counter()
    facts = facts_of(nest, profile)
    stated = state_rules(facts, profile)
    between = time.perf_counter()
    options = options_for(nest, profile, work=work)
    solution = solve(facts, stated.statements, options, refine=lazy_statements(facts, profile))
    took = time.perf_counter() - between
    made = make_plan(facts, profile, stated, solution, "portfolio", options.seed)
    return Row(name, facts.n, solution, made.totals.idle_mm, between - started, took)


def plates(sizes: tuple[tuple[int, int], ...]) -> Iterator[tuple[str, Nest]]:
    """Made plates of about as many contours."""
    for seed, contours in sizes:
        yield f"plate {contours}, seed {seed}", made_plate(contours, seed)


def main() -> None:
    """Print the page."""
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--work", type=float, default=30.0)
    work = arguments.parse_args().work
    profile = load_profile()
    without = default_without("zone-order", "no-tip-travel")
    warm = next(plates(((1, 20),)))
    plan(*warm, profile, 1.0)
    examples = [(p.name, read_nest(p)) for p in sorted(EXAMPLES.glob("*.json"))]
    zoned = [plan(name, nest, profile, work) for name, nest in [*examples, *plates(PLATES)]]
    unzoned = [plan(name, nest, without, work) for name, nest in plates(WITHOUT_ZONES)]
    print(
        PAGE.format(
            work=work,
            kerfwise=kerfwise.__version__,
            ortools=version("ortools"),
            python=platform.python_version(),
            zoned="\n".join(map(str, zoned)),
            unzoned="\n".join(map(str, unzoned)),
        ),
        end="",
    )


if __name__ == "__main__":
    main()
