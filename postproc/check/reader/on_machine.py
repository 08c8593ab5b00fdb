"""A program read as the control of the profile's machine runs it, in the coordinates of the drawing."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace

from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest
from kerfwise.postproc.dialects import fitting_dialect, pierce_dwell_of
from kerfwise.rules.profile.frame import Frame
from kerfwise.rules.profile.machine_section import Origin
from kerfwise.rules.profile.profile import Profile

from .controls import CONTROLS, Control
from .old import OldProgram, Trusted, read_old
from .program import NcProgram
from .reader import read_nc

_NUMBER = r"-?\d+(?:\.\d+)?"
_ORIGIN = re.compile(
    rf"ORIGIN (?P<origin>DRAWING|SHEET CORNER)(?:, AT X(?P<x>{_NUMBER}) Y(?P<y>{_NUMBER}) OF THE DRAWING)?",
    re.IGNORECASE,
)
_ORIGINS: Mapping[str, Origin] = {"DRAWING": "drawing", "SHEET CORNER": "sheet-corner"}


def read_on_machine(
    text: str, nest: Nest, profile: Profile, file: str = "", trusted: Trusted | None = None
) -> NcProgram:
    """Read a program as the machine runs it; where the control holds the pierce delay itself, its clock has it too.

    Where the machine's zero lies on the drawing the program's own comment says, else the profile. Words that leave the
    feed, and what else a material has, to the machine are refused, unless they are `trusted`.

    Raises
    ------
    InputError
        With the line, for what is malformed or not understood; for a dialect that does not fit the profile's process.
    """
    machine = profile.machine
    if trusted is None:
        control, held_s = control_of(profile)
        unlit_mm, torches = _unlit_mm(profile), machine.torches.count
        program = read_nc(text, machine.travel_mm_s, file, machine.home, control, held_s, unlit_mm, torches)
    else:
        program = old_on_machine(text, profile, trusted, file).program
    origin, zero = stated_origin(program)
    if zero is None:
        zero = profile.at_origin(origin or machine.origin).frame_on(nest).corner
    return replace(moved(program, zero), origin=origin, zero=zero if origin else None)


def old_on_machine(text: str, profile: Profile, trusted: Trusted, file: str = "") -> OldProgram:
    """Read a program of which there is no nest, line by line, in its own coordinates.

    Raises
    ------
    InputError
        As `read_old` does; for a dialect that does not fit the profile's process.
    """
    machine, (control, held_s) = profile.machine, control_of(profile)
    unlit_mm, torches = _unlit_mm(profile), machine.torches.count
    return read_old(
        text, control, trusted.feed_mm_min, machine.travel_mm_s, file, machine.home, held_s, unlit_mm, torches
    )


def _unlit_mm(profile: Profile) -> float:
    """How far the torch may move on unlit within a burn: over tabs, where the profile has any but at the end."""
    tabs = profile.tabs()
    return 0.0 if tabs is None or tabs.at_end else tabs.longest_mm


def control_of(profile: Profile) -> tuple[Control, tuple[float, float]]:
    """The control that runs the profile's programs, and how long it holds the torch by itself to cut, and to mark.

    That of a laser tells marks from cuts by the profile's power, where it says one.

    Raises
    ------
    InputError
        For a dialect that does not fit the profile's process.
    """
    machine, material, dialect = profile.machine, profile.material, fitting_dialect(profile)
    by_machine = pierce_dwell_of(profile, dialect) == "machine"
    held_s = (machine.pierce_time_s, machine.mark_time_s) if by_machine else (0.0, 0.0)
    control = CONTROLS[dialect.control]
    if not control.beam or material.power is None:
        return control, held_s
    cuts = material.power
    marks = 0.0 if material.mark_power is None else material.mark_power
    marks_up_to = min(control.marks_up_to, (cuts + marks) / 200 * control.full_power)
    return replace(control, marks_up_to=marks_up_to), held_s


def on_its_origin(program: NcProgram, profile: Profile) -> Profile:
    """The profile with the origin that the program says it has."""
    return profile if program.origin is None else profile.at_origin(program.origin)


def other_origin(program: NcProgram, profile: Profile) -> Iterator[str]:
    """A warning where a program says another origin than the profile."""
    if program.origin is not None and program.origin != profile.machine.origin:
        asked = profile.machine.origin
        yield f"the program's origin is {program.origin}, the profile says {asked}: the program's counts"


def stated_origin(program: NcProgram) -> tuple[Origin | None, Point | None]:
    """The origin that a program states, and the point of the drawing that is its zero."""
    found = next(filter(None, map(_ORIGIN.fullmatch, program.comments)), None)
    if found is None:
        return None, None
    origin = _ORIGINS[found["origin"].upper()]
    if found["x"] is None:
        return origin, (0.0, 0.0) if origin == "drawing" else None
    return origin, (float(found["x"]), float(found["y"]))


def moved(program: NcProgram, zero: Point) -> NcProgram:
    """The program in the coordinates of a drawing, a point of which is its zero."""
    frame = Frame(zero)
    if frame.corner == (0.0, 0.0):
        return program
    return replace(
        program,
        burns=tuple(replace(burn, path=burn.path.moved(*frame.corner)) for burn in program.burns),
        rapids=tuple((line, frame.on_drawing(at)) for line, at in program.rapids),
        end=frame.on_drawing(program.end),
    )
