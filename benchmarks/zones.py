"""What zones cost: plans by the zones of geometry, by zones that have moved, and the best plan known without any.

Usage: python benchmarks/zones.py [--contours 115 308 1000] [--seeds 1 11 12] [--apart 21 22 23] [--work 30]
       [--without 30] > docs/zones.md

Made plates (examples/gen_sheet.py) under the default profile without no-tip-travel, which looks at every single move.
Work is in deterministic seconds, so that other programs on the machine change no plan. Of plates of a thousand contours
and more one seed of each kind is planned.
"""

from __future__ import annotations

import argparse
import platform
import sys
import time
from dataclasses import dataclass, replace

import kerfwise
from kerfwise.benchmarks.plates import cost, default_without, made_plate, rest_mm
from kerfwise.jobs.ask import Asked, ask, facts_of
from kerfwise.jobs.solve_options import options_for
from kerfwise.jobs.zones_cost import zoned_by, zones_cost
from kerfwise.jobs.zones_moved import better_zones
from kerfwise.models.engines.rounds import solve
from kerfwise.models.engines.solution import Solution, SolveOptions
from kerfwise.models.engines.warm_up import load_kernels
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.stating.lazy import afterthoughts

LARGE = 1000
"""Contours from which on one seed of each kind is planned."""
PAGE = """\
# What zones cost

Made by `python benchmarks/zones.py {given} > docs/zones.md` with kerfwise {kerfwise}, Python {python}, plates of
`examples/gen_sheet.py` under the default profile without no-tip-travel. Costs are in m: idle travel and what soft rules
cost, with the number of excuses beside it. The first zones are those of geometry, the second have moved.

| plate | zones | by geometry | zones | moved | proven | processor, s | best without | more | the plan says |
|---|---:|---:|---:|---:|---|---:|---:|---:|---|
{rows}

{seen} were looked at while this was made; {apart} were not.

Proven is that no order within the zones that have moved is better, with the ways to cut that are offered. Seconds of
the processor are those of the plan with zones and of all that was done to move them. `best without` is the best plan
known that need not keep to zones: that which a solve finds on its way, or what {without:g} of work for searches beside
it find, half of it from the plan with zones on, half from nothing. It is not proven, and a better one may exist. What
`the plan says` is what it tells of its zones, from the shorter look that a solve has.

## Where the extra comes from

Geometry draws borders across the ways that the torch would take: that costs travel, and now and then an excuse. It is
not the size of zones, nor their order: where the runs of a plan without zones are zones, the plan in them costs no more
than that plan.

So runs of the best plan known without zones take the place of the zones. They must be zones still: no more of them
than geometry has made, or than a proof bears; what is left after each about as square, on an average; each lying about
as much together; the first at the start side. Borders along a plan can lie in many places. First those are
tried that lie as far on as a proof bears; then, of all places, those that leave the rest squarest and the zones most
together, by a shortest way over the places between parts. Where a proof takes too long, zones that are more come next.
"""


@dataclass(frozen=True)
class Row:
    """One plate: zones and costs, mm, with the weight of excuses."""

    plate: str
    zones: tuple[int, int]
    by_geometry_mm: float
    moved_mm: float
    proven: bool
    processor_s: float
    without_mm: float
    told: str

    def __str__(self) -> str:
        more = (rest_mm(self.moved_mm) - rest_mm(self.without_mm)) / rest_mm(self.without_mm)
        cells = [self.plate, str(self.zones[0]), cost(self.by_geometry_mm), str(self.zones[1]), cost(self.moved_mm)]
        cells += ["yes" if self.proven else "no", f"{self.processor_s:.0f}"]
        return f"| {' | '.join([*cells, cost(self.without_mm), f'{more:.1%}', self.told])} |"


def row(contours: int, seed: int, work: float, without: float) -> Row:
    """Plan one plate with zones that stay, with zones that move, and without any."""
    profile, nest = default_without("no-tip-travel"), made_plate(contours, seed)
    asked, limits = ask(facts_of(nest, profile), profile), options_for(nest, profile, work=work)
    began_s = time.process_time()
    looks = afterthoughts(asked.facts, profile)
    stayed = solve(asked.facts, asked.stated.statements, limits, None, looks)
    further = afterthoughts(asked.facts, profile)([asked.facts.candidates[c].contour for c in stayed.route])
    by, moved, free = better_zones(asked, further, profile, stayed, limits)
    took_s = time.process_time() - began_s
    known = [] if free is None else [free.solution.objective]
    known += [found.objective for found in searched(by, profile, moved, limits, without)]
    return Row(
        f"{len(nest.contours)} contours, seed {seed}",
        (int(asked.facts.zone.max()), int(by.facts.zone.max())),
        stayed.objective,
        moved.objective,
        moved.status == "optimal",
        took_s,
        min(known),
        "" if free is None else zones_cost(by, moved, free, limits).sentence,
    )


def searched(
    asked: Asked, profile: Profile, solution: Solution, limits: SolveOptions, work: float
) -> tuple[Solution, Solution]:
    """Plans that need not keep to zones, searched for from a planned one on and from nothing."""
    names = zoned_by(asked, profile)
    statements = tuple(s for s in asked.stated.statements if s.about.rule not in names)
    limits = replace(limits, work=work / 2, member="search")
    from_here, from_nothing = (
        solve(asked.facts, statements, limits, None, afterthoughts(asked.facts, profile), start=start)
        for start in (solution.route, ())
    )
    return from_here, from_nothing


def main() -> None:
    """Print the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--contours", type=int, nargs="+", default=[115, 308, 1000])
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 11, 12], help="looked at while this was made")
    parser.add_argument("--apart", type=int, nargs="+", default=[21, 22, 23], help="not looked at")
    parser.add_argument("--work", type=float, default=30.0)
    parser.add_argument("--without", type=float, default=30.0, help="work for plans without zones")
    given = parser.parse_args()
    load_kernels()
    rows = []
    for contours in given.contours:
        for seeds in (given.seeds, given.apart):
            for seed in seeds[: 1 if contours >= LARGE else None]:
                rows.append(str(row(contours, seed, given.work, given.without)))
                print(rows[-1], file=sys.stderr, flush=True)
    listed = {name: " ".join(map(str, getattr(given, name))) for name in ("contours", "seeds", "apart")}
    page = PAGE.format(
        given=" ".join(f"--{name} {values}" for name, values in listed.items())
        + f" --work {given.work:g} --without {given.without:g}",
        seen=f"Seeds {listed['seeds'].replace(' ', ', ')}",
        apart=listed["apart"].replace(" ", ", "),
        without=given.without,
        kerfwise=kerfwise.__version__,
        python=platform.python_version(),
        rows="\n".join(rows),
    )
    print(page, end="")


if __name__ == "__main__":
    main()
