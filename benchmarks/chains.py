"""What links save: the best plan with them against the plain one, by what a pierce takes.

Usage: python -m kerfwise.benchmarks.chains [--contours 115 308] [--large 1000] [--pierce 0.5 1 2] [--work 20]
       [--nests FILE …] [--kept FOLDER] [--proven 115 308 1000]

Made plates (examples/gen_sheet.py, seed 1), and nests of files, under the default profile, plasma, and under a laser's,
once as it is and once with `cuts: {links: {longest: 100 mm}}`. The large ones and those of files are planned for the
longest pierce and for the laser alone. Each program is checked; one that fails ends the run.
With --kept rows are kept in a folder, and one that stands there is not run again. With --proven the page says too how
soon such plates are proven in zones that stay, with links and without.
"""

from __future__ import annotations

import argparse
import json
import platform
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path

import kerfwise
from kerfwise.benchmarks import chain_proofs
from kerfwise.benchmarks.plates import checked_plan, made_plate
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers import read_nest
from kerfwise.models.plan.plan import Plan
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.sections import Cuts, Links

LONGEST_MM = 100.0
LASER = "laser-st10kp-2mm"
PROFILES = {"plasma": "plasma-carbon-steel", "laser": LASER}
LASER_PIERCE_S = 0.3
PAGE = """\
# What chains save

Made by `python -m kerfwise.benchmarks.chains {asked} > docs/chains.md`
with kerfwise {kerfwise}, Python {python}: plates of `examples/gen_sheet.py`, seed 1{files}, under the default
profile (plasma, feed 2.5 m/min, travel 15 m/min) and under `{laser}` (0.3 s a pierce), once as they are and once
with links of up to {longest:g} mm ([chains](links.md)), straight or round one corner.

A plan without links has the least idle travel; one with links has the least time. Beside the time of the whole
program stands what lies *between* the cuts, by which plans differ most: idle travel, pierces and links, leads left out.
The gap is what is not proven, of a plan's own cost. The processor's seconds are those of the whole run: facts, plan,
program and check.

| nest | process | pierce, s | links | pierces | cut, m | idle, m | between, s | program, s | gap | processor, s |
|---|---|---:|---|---:|---:|---:|---:|---:|---:|---:|
{rows}
{proofs}"""


@dataclass(frozen=True)
class Row:
    """One plan: what it is of, and what it comes to."""

    plate: str
    process: str
    pierce_s: float
    links: int | None
    pierces: int
    cut_mm: float
    idle_mm: float
    between_s: float
    program_s: float
    gap: float | None
    spent_s: float

    def __str__(self) -> str:
        cells = (
            self.plate, self.process, f"{self.pierce_s:g}", "–" if self.links is None else str(self.links),
            str(self.pierces),
            f"{self.cut_mm / 1000:.2f}", f"{self.idle_mm / 1000:.2f}", f"{self.between_s:.1f}", f"{self.program_s:.0f}",
            "–" if self.gap is None else "0" if self.gap == 0 else f"{self.gap:.2%}", f"{self.spent_s:.0f}",
        )  # fmt: skip
        return f"| {' | '.join(cells)} |"


def plant(process: str, pierce_s: float, linked: bool) -> Profile:
    """The profile of a process with a pierce of so many seconds."""
    profile = load_profile(PROFILES[process])
    cuts = Cuts(links=Links(longest_mm=LONGEST_MM)) if linked else Cuts()
    return replace(profile, machine=replace(profile.machine, pierce_time_s=pierce_s), cuts=cuts)


def between_s(plan: Plan, profile: Profile) -> float:
    """The time of idle travel, pierces and links."""
    machine = profile.machine
    links_mm = sum(p.cut.lead_in.length_mm for p in plan.cuts if p.cut.linked and p.cut.lead_in is not None)
    pierces_s = plan.totals.pierces * machine.pierce_time_s
    return plan.totals.idle_mm / machine.travel_mm_s + pierces_s + links_mm / machine.cut_feed_mm_s


def row(nest: Nest, name: str, process: str, pierce_s: float, linked: bool, work: float) -> Row:
    """Plan and check a plate.

    Raises
    ------
    SystemExit
        If its program does not pass the check.
    """
    profile, began_s = plant(process, pierce_s, linked), time.process_time()
    made = checked_plan(name, nest, profile, work, and_zones=True)
    plan = made.plan
    return Row(
        name,
        process,
        pierce_s,
        sum(p.cut.linked for p in plan.cuts) if linked else None,
        plan.totals.pierces,
        plan.totals.cut_mm,
        plan.totals.idle_mm,
        between_s(plan, profile),
        plan.totals.time_s,
        plan.solve.gap,
        time.process_time() - began_s,
    )


def kept(file: Path | None, made: Callable[[], Row]) -> Row:
    """The row that a file keeps; where it keeps none the row is made, and kept."""
    if file is not None and file.exists():
        return Row(**json.loads(file.read_text(encoding="utf-8")))
    fresh = made()
    if file is not None:
        file.write_text(json.dumps(asdict(fresh)) + "\n", encoding="utf-8", newline="\n")
    return fresh


def main() -> None:
    """Print the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--contours", type=int, nargs="*", default=[115, 308])
    parser.add_argument("--large", type=int, nargs="*", default=[])
    parser.add_argument("--pierce", type=float, nargs="+", default=[0.5, 1.0, 2.0])
    parser.add_argument("--nests", type=Path, nargs="*", default=[], metavar="FILE")
    parser.add_argument("--work", type=float, default=20.0)
    parser.add_argument("--proven", type=int, nargs="*", default=[])
    parser.add_argument("--kept", type=Path, metavar="FOLDER")
    given = parser.parse_args()
    if given.kept is not None:
        given.kept.mkdir(parents=True, exist_ok=True)
    rows = []
    for what, nest, pierces_s in list(_nests(given)):  # a file that is missing is told before the first plan
        name = what if given.nests and what in {file.stem for file in given.nests} else f"{len(nest.contours)} contours"
        plans = [*(("plasma", s) for s in pierces_s), ("laser", LASER_PIERCE_S)]
        for process, pierce_s in plans:
            for linked in (False, True):
                stem = f"{what}.{process}.{pierce_s:g}.{'links' if linked else 'plain'}"
                file = given.kept and given.kept / f"{stem}.json"
                rows.append(str(kept(file, partial(row, nest, name, process, pierce_s, linked, given.work))))
                print(rows[-1], file=sys.stderr, flush=True)
    page = PAGE.format(
        asked=_asked(given),
        files=", and packed nests" if given.nests else "",
        laser=LASER,
        longest=LONGEST_MM,
        kerfwise=kerfwise.__version__,
        python=platform.python_version(),
        rows="\n".join(rows),
        proofs=_proofs(given.proven, max(given.pierce)),
    )
    print(page, end="")


def _proofs(sizes: Sequence[int], pierce_s: float) -> str:
    """The table of proofs, under its heading; nothing where none is asked for."""
    if not sizes:
        return ""
    head = chain_proofs.HEAD.format(pierce=pierce_s, tries=chain_proofs.TRIES)
    lines = []
    for line in chain_proofs.rows(sizes, pierce_s, LONGEST_MM):
        print(line, file=sys.stderr, flush=True)
        lines.append(f"{line}\n")
    return f"\n{head}{''.join(lines)}"


def _nests(given: argparse.Namespace) -> Iterator[tuple[str, Nest, list[float]]]:
    """What each nest is called, the nest, and the times to pierce that it is planned for."""
    for contours in (*given.contours, *given.large):
        nest = made_plate(contours, seed=1)
        yield str(contours), nest, [max(given.pierce)] if contours in given.large else given.pierce
    for file in given.nests:
        yield file.stem, read_nest(file), [max(given.pierce)]


def _asked(given: argparse.Namespace) -> str:
    words = ["--contours", *map(str, given.contours)]
    words += ["--large", *map(str, given.large)] if given.large else []
    words += ["--pierce", *(f"{s:g}" for s in given.pierce), "--work", f"{given.work:g}"]
    words += ["--nests", *(file.name for file in given.nests)] if given.nests else []
    words += ["--proven", *map(str, given.proven)] if given.proven else []
    return " ".join(words)


if __name__ == "__main__":
    main()
