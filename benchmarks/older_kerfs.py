"""What it costs to keep pierces and leads off the kerfs of older cuts.

Usage: python benchmarks/older_kerfs.py [--work W] [--nests FILE …] > docs/older-kerfs.md

Every nest is planned twice under the default profile, in one run: without a thought of older kerfs, as kerfwise planned
before, and as it plans now. Of both plans the pierces and leads are counted that the check finds over older kerfs.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import kerfwise
from kerfwise.encoder.candidates import build_candidates
from kerfwise.encoder.facts import compute_facts
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers import ReadOptions, read_nest
from kerfwise.encoder.readers.json_nest import read_json
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.jobs.request import options_for
from kerfwise.models.engines.solve import solve
from kerfwise.models.plan.make_plan import make_plan
from kerfwise.postproc.clock import contour_heat_kj
from kerfwise.rules.judging.pierces import leads_over_older_kerfs
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.stating.lazy_statements import lazy_statements
from kerfwise.rules.stating.state_rules import state_rules

EXAMPLES = Path(kerfwise.__file__).parent / "examples" / "nests"
PLATES = ((1, 115), (1, 300), (1, 1000))
STREETS_MM = (3.5, 4.0, 5.0, 6.0, 8.0, 12.0)

PAGE = """\
# What older kerfs cost

Made by `python benchmarks/older_kerfs.py --work {work:g} > docs/older-kerfs.md`, default profile, seed 1. "Before" are
leads without a thought of older kerfs, "now" is rule [pierce](rules.md#pierce). *Over kerfs* counts the cuts whose
pierce or lead the check finds over an older kerf, or nearer to one than `splash`. The grids are of 5 × 8 rectangles,
60 × 40 mm, with streets of the width named. Leads are shorter now where streets are narrow; so idle travel may be less.

| nest | contours | idle before, m | over kerfs | proven | idle now, m | over kerfs | proven | change |
|---|---:|---:|---:|---|---:|---:|---|---:|
{rows}
"""


@dataclass(frozen=True)
class Planned:
    """One plan: idle travel, how many of its cuts lie over older kerfs, and whether it is proven."""

    idle_mm: float
    over: int
    proven: bool

    def __str__(self) -> str:
        return f"{self.idle_mm / 1000:.3f} | {self.over} | {'yes' if self.proven else 'no'}"


def facts_of(nest: Nest, profile: Profile, minding: bool) -> Facts:
    """The facts, with candidates that mind older kerfs or do not."""
    leads, thresholds = profile.lead_options(nest), profile.fact_options(nest)
    if not minding:
        leads, thresholds = replace(leads, splash_mm=None), replace(thresholds, splash_mm=None)
    candidates = build_candidates(nest, leads)
    return compute_facts(nest, thresholds, candidates, contour_heat_kj(nest, candidates, profile))


def planned(nest: Nest, profile: Profile, work: float, minding: bool) -> Planned:
    """The best plan found."""
    facts = facts_of(nest, profile, minding)
    stated = state_rules(facts, profile)
    options = options_for(nest, profile, work=work)
    solution = solve(facts, stated.statements, options, refine=lazy_statements(facts, profile))
    plan = make_plan(facts, profile, stated, solution, "portfolio", options.seed)
    splash_mm = profile.lead_options(nest).splash_mm or 0.0
    found = leads_over_older_kerfs(nest, plan.sequence(profile.home_on(nest)), profile.material.kerf_mm, splash_mm)
    return Planned(plan.totals.idle_mm, len({positions[-1] for positions, _, _ in found}), solution.status == "optimal")


def grid(street_mm: float) -> dict[str, object]:
    """Eight columns and five rows of rectangles."""
    parts = []
    for k in range(40):
        x, y = 20 + (60 + street_mm) * (k % 8), 20 + (40 + street_mm) * (k // 8)
        parts.append({"id": f"P{k + 1}", "outer": [[x, y], [x + 60, y], [x + 60, y + 40], [x, y + 40]]})
    sheet = {"width": 40 + 8 * 60 + 7 * street_mm, "height": 40 + 5 * 40 + 4 * street_mm}
    return {"format": "kerfwise-nest/1", "units": "mm", "sheet": sheet, "parts": parts}


def nests(files: list[str]) -> Iterator[tuple[str, Nest]]:
    """The example nests, made plates, grids, and what else was named."""
    for path in sorted(EXAMPLES.glob("*.json")):
        yield path.name, read_nest(path)
    for seed, contours in PLATES:
        made = make_sheet(seed, contours)
        yield f"plate {contours}, seed {seed}", read_json(json.dumps(made).encode(), ReadOptions())
    for street_mm in STREETS_MM:
        yield f"grid, streets of {street_mm:g} mm", read_json(json.dumps(grid(street_mm)).encode(), ReadOptions())
    for name in files:
        yield Path(name).name, read_nest(name)


def main() -> None:
    """Print the page."""
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--work", type=float, default=10.0)
    arguments.add_argument("--nests", nargs="*", default=[])
    given = arguments.parse_args()
    profile, rows = load_profile(), []
    for name, nest in list(nests(given.nests)):  # a file that is missing is told before the first plan
        nest = profile.as_cut(nest)
        before, now = (planned(nest, profile, given.work, minding) for minding in (False, True))
        share = now.idle_mm / before.idle_mm - 1
        rows.append(f"| {name} | {len(nest.contours)} | {before} | {now} | {share:+.1%} |")
    print(PAGE.format(work=given.work, rows="\n".join(rows)), end="")


if __name__ == "__main__":
    main()
