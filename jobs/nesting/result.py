"""What nesting gives back in Python: the nests, what did not fit, and what was weighed."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from kerfwise.encoder.nest import Nest
from kerfwise.jobs.display import Picture
from kerfwise.postproc.report import draw
from kerfwise.rules.profile.profile import Profile

from .find_nests import NestingResult, weighed_text
from .nests import Nested, as_text, expect_folder, nest_files, use_of_all, write_nests
from .programs import Programs


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class Nests:
    """Parts laid on sheets. `print(nests)` says what `kerfwise nest`, or `kerfwise make`, prints.

    Attributes
    ----------
    nests
        A nest a sheet, as they can be given to `solve`.
    profile
        The profile that distances and prices are of.
    programs
        What `make` has planned, a line a sheet; empty for `nest`.
    notes
        What the readers had to say, and which sheets were repaired.
    interrupted
        Whether Ctrl-C, or the progress callback, ended the look: the nests are the best so far.
    """

    nests: tuple[Nest, ...]
    profile: Profile
    programs: tuple[str, ...]
    notes: tuple[str, ...]
    interrupted: bool
    _nested: Nested
    _found: NestingResult
    _made: Programs | None
    _seed: int

    @property
    def missing(self) -> dict[str, int]:
        """Parts that are on no sheet, by name: how many."""
        layout = self._nested.layout
        return {kind.name: lost for kind, lost in zip(layout.wanted.types, layout.missing, strict=True) if lost}

    @property
    def use(self) -> float:
        """Metal of all parts laid, of that of all sheets taken."""
        return use_of_all(self._nested)

    @property
    def prices(self) -> tuple[float | None, ...]:
        """What each layout that was weighed costs to cut, the densest first; None for one that has no plan."""
        return tuple(one.price for one in self._found.weighed)

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
        files = nest_files(self._nested, ".svg", dxf) if self._made is None else self._made.files(dxf)
        return write_nests(out, self._nested, files, profile=self.profile.name, seed=self._seed)

    def __str__(self) -> str:
        lines = [as_text(self._nested)]
        if self._found.taken is not None:
            lines.append(weighed_text(self._found.weighed, self._found.taken, self.profile))
        return "\n".join([*lines, *self.programs])

    __repr__ = __str__


def nests_of_job(plant: Profile, found: NestingResult, made: Programs | None, seed: int, notes: list[str]) -> Nests:
    """What the job has found, and made of it."""
    nested = found.nested if made is None else made.nested
    interrupted = found.interrupted or (made is not None and made.interrupted)
    programs = () if made is None else made.told
    return Nests(nested.nests, plant, programs, tuple(notes), interrupted, nested, found, made, seed)
