"""What a person says of an old program on the command line, where the program does not say it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.readers.read import SUFFIXES

from .given import tell_note
from .lengths import size_of
from .numbers import AMOUNT, AMOUNT_OVER_ZERO

if TYPE_CHECKING:
    from kerfwise.jobs.old_program import Asked, OldJob
    from kerfwise.postproc.check.reader.old import Trusted

Verb = Callable[..., Any]

FEED = click.option("--feed", type=AMOUNT_OVER_ZERO, metavar="F",
                    help="Feed in mm/min where an old program leaves it to the machine's material.")  # fmt: skip
KERF = click.option("--kerf", type=AMOUNT, metavar="K", help="Kerf of an old program in mm, instead of the profile's.")


def old_options(verb: Verb) -> Verb:
    """Add the options that say what an old program does not."""
    sheet = click.option("--sheet", metavar="WxH", help="Sheet size in mm; else one is laid around what is cut.")
    for add in (sheet, KERF, FEED):
        verb = add(verb)
    return verb


def program_alone(nest: str, made: str | None) -> bool:
    """Whether a program is given without its nest: one file, and that is no nest.

    Raises
    ------
    click.UsageError
        If a nest is given alone.
    """
    if made is not None:
        return False
    if Path(nest).suffix.lower() in SUFFIXES:
        raise click.UsageError("Missing argument 'PLAN.json|OUT.nc'.")
    return True


def read_alone(feed: float | None, kerf: float | None, given: Mapping[str, Any]) -> OldJob:
    """An old program in the place of the nest; options that are about a drawing are refused.

    Raises
    ------
    InputError
        With file and line, for what cannot be read or be sure of.
    """
    from kerfwise.jobs.given import plant_of
    from kerfwise.jobs.old_program import read_old_job
    from kerfwise.rules.profile.load import DEFAULT

    asked, program = asked_of(feed, kerf, given["sheet"]), given["nest"]
    if named := [name for name in ("units", "frame", "repair", "origin", "refit_arcs") if given[name]]:
        option = named[0].replace("_", "-")
        raise InputError(f"--{option} is for drawings; {program} is read as a program", file=program)
    of_nest = {"job": "job", "no_job": "no-job", "settings": "set", "lock": "lock"}
    if named := [option for name, option in of_nest.items() if given[name]]:
        raise InputError(f"--{named[0]} is for a nest; {program} is a program alone", file=program)
    return read_old_job(program, plant_of(given["profile"] or DEFAULT, given["trust"]), asked, tell=tell_note)


def trusted_if(feed: float | None) -> Trusted | None:
    """What a program leaves to the machine's material is taken once a feed is given for it."""
    from kerfwise.postproc.check.reader.old import Trusted

    return None if feed is None else Trusted(feed)


def asked_of(feed: float | None, kerf: float | None, sheet: str | None) -> Asked:
    """What they say."""
    from kerfwise.jobs.old_program import Asked

    return Asked(feed, kerf, size_of(sheet) if sheet else None)
