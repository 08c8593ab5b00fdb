"""What a person gives on the command line: the options that verbs share, and how they become a nest and a profile."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.faults import RuleFault
from kerfwise.encoder.questions import Questions, with_answers
from kerfwise.encoder.shown import shown
from kerfwise.jobs.given import Given, common_cuts_not_made, drawn_nest, plant_of, reading, silent, tabs_not_left
from kerfwise.jobs.nest_job.beside import job_beside
from kerfwise.rules.profile.load import DEFAULT
from kerfwise.rules.profile.machine_section import ORIGINS, Origin
from kerfwise.rules.profile.made_of import files_of

from .answering import answering
from .lengths import said_of_reading
from .one_nest import ANSWER, JOB, LOCK, NO_JOB, SET, asked_of

if TYPE_CHECKING:
    from kerfwise.encoder.readers.options import FrameName, ReadOptions

Verb = Callable[..., Any]

TRUST = click.option(
    "--trust",
    is_flag=True,
    help="Run the Python rules that the profile names. They are programs.",
)


def tell_note(text: str) -> None:
    """Say something on standard error that the user should read."""
    click.echo(f"note: {text}", err=True)


def given_options(verb: Verb) -> Verb:
    """Add NEST, one profile, and the options that decide how it is read; see `nest_options`."""
    return nest_options(verb, _PROFILE)


_PROFILE = click.option(
    "-p", "--profile", metavar="PROFILE", help=f"Name or path of the profile. Else that of the job file, or {DEFAULT}."
)


def nest_options(verb: Verb, profile: Callable[[Verb], Verb]) -> Verb:
    """Add NEST, the option of profiles, and those that decide how the nest is read.

    Messages that name no file name the nest.
    """
    verb = _naming_the_nest(verb)
    for add in (
        click.option(
            "--origin", type=click.Choice(list(ORIGINS)), help="The machine's zero, instead of machine.origin."
        ),
        click.option("--repair", is_flag=True, help="Mend what can be mended in the drawing, and say what was done."),
        click.option("--sheet", metavar="WxH", help="Sheet size in mm, in the place of the sheet that the file has."),
        click.option(
            "--frame",
            type=click.Choice(["sheet", "part"]),
            help="What a single rectangle around everything is, where no layer names the sheet.",
        ),
        click.option(
            "--refit-arcs", metavar="LENGTH", help="Make arcs of flattened outlines, this near to them, as 0.05 mm."
        ),
        click.option("--units", metavar="UNIT", help="Unit of the drawing: mm, cm, m, in, ft, pt, px, or as 90dpi."),
        TRUST,
        ANSWER,
        LOCK,
        SET,
        NO_JOB,
        JOB,
        profile,
        click.argument("nest", metavar="NEST"),
    ):
        verb = add(verb)
    return verb


def _naming_the_nest(verb: Verb) -> Verb:
    @wraps(verb)
    def named(*args: Any, **options: Any) -> Any:
        try:
            return verb(*args, **options)
        except Questions as error:
            raise error.in_file(options["nest"]) from error
        except InputError as error:
            if error.file == shown(Path(options["nest"]).name) != options["nest"]:  # as the user wrote it
                place = {"line": error.line, "column": error.column}
                raise InputError(error.message, file=options["nest"], details=error.details, **place) from error
            # What an option says stands in no file, and what is wrong with an installed package in none of the nest's.
            if error.file is not None or error.message.startswith("-") or isinstance(error, RuleFault):
                raise
            raise InputError(error.message, file=options["nest"], details=error.details) from error
        except RulesConflict as error:
            raise RulesConflict(f"{options['nest']}: {error.message}", error.reasons) from error

    return named


def read_given(
    nest: str,
    profile: str | None,
    units: str | None,
    sheet: str | None,
    frame: FrameName | None,
    repair: bool,
    origin: Origin | None = None,
    trust: bool = False,
    refit_arcs: str | None = None,
    **of_nest: Any,
) -> Given:
    """Read both, the nest as the profile has it cut; what the reader has to say goes to standard error, a line each.

    What its job file, --set and --lock say is laid over the profile: `of_nest` is what `asked_of` takes.
    """
    from kerfwise.jobs.as_it_was_read import refit_as_made
    from kerfwise.jobs.nest_job.answers import kept_answers
    from kerfwise.jobs.nest_job.asked import answered, job_for, locked_for, locks_told, profile_for

    asked = asked_of(profile, **of_nest)
    job = job_for(nest, asked.job, tell_note)
    plant = profile_for(asked, job, tell_note, lambda named: plant_of(named, trust))
    if told := locks_told(plant):
        tell_note(told)
    said = said_of_reading(units, sheet, frame, repair, refit_arcs)
    said["refit_arcs_mm"] = refit_as_made(said["refit_arcs_mm"], asked.last, plant, tell_note)
    read, given = answering(lambda answers: drawn_nest(nest, answered(plant, None, answers), **said))
    if answers := with_answers(asked.answers, given):
        asked = replace(asked, answers=answers)
        job = kept_answers(nest, job, asked, read, tell_note)
        plant = profile_for(asked, job, silent, lambda named: plant_of(named, trust))
    plant = plant.at_origin(origin) if origin else plant
    for note in plant.without_losses(read).notes:
        click.echo(f"{note.severity}: {note.text}", err=True)
    if cut_all_the_same := tabs_not_left(read, plant):
        click.echo(f"warning: {cut_all_the_same}", err=True)
    return locked_for(plant.as_cut(read), nest, plant, asked, job, tell_note)


def reading_of(given: Given, options: Mapping[str, Any]) -> ReadOptions:
    """How the nest was read, with what the command line says of that."""
    names = ("units", "sheet", "frame", "repair", "refit_arcs")
    said = said_of_reading(*(options[name] for name in names))
    return reading(given.profile, **said | {"refit_arcs_mm": given.nest.refit_arcs_mm})


def protect(given: Given, nest: str, outputs: Iterable[str | Path | None], *others: str | Path | None) -> None:
    """Say before the work that a file would be written over which is read: the nest, the profile's, or others.

    Raises
    ------
    InputError
        Naming the file.
    """
    from kerfwise.postproc.files import expect_outputs

    read = (Path(nest), *files_of(given.profile), *(Path(other) for other in (*others, job_beside(nest)) if other))
    expect_outputs((Path(output) for output in outputs if output), read)


def note_placing(given: Given) -> None:
    """Say on standard error what a planner would want to know: where the sheet lies, which cuts are not made."""
    from kerfwise.rules.profile.placing import placing_notes

    for text in placing_notes(given.nest, given.profile):
        click.echo(f"warning: {text}", err=True)
    for text in (*given.profile.chart_notes(), *given.profile.price_notes()):
        tell_note(text)
    if given.profile.cuts.links.longest_mm > 0 and (why := given.profile.no_links(given.nest)):
        click.echo(f"note: cuts.links: the torch stays on nowhere: {why}", err=True)
    if told := common_cuts_not_made(given):
        tell_note(told)
