"""What zones cost: plans by the zones of geometry, by zones moved along a plan without any, and that plan itself.

Usage: python benchmarks/zones.py [--contours 115 308 1000] [--seeds 1 11 12] [--work 30] > docs/zones.md

Made plates (examples/gen_sheet.py) under the default profile without no-tip-travel, which looks at every single move.
"""

from __future__ import annotations

import argparse
import json
import platform
import sys
from dataclasses import dataclass, replace

import kerfwise
from kerfwise.encoder.readers import ReadOptions
from kerfwise.encoder.readers.json_nest import read_json
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.jobs.ask import ask, facts_of
from kerfwise.jobs.produce import Produced, produce
from kerfwise.jobs.solve_options import options_for
from kerfwise.rules.profile.profile import load_profile
from kerfwise.rules.statements import EXEMPTION_MM

PAGE = """\
# What zones cost

Made by `python benchmarks/zones.py --contours {contours} --seeds {seeds} --work {work:g} > docs/zones.md` with kerfwise
{kerfwise}, Python {python}, plates of `examples/gen_sheet.py` under the default profile without no-tip-travel. Costs
are in m: idle travel and what soft rules cost, with the number of excuses beside it. The first zones are those of
geometry, the second have moved along the plan without zones. Seed 1 was looked at while this was made, others were not.

| plate | zones | by geometry | zones | moved | proven | without zones | more than without |
|---|---:|---:|---:|---:|---|---:|---:|
{rows}
"""


@dataclass(frozen=True)
class Row:
    """One plate: zones and costs, mm, with the weight of excuses."""

    plate: str
    zones: tuple[int, int]
    by_geometry_mm: float
    moved_mm: float
    proven: bool
    without_mm: float | None

    def __str__(self) -> str:
        without = more = ""
        if self.without_mm is not None:
            without = cost(self.without_mm)
            more = f"{(rest_mm(self.moved_mm) - rest_mm(self.without_mm)) / rest_mm(self.without_mm):.1%}"
        cells = [self.plate, str(self.zones[0]), cost(self.by_geometry_mm), str(self.zones[1]), cost(self.moved_mm)]
        return f"| {' | '.join([*cells, 'yes' if self.proven else 'no', without, more])} |"


def rest_mm(objective_mm: float) -> float:
    """What a plan costs without the weight of its excuses."""
    return objective_mm % EXEMPTION_MM


def cost(objective_mm: float) -> str:
    """In m, and how many excuses.

    Examples
    --------
    >>> cost(12_340.0), cost(2 * EXEMPTION_MM + 12_340.0)
    ('12.34', '12.34 + 2')
    """
    excuses = int(objective_mm // EXEMPTION_MM)
    return f"{rest_mm(objective_mm) / 1000:.2f}{f' + {excuses}' if excuses else ''}"


def row(contours: int, seed: int, work: float) -> Row:
    """Plan one plate with zones that stay, and with zones that move."""
    profile = load_profile()
    off = replace(profile.rules["no-tip-travel"], strength="off", weight=None)
    profile = replace(profile, rules={**profile.rules, "no-tip-travel": off})
    nest = read_json(json.dumps(make_sheet(seed, contours)).encode(), ReadOptions())
    asked, limits = ask(facts_of(nest, profile), profile), options_for(nest, profile, work=work)

    def made(and_zones: bool) -> Produced:
        return produce(asked, profile, limits, and_zones=and_zones)

    stayed, moved = made(False), made(True)
    objective_mm, costs = moved.plan.solve.objective, moved.plan.zones_cost
    return Row(
        f"{len(nest.contours)} contours, seed {seed}",
        (int(stayed.facts.zone.max()), int(moved.facts.zone.max())),
        stayed.plan.solve.objective,
        objective_mm,
        moved.plan.solve.status == "optimal",
        None if costs is None else objective_mm - costs.mm - costs.excuses * EXEMPTION_MM,
    )


def main() -> None:
    """Print the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--contours", type=int, nargs="+", default=[115, 308, 1000])
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 11, 12])
    parser.add_argument("--work", type=float, default=30.0)
    given = parser.parse_args()
    rows = []
    for contours in given.contours:
        for seed in given.seeds:
            rows.append(str(row(contours, seed, given.work)))
            print(rows[-1], file=sys.stderr, flush=True)
    page = PAGE.format(
        contours=" ".join(map(str, given.contours)),
        seeds=" ".join(map(str, given.seeds)),
        work=given.work,
        kerfwise=kerfwise.__version__,
        python=platform.python_version(),
        rows="\n".join(rows),
    )
    print(page, end="")


if __name__ == "__main__":
    main()
