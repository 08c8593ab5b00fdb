"""What a person gives on the command line: the options that verbs share, and how they become a nest and a profile."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.rules.profile.machine_section import ORIGINS, Origin
from kerfwise.rules.profile.profile import DEFAULT, Profile, load_profile

if TYPE_CHECKING:
    from kerfwise.encoder.readers.options import Frame
    from kerfwise.models.plan.plan import Plan
    from kerfwise.postproc.check.reader.program import NcProgram

Verb = Callable[..., Any]


@dataclass(frozen=True, slots=True)
class Given:
    """A nest and the profile it is to be cut by."""

    nest: Nest
    profile: Profile


def given_options(verb: Verb) -> Verb:
    """Add NEST and the options that decide how it is read."""
    for add in (
        click.option(
            "--origin", type=click.Choice(list(ORIGINS)), help="The machine's zero, instead of machine.origin."
        ),
        click.option("--repair", is_flag=True, help="Mend what can be mended in the drawing, and say what was done."),
        click.option("--sheet", metavar="WxH", help="Sheet size in mm, where the drawing has no outline for it."),
        click.option(
            "--frame",
            type=click.Choice(["sheet", "part"]),
            help="What one rectangle around everything is, where no layer is the sheet's.",
        ),
        click.option("--units", metavar="UNIT", help="Unit of the drawing: mm, cm, m, in or ft."),
        click.option(
            "-p", "--profile", metavar="PROFILE", default=DEFAULT, show_default=True, help="Its name or path."
        ),
        click.argument("nest", metavar="NEST"),
    ):
        verb = add(verb)
    return verb


def read_given(
    nest: str,
    profile: str,
    units: str | None,
    sheet: str | None,
    frame: Frame | None,
    repair: bool,
    origin: Origin | None = None,
) -> Given:
    """Read both, the nest as the profile has it cut; what the reader has to say goes to standard error, a line each."""
    from kerfwise.encoder.readers import read_nest

    plant = load_profile(profile)
    plant = plant.at_origin(origin) if origin else plant
    options = plant.read_options()
    options = replace(
        options,
        units=units or options.units,
        sheet_size_mm=_size(sheet) if sheet else options.sheet_size_mm,
        frame=frame or options.frame,
        repair=repair,
    )
    read = read_nest(nest, options)
    for note in read.notes:
        click.echo(f"{note.severity}: {note.text}", err=True)
    return Given(plant.as_cut(read), plant)


def note_placing(given: Given) -> None:
    """Say on standard error what a planner would want to know of where the sheet lies on the machine."""
    from kerfwise.rules.profile.placing import placing_notes

    for text in placing_notes(given.nest, given.profile):
        click.echo(f"warning: {text}", err=True)


def note_if_others(plan: Plan, given: Given) -> None:
    """Say on standard error where a plan was made from another nest, or with another profile."""
    for what, stands, now in (("nest", plan.nest, given.nest.sha256), ("profile", plan.profile, given.profile.sha256)):
        if stands.get("sha256") != now:
            click.echo(f"note: the {what} is not the one the plan was made with (its sha256 differs)", err=True)
    if plan.origin != given.profile.machine.origin:
        asked = f"here it is {given.profile.machine.origin}"
        click.echo(f"note: the plan's origin is {plan.origin}, {asked}: the plan's counts", err=True)


def read_program_of(path: str, given: Given) -> NcProgram:
    """An NC program of the nest; cuts that are along none of its contours are told on standard error.

    Raises
    ------
    InputError
        If it cannot be read or understood, or is one of another nest.
    """
    from kerfwise.postproc.clock.timed import read_program
    from kerfwise.postproc.verdict.of_nest import cuts_elsewhere

    program = read_program(program_text(path), given.nest, given.profile, path)
    if elsewhere := cuts_elsewhere(program, given.nest, given.profile.material.kerf_mm, path):
        text = f"{elsewhere} of {len(program.burns)} cuts of the program run along no contour of the nest"
        click.echo(f"note: {text}", err=True)
    return program


def program_text(path: str) -> str:
    """The text of an NC program, its line ends as they are in the file.

    Raises
    ------
    InputError
        If there is none to read; with the place, if it is not UTF-8.
    """
    try:
        data = Path(path).read_bytes()
    except OSError as error:
        raise InputError(f"cannot read the program: {error.strerror}", file=path) from None
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        before = data[: error.start]
        raise InputError(
            f"not an NC program: byte 0x{data[error.start]:02X} is not UTF-8; save the program as UTF-8 or ASCII",
            file=path,
            line=before.count(b"\n") + 1,
            column=len(before[before.rfind(b"\n") + 1 :].decode("utf-8")) + 1,
        ) from None


def _size(text: str) -> tuple[float, float]:
    width, _, height = text.lower().partition("x")
    try:
        size = float(width), float(height)
    except ValueError:
        size = (0.0, 0.0)
    if not (0 < size[0] < 1e6 and 0 < size[1] < 1e6):
        raise InputError(f"--sheet {text!r} is not a size: write width x height in mm, such as 3000x1500")
    return size
