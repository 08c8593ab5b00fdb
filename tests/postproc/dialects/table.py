"""docs/dialects.md: each dialect, each outside reader, some real nests, and how far what they read is from the plan.

`python -m kerfwise.tests.postproc.dialects.table > docs/dialects.md` prints the page; it needs rs274, Node.js with
gcode-toolpath, and MeerK40t, as the test command fetches them.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import kerfwise
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers import ReadOptions
from kerfwise.encoder.readers.json_nest import read_json
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.jobs.ask import ask, facts_of
from kerfwise.jobs.produce import produce
from kerfwise.jobs.solve_options import options_for
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.dialects import dialect_names, load_dialect
from kerfwise.postproc.nc.program import write_program
from kerfwise.rules.profile.profile import DEFAULT, Profile, load_profile
from kerfwise.tests.tools.outside.heard import Heard

from . import reading

EXAMPLES = Path(kerfwise.__file__).parent / "examples" / "nests"
PAGE = """\
# Dialects, and who reads them

Made by `python -m kerfwise.tests.postproc.dialects.table > docs/dialects.md`. Each nest is planned once, under the
default profile, and its plan written in each dialect. Of each reader's burns the table has how many there are, how far
their paths lie from the plan's at most (arcs are compared as chords within 0.003 mm), and how much longer the torch is
on, and travels, than the plan says. "The check" is the reader of kerfwise itself, which shares nothing with the writer.

- *rs274* is LinuxCNC's interpreter. Programs of other controls are spelt in its words first, block for block (M07
  becomes M3, and so on). The spelling is ours and proves nothing; units, positions, arcs and lengths are the
  interpreter's.
- *gcode-toolpath* is a reader of cncjs, from npm. It knows no M words: what moves at a feed is taken for a burn. Of
  Burny, which has no motion words, it can say nothing; ESSI is spelt in letters for it, as for rs274.
- *MeerK40t* reads programs for GRBL lasers. It takes I and J without scaling them, so it gets chords within
  0.0004 mm instead of arcs.

Nobody here had a control to try: what a dialect says of a control's words comes from its maker's documents, for Burny
from a post-processor of a third party alone. No reader of ESSI could be had. It counts in whole tenths of a millimetre,
so that its paths may lie one step from the plan's, and chords that zigzag by as much are a little longer.

| nest | dialect | reader | burns | apart, mm | torch on, mm | travel, mm |
|---|---|---|---:|---:|---:|---:|
{rows}
{disagreements}
"""
Reader = Callable[[], Heard]


def main() -> None:
    """Print the page; exit code 1 where a reader disagrees."""
    rows, wrong = [], 0
    for name, nest in nests():
        profile = load_profile(DEFAULT)
        made = produce(ask(facts_of(nest, profile), profile), profile, options_for(nest, profile, work=4.0))
        for dialect in dialect_names():
            plant = reading.with_dialect(profile, dialect)
            for reader, read in _readers(made.plan, nest, plant).items():
                found = reading.differences(made.plan, nest, plant, read())
                wrong += not reading.agree(found, load_dialect(dialect), made.plan.totals.cut_mm)
                rows.append(
                    f"| {name} | {dialect} | {reader} | {found.burns} of {found.paths} | {found.apart_mm:.4f} | "
                    f"{found.cut_mm:+.4f} | {found.idle_mm:+.4f} |"
                )
    told = f"{len(rows)} readings, {wrong} disagree (more than 0.01 mm apart, or 0.1 mm in all; ESSI: 0.1 mm, 0.1 %)."
    sys.stdout.write(PAGE.format(rows="\n".join(rows), disagreements=f"\n{told}"))
    sys.exit(wrong > 0)


def nests() -> Iterator[tuple[str, Nest]]:
    for name in ("e1x_6", "s8877"):
        yield name, kerfwise.read_nest(EXAMPLES / f"{name}.dxf")
    yield "a made plate of 115 contours", read_json(json.dumps(make_sheet(1, 115)).encode(), ReadOptions())


def _readers(plan: Plan, nest: Nest, plant: Profile) -> dict[str, Reader]:
    dialect = load_dialect(plant.machine.dialect)
    text = write_program(plan, nest, plant)
    readers: dict[str, Reader] = {
        "the check": lambda: reading.of_check(text, nest, plant),
        "rs274": lambda: reading.of_linuxcnc(text, dialect.control),
    }
    if dialect.line:
        readers["gcode-toolpath"] = lambda: reading.of_toolpath(text, dialect.control)
    if dialect.control == "grbl":
        readers["MeerK40t"] = lambda: reading.of_meerk40t(plan, nest, plant)
    return readers


if __name__ == "__main__":
    main()
