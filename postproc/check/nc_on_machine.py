"""A program read as the control of the profile's machine runs it."""

from __future__ import annotations

from ...rules.profile import Profile
from ..dialects import fitting_dialect, pierce_dwell_of
from .nc_controls import CONTROLS
from .nc_program import NcProgram
from .nc_reader import read_nc


def read_on_machine(text: str, profile: Profile, file: str = "") -> NcProgram:
    """Read a program as the machine runs it; where the control holds the pierce delay itself, its clock has it too.

    Raises
    ------
    InputError
        With the line, for what is malformed or not understood; for a dialect that does not fit the profile's process.
    """
    machine = profile.machine
    dialect = fitting_dialect(profile)
    held_s = (0.0, 0.0)
    if pierce_dwell_of(profile, dialect) == "machine":
        held_s = (machine.pierce_time_s, machine.mark_time_s)
    return read_nc(text, machine.travel_mm_s, file, machine.home, CONTROLS[dialect.control], held_s)
