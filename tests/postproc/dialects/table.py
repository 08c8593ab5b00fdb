"""docs/dialects.md: each dialect, each outside reader, some nests, and how far what they read is from the plan.

`python -m kerfwise.tests.postproc.dialects.table > docs/dialects.md` prints the page; it needs rs274, Node.js with
gcode-toolpath, and MeerK40t, as the test command fetches them.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

from kerfwise import Nest, Plan, Profile
from kerfwise.postproc.dialects import load_dialect
from kerfwise.postproc.nc.program import write_program
from kerfwise.tests.tools.outside.heard import Heard

from . import cases, reading

PAGE = """\
# Dialects, and who reads them

Made by `python -m kerfwise.tests.postproc.dialects.table > docs/dialects.md`. Each nest is planned once, and its plan
written in each dialect: three nests under the default profile, and nests with links, with tabs, with marks, with a
skeleton that is cut up, and with common cuts. Marks are written in the dialects that have words for them, a
laser's tabs in those for lasers, since others know none within a burn.
Of each reader's burns the table has how many there are, how far their paths lie from the plan's at most (arcs are
compared as chords within 0.003 mm), and how much longer the torch is on, and travels, than the plan says. "The check"
is the reader of kerfwise itself, which shares nothing with the writer.

- *rs274* is LinuxCNC's interpreter. Programs of other controls are spelt in its words first, block for block (M07
  becomes M3, and so on). The spelling is ours and proves nothing; units, positions, arcs and lengths are the
  interpreter's.
- *gcode-toolpath* is a reader of cncjs, from npm. It knows no M words: what moves at a feed is taken for a burn, the
  way over a tab, too. Of Burny, which has no motion words, it can say nothing, nor of `fanuc`, whose subprograms it
  does not call (M98; rs274 reads what is called in its place); ESSI and HPGL are spelt in letters for it, as for rs274.
- *MeerK40t* reads programs for GRBL lasers. It takes I and J without scaling them, so it gets chords within
  0.0004 mm instead of arcs.

Nobody here had a control to try: what a dialect says of a control's words comes from its maker's documents, for Burny
from a post-processor of a third party alone; `mach`, `marlin`, `fanuc`, `sinumerik` and `hpgl` are data alone, over a
family that the check knows. No reader of ESSI could be had. It counts in whole tenths of a mm, HPGL in 0.025 mm,
so that their paths may lie one step from the plan's, and chords that zigzag by as much are a little longer.

| nest | dialect | reader | burns | apart, mm | torch on, mm | travel, mm |
|---|---|---|---:|---:|---:|---:|
{rows}
{disagreements}

{beside}"""
BESIDE = Path(__file__).with_name("beside_others.md").read_text(encoding="utf-8")
Reader = Callable[[], Heard]


def main() -> None:
    """Print the page; exit code 1 where a reader disagrees."""
    rows, wrong, worst = [], 0, dict.fromkeys(("ESSI and HPGL", "all others"), 0.0)
    for name in cases.NAMES:
        case, plan = cases.case(name), cases.planned(name, 4.0)
        for dialect in case.dialects:
            plant = case.plant(dialect)
            for reader, read in _readers(plan, case.nest, plant).items():
                found = reading.differences(plan, case.nest, plant, read())
                wrong += not reading.agree(found, load_dialect(dialect), plan.totals.cut_mm)
                of = "ESSI and HPGL" if load_dialect(dialect).step_mm > 0.01 else "all others"
                worst[of] = max(worst[of], found.apart_mm)
                rows.append(
                    f"| {name} | {dialect} | {reader} | {found.burns} of {found.paths} | {found.apart_mm:.4f} | "
                    f"{found.cut_mm:+.4f} | {found.idle_mm:+.4f} |"
                )
    told = f"{len(rows)} readings, {wrong} disagree (more than 0.01 mm apart, or 0.1 mm in all; "
    told += "ESSI and HPGL: their steps, 0.1 %)."
    told += " The farthest apart: " + ", ".join(f"{of} {mm:.4f} mm" for of, mm in worst.items()) + "."
    sys.stdout.write(PAGE.format(rows="\n".join(rows), disagreements=f"\n{told}", beside=BESIDE))
    sys.exit(wrong > 0)


def _readers(plan: Plan, nest: Nest, plant: Profile) -> dict[str, Reader]:
    dialect = load_dialect(plant.machine.dialect)
    text = write_program(plan, nest, plant)
    readers: dict[str, Reader] = {
        "the check": lambda: reading.of_check(text, nest, plant),
        "rs274": lambda: reading.of_linuxcnc(text, dialect.control, any(p.cut.tabs for p in plan.cuts), dialect.name),
    }
    if dialect.line and dialect.subprogram is None:  # it calls nothing
        readers["gcode-toolpath"] = lambda: reading.of_toolpath(text, dialect.control, dialect.name)
    if dialect.control == "grbl":
        readers["MeerK40t"] = lambda: reading.of_meerk40t(plan, nest, plant)
    return readers


if __name__ == "__main__":
    main()
