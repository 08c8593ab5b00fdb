"""An old program without its nest: read, and its nest told from its burns where that can be done."""

from __future__ import annotations

import re
from collections.abc import Set
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest
from kerfwise.postproc.check.reader.old import OldProgram, Trusted
from kerfwise.postproc.check.reader.on_machine import moved, old_on_machine, stated_origin
from kerfwise.postproc.check.reader.program import NcProgram
from kerfwise.postproc.old.contours import Told, fits_kerf, nest_of
from kerfwise.postproc.old.told_names import named_as_told
from kerfwise.postproc.old.unclear import NoNest, Unclear
from kerfwise.rules.profile.profile import Profile

from .given import Given, Tell, program_text, silent
from .old_settings import at_its_feeds, kerf_of, tab_mm
from .one_torch import expect_one_torch

_OF_SHEET = re.compile(r"\(\s*(?:ORIGIN|START SIDE)\b", re.IGNORECASE)

_COMMENT = re.compile(r"^\s*\((?!\s*o\s*=)[^()]*\)\s*$")


@dataclass(frozen=True, slots=True)
class Asked:
    """What the user says of old programs: mm, mm/min; None for what the program, or else the profile, says."""

    feed_mm_min: float | None = None
    kerf_mm: float | None = None
    sheet_mm: tuple[float, float] | None = None


@dataclass(frozen=True, eq=False, slots=True)
class OldJob:
    """An old program, and what is known of it.

    Attributes
    ----------
    name
        Of its file.
    old
        The program, line by line, in its own coordinates.
    program
        The same in the coordinates of the drawing that it states.
    profile
        The plant's, with the feeds, the pierce time, the origin and the kerf of the program.
    told
        The nest told from the burns; None where they make none.
    unclear
        Then the burns at fault.
    partly
        Then the nest told from the others, where they make one.
    trusted
        What is taken as the program says it.
    text
        What is judged: the program, without comments that name another nest's contours.
    notes
        What the user should know.
    """

    name: str
    old: OldProgram
    program: NcProgram
    profile: Profile
    told: Told | None
    unclear: tuple[Unclear, ...]
    partly: Told | None
    trusted: Trusted
    text: str
    notes: tuple[str, ...]

    @property
    def home(self) -> Point:
        """Where the torch starts, in the coordinates of the drawing."""
        (x, y), (left, low) = self.profile.machine.home, self.program.zero or (0.0, 0.0)
        return x + left, y + low

    @property
    def nest(self) -> Nest:
        """The nest told from the burns.

        Raises
        ------
        InputError
            If they make none, with the lines of those at fault.
        """
        if self.told is not None:
            return self.told.nest
        first = self.unclear[0]
        raise InputError(
            f"no nest can be told from the program: {_few(len(self.unclear))} cut or mark the contour of a part",
            file=self.name,
            line=first.line,
            details=tuple(map(str, self.unclear)),
        )

    @property
    def given(self) -> Given:
        """Nest and profile, for jobs that need both."""
        return Given(self.nest, self.profile)


def _few(count: int) -> str:
    return "1 burn does not" if count == 1 else f"{count} burns do not"


def read_old_job(
    path: str | Path, profile: Profile, asked: Asked | None = None, *, afresh: bool = False, tell: Tell = silent
) -> OldJob:
    """Read an old program; `afresh` keeps the profile's feeds and the kerf, since all paths will be new.

    Raises
    ------
    InputError
        With file and line, for what cannot be read or be sure of.
    """
    expect_one_torch(profile, "a program of which there is no nest")
    asked, file = asked or Asked(), str(path)
    text = program_text(path)
    trusted = Trusted(asked.feed_mm_min or profile.machine.cut_feed_mm_s * 60)
    old = old_on_machine(text, profile, trusted, file)
    if not old.program.burns:
        raise InputError("the program cuts nothing: the torch is never on", file=file)
    notes: list[str] = []
    if old.fed_by and asked.feed_mm_min is None:
        notes.append(
            f"the program leaves its feed to the machine's material (line {old.fed_by[0]}): it is taken as the "
            f"profile's {trusted.feed_mm_min:g} mm/min (--feed gives another)"
        )
    origin, zero = stated_origin(old.program)
    program = replace(moved(old.program, zero or (0.0, 0.0)), origin=origin, zero=zero)
    profile = profile.at_origin(origin or "drawing")
    kerf_mm = kerf_of(old, profile, asked.kerf_mm)
    if not afresh:
        profile = at_its_feeds(profile, program)
    at_corner = zero if origin == "sheet-corner" else None
    told: Told | None = None
    unclear: tuple[Unclear, ...] = ()
    open_mm = tab_mm(profile, kerf_mm)

    def told_at(kerf_mm: float, aside: Set[int] = frozenset()) -> Told:
        return nest_of(program.burns, kerf_mm, asked.sheet_mm, at_corner, Path(path).name, open_mm, aside)

    partly: Told | None = None
    try:
        told = told_at(kerf_mm)
        if not afresh and kerf_mm > 0 and not fits_kerf(told, kerf_mm, program.step_mm):
            raise NoNest(())
    except NoNest as none:
        unclear = none.unclear
        if not afresh and kerf_mm > 0:
            try:
                told, unclear = told_at(0.0), ()
            except NoNest as still:
                told, unclear = None, still.unclear
            else:
                kerf_mm = 0.0
                notes.append(
                    "the burns do not run half a kerf beside contours with round corners: rules are judged on the "
                    "torch's path itself, as if the kerf had no width"
                )
    if told is None and not afresh:
        with suppress(NoNest):
            partly = told_at(kerf_mm, {one.line for one in unclear})
    profile = replace(profile, material=replace(profile.material, kerf_mm=kerf_mm))
    judged = text
    if told is not None:
        named = named_as_told(told, program.comments)
        if named is None:
            judged = without_comments(text)
        else:
            told = named
        notes += [note.text for note in told.nest.notes]
    for note in notes:
        tell(note)
    return OldJob(file, old, program, profile, told, tuple(unclear), partly, trusted, judged, tuple(notes))


def without_comments(text: str) -> str:
    """The program without comments that name contours of another nest; those on the sheet stay."""
    return "\n".join(row if is_of_sheet(row) else _COMMENT.sub("", row) for row in text.split("\n"))


def is_of_sheet(row: str) -> bool:
    """Whether a row is a comment that says where the sheet lies, or from which side it is cut."""
    return _OF_SHEET.match(row) is not None
