"""What zones cost: plans by the zones of geometry, by zones that have moved, and the best plan known without any.

Usage: python benchmarks/zones.py [--contours 115 308 1000 3000 10000] [--default 115] [--sizes 308:40,50]
       [--many 40:20 115:20 308:5] [--seeds 1 11] [--apart 21] [--work 30] [--without 0.03] [--kept rows.json]
       > docs/zones.md

Made plates (examples/gen_sheet.py) under the default profile without no-tip-travel, which looks at every single move;
those of `--default` contours with it. `--sizes` are plates on which geometry makes zones of so many contours, which do
not move. Work is in deterministic seconds, so that other programs on the machine change no plan; that of `--without`,
for plans without zones, is for every contour, but no more than `MOST_WITHOUT` in all. Of plates of a thousand contours
and more one seed of each kind is planned. Every row is made in a process of its own; those that the file `--kept` has
already are not made again. `--many` are so many plates of a number of contours, by seeds from 1001 on, which nobody
tunes by: what zones cost there, on an average and at worst; up to 150 contours with no-tip-travel.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import platform
import sys
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

import kerfwise
from kerfwise.apps.bench.bench_child import load_kernels, peak_mb
from kerfwise.benchmarks.plates import cost, default_without, made_plate, planned_by_zones, rest_mm
from kerfwise.jobs.plan_without_zones import zoned_by
from kerfwise.jobs.request import Request, facts_of, make_request, options_for
from kerfwise.models.engines.solution import Solution, SolveOptions
from kerfwise.models.engines.solve import solve
from kerfwise.models.engines.tuning import LARGE_NEST as FEW
from kerfwise.models.engines.tuning import LEAST_LOOK_S, LEAST_WORK, MOST_CONTOURS
from kerfwise.models.engines.tuning import UNZONED_MOST_MOVES as MOST_MOVES
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.statements import EXEMPTION_MM
from kerfwise.rules.stating.lazy_statements import lazy_statements

LARGE, MOST_WITHOUT, APART = 1000, 60.0, 1001
"""Contours from which on one seed of each kind is planned, the most work for plans without zones, and the first seed of
many."""
PAGE = """\
# What zones cost

Made by `python benchmarks/zones.py {given} > docs/zones.md` with kerfwise {kerfwise}, Python {python}, plates of
`examples/gen_sheet.py`. Costs are in m: idle travel and what soft rules cost, with the number of excuses beside it.

## Zones that move

Under the default profile without no-tip-travel, which looks at every single move, and where it says so with it. The
first zones are those of geometry, the second have moved; `largest` is how many contours the largest of these has.

| plate | zones | by geometry | zones | largest | moved | proven | s | MB | best without | more | the plan says |
|---|---:|---:|---:|---:|---:|---|---:|---:|---:|---:|---|
{rows}

{seen} were looked at while this was made; {apart} was not.

Proven is that no order within the zones that have moved is better, with the ways to cut that are offered. Seconds of
the processor (s) and memory (MB) are those of the plan with zones and of all that was done to move them. `best without`
is the best plan known that need not keep to zones: that which a solve finds on its way, or what {without:g} of work a
contour (no more than {most:g} in all) for searches beside it find, half of it from the plan with zones on, half from
nothing. It is not proven, and a better one may exist: with more work shorter ones are found
([the gap without zones](gap.md)). What `the plan says` is what it tells of its zones, from the look that a solve has:
up to {few} contours a short one, beyond that one that has what two proofs leave of the work.

## Zones of so many contours

Where a plant gives a number, geometry makes zones of about so many contours, and they stay where they are. The default
profile without no-tip-travel, within {work:g} of work.

| plate | zone_contours | zones | largest | plan | bound | proven | processor, s | memory, MB |
|---|---:|---:|---:|---:|---:|---|---:|---:|
{sizes}

A proof goes through the sets of contours that may be out while a zone is cut. It looks for plans that cost little more
than its bound first, then for such that cost more, until there is one: so it goes through few sets that no good plan
has. Where that is too many sets for bounds by walks, each zone has a linear program by flows, with cuts; what its
multipliers leave of the cost of moves, summed along a way, says of every set and last site what a whole plan by that
way costs at least. Where memory (2 GB) or work end before the proof, the limit that no plan kept to is a bound of all
plans within these zones.

From the last zone to the first each of these programs ends at what the next zone still costs from there on. A sweep of
a zone alone, from its end to its beginning, finds that out for every way into it: its program says little of where it
is come to from. By that alone the best way in would be believed at each border, and no good plan through the zone
before ends there. Zone after zone, each from where the last one ended, then gives a plan that may be near the bound; a
sweep of all zones up to the best plan known is the proof.

The proof has three quarters of the work where a plant gives a number, and where it fails, the plan may be longer than
one that a search with more work finds. What is needed for zones of 50 and 60 are higher bounds of single zones. On 309
contours, seed 1, zones of 40, the programs of eight zones were 0.1 to 1.6 % below the best way through them, with four
times the work 0 to 0.3 %, and 1.4 % in one; zones of 50 of the same plate: sweeps of two of the six ended with their
work before they had found any way through. Walks that remember seven neighbours in place of three add next to nothing.
(By scripts that are not in the repository.)

## Many plates

Plates by seeds from 1001 on, by which nobody tunes, under the default profile, and beyond {moves} contours without
no-tip-travel. What a plan costs more than the best one known without zones, in {work:g} of work; below 0 where the
sweep of zones found a better one than any search. `excuses` counts plates whose plan has more of them than that one.

| plates | contours | mean | worst | excuses | proven | processor, s each |
|---:|---:|---:|---:|---:|---:|---:|
{many}

## Where the extra comes from

Geometry draws borders across the ways that the torch would take: that costs travel, and now and then an excuse. It is
not the size of zones, nor their order: where the runs of a plan without zones are zones, the plan in them costs no more
than that plan.

So a plan without zones is looked for first, and runs of it take the place of the zones. They must be zones still: no
more of them than geometry has made, or than a proof bears; what is left after each about as square, on an average,
where sides that differ by no more than `square_ratio` are square; each lying about as much together; the first at the
start side. Borders along a plan can lie in many places. First those are tried that lie as far on as a proof bears;
then, of all places, those that leave the rest squarest and the zones most together, by a shortest way over the places
between parts. Where a plan goes to and fro between parts for longer than a proof bears, borders lie between those parts
all the same, in the order of their middles. Where a proof takes too long, zones that are more come next, with what is
left of the work. Where all of these let the plan cost more than the one without zones, runs of any shape are zones, and
up to 150 contours the whole sheet is one if need be. Of all plans that were found so the one that costs least is taken,
proven or not; where it is not proven, the plan says what is proven within other zones.

Looks for a plan without zones, and tries along it, come in rungs of 0.1, 0.3, 1, 3, 10, 30 … of work: up to each rung
all is done as under every larger limit, each look from nothing by other random numbers, and the best of all looks is
kept. So more work brings no dearer plan, where the plan without zones pays for all that the other pays for (up to 150
contours). Where it does not, zones are tried that break it less than those proven before, and by no more than 10 % of
the best plan. Up to 60 contours geometry's own zones come before all this; they are mostly proven at once.

Beyond {few} contours the plan by the zones of geometry is proven within a small part of the work, and other zones are
proven about as fast. So the look without zones has what these two leave: from the plan with zones on, a large nest is
annealed, and then improved region by region. Where that plan goes back to a part much later, the part lies in the zone
in which it is cut last: the middle of its contours may be far off on the sheet. What rules state that do not look at
zones is not stated again. A look is not begun with less than {least:g} of work a contour, or {least_s:g} s, and beyond
{most_contours:,} contours zones stay as geometry makes them.
"""


@dataclass(frozen=True)
class Job:
    """A plate to plan: under the `whole` default profile, or with zones of `size` contours, None for such that move."""

    contours: int
    seed: int
    work: float
    without: float
    whole: bool = False
    size: int | None = None
    many: bool = False

    @property
    def profile(self) -> Profile:
        """What it is planned under."""
        profile = default_without(*(() if self.whole else ("no-tip-travel",)))
        rule = profile.rules["zone-order"]
        options = replace(rule.options, zone_contours=self.size)
        return replace(profile, rules={**profile.rules, "zone-order": replace(rule, options=options)})


@dataclass(frozen=True)
class Row:
    """One plate whose zones have moved: zones and costs, mm, with the weight of excuses."""

    plate: str
    zones: tuple[int, int]
    largest: int
    by_geometry_mm: float
    moved_mm: float
    proven: bool
    processor_s: float
    memory_mb: float
    without_mm: float
    told: str

    def __str__(self) -> str:
        more = (rest_mm(self.moved_mm) - rest_mm(self.without_mm)) / rest_mm(self.without_mm)
        cells = [self.plate, str(self.zones[0]), cost(self.by_geometry_mm), str(self.zones[1]), str(self.largest)]
        cells += [cost(self.moved_mm), _yes(self.proven), f"{self.processor_s:.0f}", f"{self.memory_mb:.0f}"]
        return f"| {' | '.join([*cells, cost(self.without_mm), f'{more:z.1%}', self.told])} |"


@dataclass(frozen=True)
class Sized:
    """One plate whose zones have about so many contours: costs in mm, with the weight of excuses."""

    plate: str
    size: int
    zones: int
    largest: int
    cost_mm: float
    bound_mm: float | None
    proven: bool
    processor_s: float
    memory_mb: float

    def __str__(self) -> str:
        bound = "" if self.bound_mm is None else cost(self.bound_mm)
        cells = [self.plate, str(self.size), str(self.zones), str(self.largest), cost(self.cost_mm), bound]
        return f"| {' | '.join([*cells, _yes(self.proven), f'{self.processor_s:.0f}', f'{self.memory_mb:.0f}'])} |"


@dataclass(frozen=True)
class Tail:
    """What zones cost on one of many plates: the plan, and the best one known without zones, mm."""

    contours: int
    seed: int
    cost_mm: float
    known_mm: float
    proven: bool
    processor_s: float

    @property
    def more(self) -> float:
        """Share of what is known, excuses aside."""
        return rest_mm(self.cost_mm) / rest_mm(self.known_mm) - 1.0

    @property
    def excused_more(self) -> bool:
        """Whether the plan has more excuses."""
        return self.cost_mm // EXEMPTION_MM > self.known_mm // EXEMPTION_MM

    def __str__(self) -> str:
        return f"{self.contours} contours, seed {self.seed}: {cost(self.cost_mm)} against {cost(self.known_mm)}"


def many_lines(tails: list[Tail], many: list[str]) -> str:
    """A line for each number of contours, which are listed as contours:plates."""
    lines = []
    for size in (int(named.split(":")[0]) for named in many):
        some = [tail for tail in tails if tail.contours == size]
        more = [tail.more for tail in some]
        worse, proven = sum(tail.excused_more for tail in some), sum(tail.proven for tail in some)
        took_s = sum(tail.processor_s for tail in some) / len(some)
        figures = f"{sum(more) / len(more):.1%} | {max(more):.1%} | {worse} | {proven} | {took_s:.0f}"
        lines.append(f"| {len(some)} | {size} | {figures} |")
    return "\n".join(lines)


def tail(job: Job) -> Tail:
    """Plan one of many plates, and look for one without zones beside it."""
    profile, nest = job.profile, made_plate(job.contours, job.seed)
    asked, limits = make_request(facts_of(nest, profile), profile), options_for(nest, profile, work=job.work)
    began_s = time.process_time()
    best = planned_by_zones(asked, profile, limits)
    took_s = time.process_time() - began_s
    known = [] if best.free is None or best.free.aside else [best.free.solution.objective]
    work = min(job.without * job.contours, MOST_WITHOUT)
    known += [found.objective for found in searched(asked, profile, best.solution, limits, work)]
    solution = best.solution
    return Tail(job.contours, job.seed, solution.objective, min(known), solution.status == "optimal", took_s)


def _yes(said: bool) -> str:
    return "yes" if said else "no"


def run(job: Job) -> Row | Sized | Tail:
    """Plan a plate."""
    if job.many:
        return tail(job)
    return moved(job) if job.size is None else sized(job)


def moved(job: Job) -> Row:
    """Plan one plate with zones that stay, with zones that move, and without any."""
    profile, nest = job.profile, made_plate(job.contours, job.seed)
    asked, limits = make_request(facts_of(nest, profile), profile), options_for(nest, profile, work=job.work)
    began_s = time.process_time()
    best = planned_by_zones(asked, profile, limits)
    took_s, memory_mb = time.process_time() - began_s, peak_mb()
    looks = lazy_statements(asked.facts, profile)
    stayed = solve(asked.facts, asked.stated.statements, limits, None, looks)
    known = [] if best.free is None or best.free.aside else [best.free.solution.objective]
    work = min(job.without * job.contours, MOST_WITHOUT)
    known += [found.objective for found in searched(best.asked, profile, best.solution, limits, work)]
    told = best.cost(limits)
    zone = best.asked.facts.zone
    return Row(
        _plate(asked.facts.n, job),
        (int(asked.facts.zone.max()), int(zone.max())),
        int(np.bincount(zone).max()),
        stayed.objective,
        best.solution.objective,
        best.solution.status == "optimal",
        took_s,
        memory_mb,
        min(known),
        "" if told is None else told.sentence,
    )


def sized(job: Job) -> Sized:
    """Plan one plate with zones of so many contours."""
    profile, nest = job.profile, made_plate(job.contours, job.seed)
    asked, limits = make_request(facts_of(nest, profile), profile), options_for(nest, profile, work=job.work)
    began_s = time.process_time()
    found = solve(asked.facts, asked.stated.statements, limits, None, lazy_statements(asked.facts, profile))
    took_s, zone = time.process_time() - began_s, asked.facts.zone
    zones, largest = int(zone.max()), int(np.bincount(zone).max())
    proven, plate, size = found.status == "optimal", _plate(asked.facts.n, job), job.size or 0
    return Sized(plate, size, zones, largest, found.objective, found.bound, proven, took_s, peak_mb())


def _plate(contours: int, job: Job) -> str:
    return f"{contours} contours, seed {job.seed}{', no-tip-travel' if job.whole else ''}"


def searched(
    asked: Request, profile: Profile, solution: Solution, limits: SolveOptions, work: float
) -> tuple[Solution, Solution]:
    """Plans that need not keep to zones, searched for from a planned one on and from nothing."""
    names = zoned_by(asked.facts, profile)
    statements = tuple(s for s in asked.stated.statements if s.about.rule not in names)
    limits = replace(limits, work=work / 2, member="search")
    from_here, from_nothing = (
        solve(asked.facts, statements, limits, None, lazy_statements(asked.facts, profile), start=start)
        for start in (solution.route, ())
    )
    return from_here, from_nothing


def jobs_of(given: argparse.Namespace) -> Iterator[Job]:
    """What to plan, in the order of the page."""
    for whole, plates in ((False, given.contours), (True, given.default)):
        for contours in plates:
            for seeds in (given.seeds, given.apart):
                for seed in seeds[: 1 if contours >= LARGE else None]:
                    yield Job(contours, seed, given.work, given.without, whole)
    for named in given.sizes:
        contours, sizes = named.split(":")
        for size in sizes.split(","):
            for seed in (*given.seeds, *given.apart):
                yield Job(int(contours), seed, given.work, given.without, size=int(size))
    for named in given.many:
        contours, count = map(int, named.split(":"))
        for seed in range(APART, APART + count):
            yield Job(contours, seed, given.work, given.without, contours <= MOST_MOVES, many=True)


def row_of(job: Job, kept: dict[str, Any], into: Path | None) -> Row | Sized | Tail:
    """The row of a plate, made in a process of its own unless it was kept."""
    name = json.dumps(asdict(job))
    if name not in kept:
        with multiprocessing.get_context("spawn").Pool(1) as pool:
            kept[name] = asdict(pool.apply(run, (job,)))
        if into is not None:
            into.write_text(json.dumps(kept), encoding="utf-8", newline="\n")
    kind = Tail if job.many else Row if job.size is None else Sized
    return kind(**kept[name])


def main() -> None:
    """Print the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--contours", type=int, nargs="+", default=[115, 308, 1000, 3000, 10000])
    parser.add_argument("--default", type=int, nargs="*", default=[115], help="such with no-tip-travel")
    parser.add_argument("--sizes", nargs="*", default=["308:40,50"], help="contours:size,size…")
    parser.add_argument("--many", nargs="*", default=[], help="contours:plates…")
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 11], help="looked at while this was made")
    parser.add_argument("--apart", type=int, nargs="+", default=[21], help="not looked at")
    parser.add_argument("--work", type=float, default=30.0)
    parser.add_argument("--without", type=float, default=0.03, help="work for plans without zones, a contour")
    parser.add_argument("--kept", type=Path, help="a file of rows that are made, and of those made before")
    given = parser.parse_args()
    load_kernels()
    kept = json.loads(given.kept.read_text(encoding="utf-8")) if given.kept and given.kept.exists() else {}
    rows: list[Row | Sized | Tail] = []
    for job in jobs_of(given):
        rows.append(row_of(job, kept, given.kept))
        print(rows[-1], file=sys.stderr, flush=True)
    names = ("contours", "default", "sizes", "many", "seeds", "apart")
    listed = {name: " ".join(map(str, getattr(given, name))) for name in names}
    page = PAGE.format(
        given=" ".join(f"--{name} {values}" for name, values in listed.items())
        + f" --work {given.work:g} --without {given.without:g}",
        seen=f"Seeds {listed['seeds'].replace(' ', ', ')}",
        apart=listed["apart"].replace(" ", ", "),
        work=given.work,
        without=given.without,
        most=MOST_WITHOUT,
        few=FEW,
        most_contours=MOST_CONTOURS,
        least=LEAST_WORK,
        least_s=LEAST_LOOK_S,
        kerfwise=kerfwise.__version__,
        python=platform.python_version(),
        moves=MOST_MOVES,
        many=many_lines([row for row in rows if isinstance(row, Tail)], given.many),
        rows="\n".join(str(row) for row in rows if isinstance(row, Row)),
        sizes="\n".join(str(row) for row in rows if isinstance(row, Sized)),
    )
    print(page, end="")


if __name__ == "__main__":
    main()
