"""A folder of programs, read back, turned round and put in order: one line each.

    python -m kerfwise.tests.postproc.old.samples FOLDER [FEED]

For programs that may not be in this repository, such as QtPlasmaC's samples (LinuxCNC, `nc_files/plasmac`, GPL). Of
each it says what is told from its burns, the idle travel before and after, and that all burns are the same in any
order; or why it is refused. Where no nest can be told the burns are put in order without the rules.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from kerfwise import InputError
from kerfwise.apps.resequence.resequence import resequence
from kerfwise.jobs.programs import ProgramRequest
from kerfwise.postproc.check.reader.read_program import read_old
from kerfwise.postproc.old.program_pieces import expect_same, reordered, split_program
from kerfwise.tests.tools import canon


@dataclass(frozen=True, slots=True)
class Sample:
    """What became of one program: idle travel before and after, mm, or why it was refused, and its line.

    `same` is what LinuxCNC's interpreter says of both programs' burns, once words of QtPlasmaC are taken out.
    """

    name: str
    told: str
    idle_mm: tuple[float, float] | None
    line: int | None = None
    same: str = ""

    @property
    def longer(self) -> bool:
        """Whether the new one travels further."""
        return self.idle_mm is not None and self.idle_mm[1] > self.idle_mm[0] + 1e-6


def samples(folder: Path, feed_mm_min: float = 2500.0) -> Iterator[Sample]:
    """All programs of a folder, by name."""
    for path in sorted(path for path in folder.iterdir() if path.suffix in (".ngc", ".nc")):
        try:
            apart = split_program(read_old(path.read_text(), feed_mm_min=feed_mm_min, file=path.name))
            order = list(range(len(apart.pieces)))[::-1]
            expect_same(apart, order, read_old(reordered(apart, order), feed_mm_min=feed_mm_min))
            made = resequence(path, work=5, request=ProgramRequest(feed_mm_min=feed_mm_min), without_rules=True)
        except InputError as error:
            yield Sample(path.name, f"refused: {error.message} (line {error.line})", None, error.line)
            continue
        kind = "no nest" if made.nest is None else f"{len(made.nest.parts)} parts"
        idle_mm = made.before.idle_mm, made.after.idle_mm
        told = f"{len(apart.pieces)} burns, {kind}, idle {idle_mm[0]:.1f} -> {idle_mm[1]:.1f} mm"
        same = by_linuxcnc(path.read_text(), made.program, feed_mm_min)
        yield Sample(path.name, f"{told}, rs274: {same}", idle_mm, same=same)


_OF_QTPLASMAC = re.compile(
    r"^.*(?:M190|M66|M159|M52|G43|T[0-9]+ ?M6|M6 ?T[0-9]+|\(o=|#<(?:holes|h_|oclength|keep)).*$",
    re.IGNORECASE | re.MULTILINE,
)


def by_linuxcnc(old: str, new: str, feed_mm_min: float) -> str:
    """Whether LinuxCNC's interpreter finds the same burns in both programs, in whatever order."""
    found = []
    for text in (old, new):
        feed = feed_mm_min / 25.4 if re.search(r"G20(?![0-9])", text) else feed_mm_min
        text = re.sub(r"F#<_hal\[plasmac\.cut-feed-rate\]>", f"F{feed:.6f}", text, flags=re.IGNORECASE)
        run = canon.run(_OF_QTPLASMAC.sub("", text))
        if run.error is not None:
            return f"not run ({run.error[:40]})"
        found.append(sorted([(round(x, 2), round(y, 2)) for x, y in burn.points] for burn in run.burns))
    near = len(found[0]) == len(found[1]) and all(
        len(one) == len(other) and np.abs(np.array(one) - np.array(other)).max() <= 0.011
        for one, other in zip(*found, strict=True)
    )
    return "the same burns" if near else "other burns"


def main(folder: str, feed: str = "2500") -> int:
    """Print the table; the exit code says whether a program got longer."""
    found = []
    for sample in samples(Path(folder), float(feed)):
        found.append(sample)
        print(f"{sample.name}: {sample.told}")
    longer = sum(sample.longer for sample in found)
    print(f"{sum(s.idle_mm is not None for s in found)} of {len(found)} read, {longer} longer than before")
    return int(longer > 0)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:3]))
