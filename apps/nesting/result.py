"""What nesting gives back in Python: the nests, what did not fit or was left out, and what was weighed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from kerfwise.encoder.nest import Nest
from kerfwise.jobs.display import Picture
from kerfwise.postproc.report import draw
from kerfwise.rules.profile.profile import Profile

from .find_nests import NestingResult, weighed_lines
from .nest_list import GroupRequest, ListRequest, left_out_text, write_list
from .nests import Nested, expect_folder, lines_of, nest_files
from .placement.layout import share_used
from .programs import Programs


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class Nests:
    """Parts laid on sheets. `print(nests)` says what `kerfwise nest`, or `kerfwise make`, prints.

    Attributes
    ----------
    nests
        A nest a sheet, as they can be given to `solve`: of a list of several materials those of one after the other.
    profile
        The profile that distances and prices are of; of a list of several materials that of the first.
    programs
        What `make` has planned, a line a sheet; empty for `nest`.
    notes
        What the readers had to say, and which sheets were repaired.
    left_out
        Parts that cannot be read or cut, by name: why. Empty unless `skip_bad`.
    interrupted
        Whether Ctrl-C, or the progress callback, ended the look: the nests are the best so far.
    """

    nests: tuple[Nest, ...]
    profile: Profile
    programs: tuple[str, ...]
    notes: tuple[str, ...]
    left_out: dict[str, str]
    interrupted: bool
    _asked: ListRequest
    _found: tuple[Done, ...]

    @property
    def missing(self) -> dict[str, int]:
        """Parts that are on no sheet, by name: how many."""
        layouts = [one.nested.layout for one in self._found]
        return {
            kind.name: lost
            for layout in layouts
            for kind, lost in zip(layout.wanted.types, layout.missing, strict=True)
            if lost
        }

    @property
    def use(self) -> float:
        """Metal of all parts laid, of that of all sheets taken."""
        return share_used([one.nested.layout for one in self._found])

    @property
    def prices(self) -> tuple[float | None, ...]:
        """What each layout that was weighed costs to cut, the densest first; None for one that has no plan."""
        return tuple(one.price for done in self._found for one in done.result.weighed)

    @property
    def folders(self) -> tuple[str, ...]:
        """The folder that `save` writes each nest to: "" but for a list of several materials."""
        return tuple(self._asked.folder(done.group) for done in self._found for _ in done.nested.nests)

    def picture(self, sheet: int = 1) -> Picture:
        """A nest as SVG; sheets count from 1."""
        return Picture(draw(self.nests[sheet - 1], None, ".svg"), "svg")

    def save(self, folder: str | Path, dxf: bool = False) -> list[Path]:
        """Write nests, pictures and the table, and of `make` programs and plans, as the command line does.

        Raises
        ------
        InputError
            If the folder holds files of others.
        """
        out = Path(folder)
        expect_folder(out)
        files = [(done.group, done.nested, done.files(dxf)) for done in self._found]
        return write_list(out, self._asked, files)

    def __str__(self) -> str:
        lines = []
        for done in self._found:
            if head := self._asked.head(done.group):
                lines.append(head)
            lines += lines_of(done.nested)
            lines += weighed_lines(done.result, done.group.cutting.plant)
            lines += () if done.made is None else done.made.told
        return "\n".join([*lines, *([left_out_text(self._asked.bad)] if self._asked.bad else [])])

    __repr__ = __str__


@dataclass(frozen=True, eq=False, slots=True)
class Done:
    """A group, its nests, and what `make` made of them."""

    group: GroupRequest
    result: NestingResult
    made: Programs | None = None

    @property
    def nested(self) -> Nested:
        """The nests as they are written: those of the programs, which may be repaired."""
        return self.result.nested if self.made is None else self.made.nested

    def files(self, dxf: bool) -> dict[str, str | bytes]:
        """Nests and pictures, and what `make` made, by the names that they have."""
        return nest_files(self.nested, ".svg", dxf) if self.made is None else self.made.files(dxf)


def nests_of_job(request: ListRequest, done: Sequence[Done], notes: list[str]) -> Nests:
    """What the job has found, and made of it."""
    interrupted = len(done) < len(request.groups) or any(
        one.result.interrupted or (one.made is not None and one.made.interrupted) for one in done
    )
    nests = tuple(nest for one in done for nest in one.nested.nests)
    programs = tuple(text for one in done if one.made is not None for text in one.made.told)
    left_out = {one.name or str(one.place): one.why for one in request.bad}
    plant = request.groups[0].cutting.plant
    return Nests(nests, plant, programs, tuple(notes), left_out, interrupted, request, tuple(done))
