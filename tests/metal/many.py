"""Hundreds of made nests under every shipped profile, each program burnt by the simulation.

`python -m kerfwise.tests.metal.many --nests 300` prints the counts and exits 1 where there is a finding.
"""

from __future__ import annotations

import multiprocessing
import sys
import time
from collections import Counter
from collections.abc import Iterable, Iterator
from itertools import product
from pathlib import Path

import click

from kerfwise.tests.metal.findings import KINDS
from kerfwise.tests.metal.made_nests import Made, made
from kerfwise.tests.metal.planned import BEYOND, Tried, beyond, nest_of, tried
from kerfwise.tests.tools.shipped import PROFILES
from kerfwise.tests.until_stopped import until_stopped

Task = tuple[int, str, tuple[str, ...], bool, str]
PLANS_PER_PROCESS = 40
"""A process plans this many and then gives its memory back."""


@click.command()
@click.option("--nests", default=300, show_default=True, help="How many.")
@click.option("--first", default=0, show_default=True, help="Seed of the first.")
@click.option("--profiles", default="all", show_default=True, help="Names or files, with commas between.")
@click.option("--time", "time_s", type=float, help="Seconds for each plan, instead of work.")
@click.option("--work", default=2.0, show_default=True, help="Deterministic limit for each plan.")
@click.option("--processes", default=2, show_default=True, help="How many plan at the same time.")
@click.option(
    "--save", type=click.Path(file_okay=False, path_type=Path), help="Folder for the smallest nest of a kind."
)
@click.option("--rests", is_flag=True, help="Stop after half of each program's cuts, and plan and judge the rest too.")
@click.option("--each", is_flag=True, help="Print every finding.")
@click.option("--plain", is_flag=True, help="No links, tabs, common cuts and the like, whatever the seed.")
@click.option(
    "--given", type=click.Choice(list(BEYOND)), help="What each profile is given besides, in place of one in turn."
)
@click.option("--minutes", type=float, help="Begin no more plans after so long.")
def main(
    nests: int,
    first: int,
    profiles: str,
    time_s: float | None,
    work: float,
    processes: int,
    save: Path | None,
    rests: bool,
    each: bool,
    plain: bool,
    given: str | None,
    minutes: float | None,
) -> None:
    """Plan made nests under profiles and judge every program by what it burns.

    Ctrl-C ends it early, with the counts so far.
    """
    names = tuple(PROFILES) if profiles == "all" else tuple(map(_profile, profiles.split(",")))
    effort = ("--time-limit", str(time_s)) if time_s else ("--work", str(work))
    pairs = product(range(first, first + nests), names)
    besides = "" if plain else given
    tasks = [(seed, name, effort, rests, beyond(seed, name) if besides is None else besides) for seed, name in pairs]
    started, tally = time.monotonic(), Tally()
    for of_one in until_stopped(_run(tasks, processes), len(tasks), "plans", minutes):
        for done in of_one:
            tally.add(done)
            for line in _told(done, each):
                click.echo(line)
    seeds = sorted(tally.seeds)
    sizes = [made(seed).contours for seed in seeds]
    which = f" (seeds {seeds[0]} to {seeds[-1]}, {min(sizes)} to {max(sizes)} contours)" if seeds else ""
    click.echo(f"nests made: {len(seeds)}{which}")
    click.echo("\n".join(tally.lines(names)))
    if save:
        tally.save(save)
    click.echo(f"minutes: {(time.monotonic() - started) / 60:.1f}", err=True)
    sys.exit(1 if tally.faulty else 0)


def _profile(name: str) -> str:
    """A profile's name, or the whole path of its file."""
    return str(Path(name).resolve()) if Path(name).is_file() else name


def _run(tasks: list[Task], processes: int) -> Iterator[tuple[Tried, ...]]:
    """In the order of the tasks, whatever the number of processes."""
    if processes == 1:
        yield from map(_one, tasks)
        return
    context = multiprocessing.get_context("spawn")
    with context.Pool(processes, maxtasksperchild=PLANS_PER_PROCESS) as pool:
        yield from pool.imap(_one, tasks)


def _one(task: Task) -> tuple[Tried, ...]:
    seed, profile, effort, rests, cuts_with = task
    return tried(nest_of(seed, profile, cuts_with), profile, effort, rests, cuts_with)


def _told(done: Tried, each: bool) -> Iterable[str]:
    head = f"seed {done.seed}, {_by(done)}"
    if done.broken:
        yield f"{head}: {done.broken}"
    if each:
        yield from (f"{head}: {found}" for found in done.findings)


def _nest_of(done: Tried) -> Made:
    return nest_of(done.seed, done.profile, done.cuts_with)


def _by(done: Tried) -> str:
    return ", ".join(word for word in (done.profile, done.cuts_with, "the rest" if done.rest else "") if word)


class Tally:
    """Counts of what came of all plans, and the smallest nest of every kind of finding."""

    def __init__(self) -> None:
        self.plans, self.rests = 0, 0
        self.seeds: set[int] = set()
        self.programs_with: Counter[str] = Counter()
        self.along_edges: Counter[str] = Counter()
        self.refused: Counter[str] = Counter()
        self.programs: Counter[str] = Counter()
        self.cuts: Counter[str] = Counter()
        self.found: Counter[str] = Counter()
        self.found_by: Counter[str] = Counter()
        self.in_programs: Counter[str] = Counter()
        self.broken = 0
        self.smallest: dict[str, tuple[int, Tried]] = {}

    @property
    def faulty(self) -> bool:
        """Whether anything is wrong."""
        return bool(self.found or self.broken)

    def add(self, done: Tried) -> None:
        """Count one."""
        self.seeds.add(done.seed)
        self.plans += not done.rest
        self.rests += done.rest
        if done.refused:
            self.refused[done.refused] += 1
        elif done.broken:
            self.broken += 1
        else:
            self.programs[done.profile] += 1
            self.programs_with[done.cuts_with] += 1
            self.along_edges[done.cuts_with] += done.along_edges
            self.cuts[done.profile] += done.cuts
        kinds = Counter[str](f.kind for f in done.findings)
        self.found.update(kinds)
        self.in_programs.update(kinds.keys())
        self.found_by[done.profile] += len(done.findings)
        for kind in kinds:
            size = _nest_of(done).contours
            if kind not in self.smallest or size < self.smallest[kind][0]:
                self.smallest[kind] = size, done

    def lines(self, profiles: Iterable[str]) -> Iterator[str]:
        """The report."""
        rests = f", rests of broken-off ones: {self.rests}" if self.rests else ""
        yield f"plans asked: {self.plans}{rests}, refused: {self.refused.total()}, broken: {self.broken}"
        for text, count in sorted(self.refused.items(), key=lambda item: (-item[1], item[0])):
            yield f"  refused {count:5d}  {text}"
        yield f"programs burnt: {self.programs.total()}, cuts: {self.cuts.total()}, findings: {self.found.total()}"
        for with_what in (what for what in BEYOND if self.programs_with[what]):
            line = f"  with {with_what or 'none of these':18s} programs {self.programs_with[with_what]:4d}"
            along = self.along_edges[with_what]
            yield f"{line}, {along} of their cuts along common edges" if along else line
        for name in profiles:
            counts = f"programs {self.programs[name]:4d}  cuts {self.cuts[name]:6d}  findings {self.found_by[name]:5d}"
            yield f"  {Path(name).stem:22s} {counts}"
        for kind in KINDS:
            if kind in self.smallest:
                size, done = self.smallest[kind]
                where = f"smallest: seed {done.seed} ({_nest_of(done).family}, {size} contours), {_by(done)}"
                yield f"  {kind:18s} {self.found[kind]:5d} in {self.in_programs[kind]:4d} programs; {where}"
                yield f"      {next(f for f in done.findings if f.kind == kind)}"

    def save(self, folder: Path) -> None:
        """Write the smallest nest of every kind, with its program, as KIND.json and KIND.nc."""
        folder.mkdir(parents=True, exist_ok=True)
        for kind, (_, done) in self.smallest.items():
            (folder / f"{kind}.json").write_text(_nest_of(done).text, encoding="utf-8")
            (folder / f"{kind}.nc").write_text(done.program, encoding="utf-8")


if __name__ == "__main__":
    main()
