"""The time that programs state against the sum over their own words: programs × six dialects, as docs/time.md has it.

`python -m kerfwise.tests.postproc.stated_times` prints the table, and exits 1 where any two are more than 5 % apart.
"""

from __future__ import annotations

import json
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import kerfwise as package
from kerfwise import InputError, Nest, Plan, Profile
from kerfwise.encoder.readers import read_nest
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.jobs.request import facts_of, make_request, options_for
from kerfwise.pipeline import solve_and_verify
from kerfwise.postproc.check.reader.read_program import read_on_machine
from kerfwise.postproc.check.stated import SHARE, stated_time_s, summed_time
from kerfwise.postproc.clock import with_times
from kerfwise.postproc.dialects import expect_words, load_dialect
from kerfwise.postproc.nc.program import write_program
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.overrides import read_setting, with_settings

NESTS = Path(package.__file__).parent / "examples" / "nests"
DIALECTS = {"linuxcnc": "", "linuxcnc-qtplasmac": "", "eia": "", "burny": "", "essi": "", "grbl": "laser-wood"}
"""Dialect → the profile that its programs are made by; "" for that of the row."""
ASKED: dict[str, tuple[str, ...]] = {
    "as shipped": (),
    "corners at 0.6": ("corners.corner_feed=0.6", "corners.corner_reach=4 mm"),
    "small holes at half": ("small_holes.small_hole_feed=0.5", "small_holes.full_feed_hole=80 mm"),
    "links": ("cuts.links.longest=60 mm",),
    "tabs": ("rules.hold-small-parts.strength=hard", "rules.hold-small-parts.tabs=all"),
    "oxyfuel": (),
    "laser": (),
}
BASES = {"oxyfuel": "oxyfuel-thick-plate", "laser": "laser-amg3m-1mm"}


@dataclass(frozen=True, slots=True)
class Row:
    """One program in one dialect: what its header (or, without comments, its plan) states, and its words come to."""

    nest: str
    asked: str
    dialect: str
    stated_s: float
    summed_s: float

    @property
    def apart(self) -> float:
        """How far apart they are, as a share of the sum."""
        return abs(self.stated_s - self.summed_s) / self.summed_s


def nests() -> dict[str, Nest]:
    """The programs' nests, by name."""
    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder) / "made.json"
        made.write_text(json.dumps(make_sheet(5, 30, (2000.0, 1000.0), 14.0)), encoding="utf-8")
        files = {"e1x_6": NESTS / "e1x_6.json", "plate40": NESTS / "plate40.json", "made, 30 parts": made}
        return {name: read_nest(file) for name, file in files.items()}


def _planned(nest: Nest, profile: Profile) -> Plan:
    asked = make_request(facts_of(nest, profile), profile, relax=True)
    return solve_and_verify(asked, profile, options_for(nest, profile, work=0.1)).plan


def rows(name: str, drawn: Nest, asked: str) -> Iterator[Row]:
    """The programs of one nest with these options; none in a dialect that has no words for it."""
    plans: dict[str, Plan] = {}
    for dialect, other in DIALECTS.items():
        base = load_profile(other or BASES.get(asked, "plasma-carbon-steel"))
        timed = replace(base, time=type(base.time)(), machine=replace(base.machine, accept_dialect=True))
        settings = [*ASKED[asked], f"machine.dialect={dialect}"]
        try:
            profile = with_settings(timed, [read_setting(text) for text in settings])
            nest = profile.as_cut(drawn)
            expect_words(nest, profile, load_dialect(dialect))
            if base.name not in plans:
                plans[base.name] = _planned(nest, profile)
            plan = with_times(plans[base.name], nest, profile)
            program = write_program(plan, nest, profile)
        except InputError:
            continue
        read = read_on_machine(program, nest, profile)
        header_s = stated_time_s(read.comments)
        stated_s = plan.totals.time_s if header_s is None else header_s
        yield Row(name, asked, dialect, stated_s, summed_time(read, profile).words_s)


def table(found: list[Row]) -> str:
    """A line for each program, with both times in each dialect, s."""
    lines = [f"| program | {' | '.join(f'`{dialect}`' for dialect in DIALECTS)} |", "|---|" + "---:|" * len(DIALECTS)]
    for key in dict.fromkeys((row.nest, row.asked) for row in found):
        cells = {r.dialect: f"{r.stated_s:.1f} / {r.summed_s:.1f}" for r in found if (r.nest, r.asked) == key}
        if len(cells) == 1:
            continue  # parts too near for this kerf
        lines.append(f"| {key[0]}, {key[1]} | {' | '.join(cells.get(dialect, '–') for dialect in DIALECTS)} |")
    return "\n".join(lines)


def main() -> None:
    """Print the table, and which is furthest apart."""
    found = [row for name, nest in nests().items() for asked in ASKED for row in rows(name, nest, asked)]
    worst = max(found, key=lambda row: row.apart)
    print(table(found))
    print(f"\n{len(found)} programs; furthest apart: {worst.apart:.2%}, {worst.nest}, {worst.asked}, {worst.dialect}")
    sys.exit(int(worst.apart > SHARE))


if __name__ == "__main__":
    main()
