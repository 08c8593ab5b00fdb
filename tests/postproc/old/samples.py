"""A folder of programs, read back, turned round and put in order: one line each.

    python -m kerfwise.tests.postproc.old.samples FOLDER [FEED]

For programs that may not be in this repository, such as QtPlasmaC's samples (LinuxCNC, `nc_files/plasmac`, GPL). Of
each it says what is told from its burns, the idle travel before and after, and that all burns are the same in any
order; or why it is refused. Where no nest can be told the burns are put in order without the rules.
"""

from __future__ import annotations

import sys
from pathlib import Path

from kerfwise.encoder.errors import InputError
from kerfwise.jobs.old_program import Asked
from kerfwise.jobs.resequence import resequence
from kerfwise.postproc.check.reader.old import read_old
from kerfwise.postproc.old.pieces import taken_apart
from kerfwise.postproc.old.reordered import expect_same, reordered


def main(folder: str, feed: str = "2500") -> int:
    """Print the table; the exit code says whether a program got longer."""
    files = sorted(path for path in Path(folder).iterdir() if path.suffix in (".ngc", ".nc"))
    read = longer = 0
    for path in files:
        try:
            apart = taken_apart(read_old(path.read_text(), feed_mm_min=float(feed), file=path.name))
            order = list(range(len(apart.pieces)))[::-1]
            expect_same(apart, order, read_old(reordered(apart, order), feed_mm_min=float(feed)))
            made = resequence(path, work=5, asked=Asked(feed_mm_min=float(feed)), without_rules=True)
        except InputError as error:
            print(f"{path.name}: refused: {error.message} (line {error.line})")
            continue
        read += 1
        longer += made.after.idle_mm > made.before.idle_mm
        kind = "no nest" if made.nest is None else f"{len(made.nest.parts)} parts"
        idle = f"idle {made.before.idle_mm:.1f} -> {made.after.idle_mm:.1f} mm"
        print(f"{path.name}: {len(apart.pieces)} burns, {kind}, {idle}")
    print(f"{read} of {len(files)} read, {longer} longer than before")
    return int(longer > 0)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:3]))
