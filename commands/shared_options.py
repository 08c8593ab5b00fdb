"""Options that verbs share, and how they become a nest, a profile, or an old program that is read."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from kerfwise.encoder.errors import InputError, RuleFault, RulesConflict, ToolFault
from kerfwise.encoder.escape import escape_text
from kerfwise.encoder.questions import Question, Questions
from kerfwise.encoder.readers.read import SUFFIXES
from kerfwise.jobs.inputs import (
    DrawingSaid,
    Inputs,
    common_cuts_not_made,
    dates_ignored,
    drawn_nest,
    fewer_than_wanted,
    plant_of,
    reading,
    tabs_not_left,
)
from kerfwise.jobs.nest_job.job import ENDING, job_beside
from kerfwise.languages import ENGLISH, LANGUAGES
from kerfwise.models.engines import ENGINES, OLD_NAMES, Engine
from kerfwise.rules.profile.load import DEFAULT, files_of
from kerfwise.rules.profile.plant_sections import ORIGINS, Origin

if TYPE_CHECKING:
    from kerfwise.encoder.readers.options import ReadOptions
    from kerfwise.jobs.nest_job.request import NestRequest
    from kerfwise.jobs.programs import OldJob, ProgramRequest
    from kerfwise.postproc.check.reader.read_program import Trusted
    from kerfwise.rules.options.quantities import Quantity


Verb = Callable[..., Any]

TRUST = click.option(
    "--trust",
    is_flag=True,
    help="Run the Python rules that the profile names. They are programs.",
)


def print_note(text: str) -> None:
    """Say something on standard error that the user should read."""
    click.echo(f"note: {text}", err=True)


def input_options(verb: Verb) -> Verb:
    """Add NEST, one profile, and the options that decide how it is read; see `nest_options`."""
    return nest_options(verb, _PROFILE)


_PROFILE = click.option(
    "-p",
    "--profile",
    metavar="PROFILE",
    help=f"Name or path of the profile. Default: that of the job file, or {DEFAULT}.",
)


def nest_options(verb: Verb, profile: Callable[[Verb], Verb]) -> Verb:
    """Add NEST, the option of profiles, and those that decide how the nest is read.

    Messages that name no file name the nest.
    """
    verb = _naming_the_nest(verb)
    for add in (
        click.option("--origin", type=click.Choice(list(ORIGINS)), help="Override machine.origin, the machine's zero."),
        click.option("--repair", is_flag=True, help="Repair the drawing where possible, and report each repair."),
        click.option("--sheet", metavar="WxH", help="Sheet size in mm, instead of the file's sheet."),
        click.option(
            "--frame",
            type=click.Choice(["sheet", "part"]),
            help="Use of a single rectangle around everything, if no layer names the sheet.",
        ),
        click.option(
            "--refit-arcs", metavar="LENGTH", help="Refit arcs to flattened outlines within this tolerance, as 0.05 mm."
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
            return _answering(verb, *args, **options)
        except Questions as error:
            raise error.in_file(options["nest"]) from error
        except InputError as error:
            if error.file == escape_text(Path(options["nest"]).name) != options["nest"]:  # as the user wrote it
                place = {"line": error.line, "column": error.column}
                raise InputError(error.message, file=options["nest"], details=error.details, **place) from error
            # What an option says stands in no file, and what is wrong with what is installed in none of the nest's.
            if error.file is not None or error.message.startswith("-") or isinstance(error, RuleFault | ToolFault):
                raise
            raise InputError(error.message, file=options["nest"], details=error.details) from error
        except RulesConflict as error:
            raise RulesConflict(f"{options['nest']}: {error.message}", error.reasons) from error

    return named


def read_inputs(nest: str, origin: Origin | None = None, trust: bool = False, **options: Any) -> Inputs:
    """Read both, the nest as the profile has it cut; what the reader has to say goes to standard error, a line each.

    What its job file, --set and --lock say is laid over the profile: `options` are those that `nest_options` adds, with
    what else `nest_request` takes.
    """
    from kerfwise.jobs.inputs import refit_as_made
    from kerfwise.jobs.nest_job.request import job_for, kept_answers, locked_for, locks_told, profile_for

    said = drawing_said({name: options.pop(name) for name in OF_READING})
    request = replace(nest_request(**options), trust=trust)
    job = job_for(nest, request.job, print_note)
    plant = profile_for(request, job, print_note)
    if lock_note := locks_told(plant):
        print_note(lock_note)
    refit_mm = refit_as_made(said.refit_arcs_mm, request.last, plant, print_note)
    read = drawn_nest(nest, plant, replace(said, refit_arcs_mm=refit_mm))
    if (kept := kept_answers(nest, job, request, read, print_note)) is not job:
        job = kept
        plant = profile_for(request, job)
    plant = plant.at_origin(origin) if origin else plant
    for note in plant.without_losses(read).notes:
        click.echo(f"{note.severity}: {note.text}", err=True)
    if cut_all_the_same := tabs_not_left(read, plant):
        click.echo(f"warning: {cut_all_the_same}", err=True)
    return locked_for(plant.as_cut(read), nest, plant, request, job, print_note)


OF_READING = ("units", "sheet", "frame", "repair", "refit_arcs")


def reading_of(inputs: Inputs, options: Mapping[str, Any]) -> ReadOptions:
    """How the nest was read, with what the command line says of that."""
    return reading(inputs.profile, replace(drawing_said(options), refit_arcs_mm=inputs.nest.refit_arcs_mm))


def protect(inputs: Inputs, nest: str, outputs: Iterable[str | Path | None], *others: str | Path | None) -> None:
    """Say before the work that a file would be written over which is read: the nest, the profile's, or others.

    The name of a job file is kept for one, be it there or not. Raises InputError naming the file.
    """
    from kerfwise.postproc.output_files import expect_outputs

    written = [Path(output) for output in outputs if output]
    read = (Path(nest), *files_of(inputs.profile), *(Path(other) for other in (*others, job_beside(nest)) if other))
    expect_outputs(written, read)
    for path in written:
        if path.name.lower().endswith((ENDING, ".job.yml")):
            raise InputError("this is the name of a job file, which is read with its nest: give another", file=path)


def note_placing(inputs: Inputs) -> None:
    """Say on standard error what a planner would want to know: where the sheet lies, which cuts are not made."""
    from kerfwise.rules.profile.values import placing_notes

    for text in placing_notes(inputs.nest, inputs.profile):
        click.echo(f"warning: {text}", err=True)
    for text in (*inputs.profile.chart_notes(), *inputs.profile.time_and_price_notes()):
        print_note(text)
    if inputs.profile.cuts.links.longest_mm > 0 and (why := inputs.profile.no_links(inputs.nest)):
        click.echo(f"note: cuts.links: the torch stays on nowhere: {why}", err=True)
    if note := common_cuts_not_made(inputs):
        print_note(note)
    if note := fewer_than_wanted(inputs):
        print_note(note)
    if count := dates_ignored(inputs.nest, inputs.profile):
        parts = "1 part has" if count == 1 else f"{count} parts have"
        print_note(
            f"{parts} a due date or a priority, and objective.completion is 0: the order of cutting does not follow "
            "it; --set objective.completion=1 has it do so"
        )


# What a person says of one nest on the command line, or has said in its job file.

JOB = click.option("--job", metavar="JOB", help="Use this job file instead of NEST.job.yaml beside the nest.")
NO_JOB = click.option("--no-job", is_flag=True, help="Ignore the job file beside the nest.")
SET = click.option("--set", "settings", multiple=True, metavar="KEY=VALUE",
                   help="Set a value of the profile once, as leads.lead_in=4mm; repeatable.")  # fmt: skip
LOCK = click.option("--lock", multiple=True, metavar="LOCK",
                    help="Fix a decision, such as 'P2 first' or '#7 before P3'; repeatable.")  # fmt: skip


ANSWER = click.option("--answer", "answers", multiple=True, metavar="QUESTION=CHOICE",
                      help="Answer a question of the drawing, as frame=sheet; kept in the job file.")  # fmt: skip


def nest_request(
    profile: str | None,
    job: str | None = None,
    no_job: bool = False,
    settings: Sequence[str] = (),
    lock: Sequence[str] = (),
    answers: Sequence[str] = (),
    last: str | None = None,
    date: str = "",
) -> NestRequest:
    """What these options ask for; `last` is the plan in which contours have the numbers that locks call them by.

    Raises InputError naming the option, the word that is wrong, and what was expected.
    """
    from kerfwise.encoder.questions import answers_of
    from kerfwise.jobs.nest_job.request import NestRequest as Asked
    from kerfwise.rules.profile.overrides import read_lock, read_setting

    if job is not None and no_job:
        raise click.UsageError("--job names a job file, and --no-job goes without one: give one of them")
    try:
        locks = tuple(replace(read_lock(one), reason=f"locked by the operator (--lock {one!r})") for one in lock)
    except InputError as error:
        raise InputError(f"--{error.message}") from None
    laid = tuple(map(read_setting, settings))
    return Asked(profile, False if no_job else job, laid, locks, answers_of(answers), last, date)


def _day(_: click.Context, __: click.Parameter, value: str) -> str:
    """A day of the calendar, as it is written: year first."""
    from kerfwise.jobs.nest_job.job import day_of

    try:
        return day_of(value)
    except InputError as error:
        raise click.BadParameter(error.message.removeprefix("date: ")) from None


DATE = click.option("--date", callback=_day, default="", metavar="DAY",
                    help="Day that the program says at its top, as 2026-12-24. Default: the job file's.")  # fmt: skip


# Lengths and sizes on the command line, and what they say of how a nest is read.


def drawing_said(options: Mapping[str, Any]) -> DrawingSaid:
    """What the options `OF_READING` say of the drawing."""
    units, sheet, frame, repair, refit_arcs = (options[name] for name in OF_READING)
    size_mm = size_of(sheet) if sheet else None
    return DrawingSaid(units, size_mm, frame, repair, length_of("--refit-arcs", refit_arcs) if refit_arcs else None)


def length_of(option: str, text: str) -> float:
    """A length over 0 in mm, as in 0.05 mm; InputError with the option's name for anything else."""
    from kerfwise.rules.options.quantities import LENGTH, positive

    return _read(option, text, positive(LENGTH))


def length_or_zero(option: str, text: str) -> float:
    """The same, where 0 is a length too."""
    from kerfwise.rules.options.quantities import LENGTH

    return _read(option, text, LENGTH)


def _read(option: str, text: str, kind: Quantity) -> float:
    from kerfwise.rules.options.kind import Unfit
    from kerfwise.rules.options.yaml_positions import compose

    try:
        node = compose(text, option)
        if node is None:
            raise Unfit(f"expected {kind.expected()}")
        return float(kind.read(node))
    except Unfit as error:
        raise InputError(f"{option} {text!r}: {error}") from None
    except InputError:
        raise InputError(f"{option} {text!r}: expected {kind.expected()}") from None


def size_of(text: str) -> tuple[float, float]:
    """Width and height of a sheet, mm, as in 3000x1500; InputError for anything else."""
    width, _, height = text.lower().partition("x")
    try:
        size = float(width), float(height)
    except ValueError:
        size = (0.0, 0.0)
    if not (0 < size[0] < 1e6 and 0 < size[1] < 1e6):
        raise InputError(f"--sheet {text!r} is not a size: write width x height in mm, such as 3000x1500")
    return size


# Numbers on the command line: `nan` and `inf`, which Python reads as numbers, are none.


class Amount(click.FloatRange):
    """A finite number in a range."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """The number, or a usage error."""
        number = float(super().convert(value, param, ctx))
        if not math.isfinite(number):
            self.fail(f"{value} is not an amount: expected a number such as 1.5", param, ctx)
        return number


AMOUNT = Amount(min=0)
AMOUNT_OVER_ZERO = Amount(min=0, min_open=True)

MEMORY = click.option(
    "--memory",
    "memory_gb",
    type=AMOUNT_OVER_ZERO,
    default=2.0,
    show_default=True,
    metavar="GB",
    help="Memory limit of the process in GB, for libraries, moves over parts that are out, and the engines' tables. "
    "CP-SAT and linear programs are not counted.",
)


# Engines on the command line: by their names, and by the names that they had before.


class EngineChoice(click.Choice[Any]):
    """One of `engines`; an old name is read as the new one, and not listed."""

    def __init__(self, engines: Iterable[Engine] = ENGINES) -> None:
        super().__init__(list(engines))

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The engine's name of today, or a usage error."""
        return super().convert(OLD_NAMES.get(value, value), param, ctx)


# What a person says of an old program on the command line, where the program does not say it.

ProgramVerb = Callable[..., Any]

FEED = click.option("--feed", type=AMOUNT_OVER_ZERO, metavar="F",
                    help="Feed in mm/min of an old program that leaves it to the machine's material.")  # fmt: skip
KERF = click.option("--kerf", type=AMOUNT, metavar="K", help="Kerf of an old program in mm, instead of the profile's.")


def old_options(verb: ProgramVerb) -> ProgramVerb:
    """Add the options that say what an old program does not."""
    sheet = click.option(
        "--sheet", metavar="WxH", help="Sheet size in mm. Default: the bounding box of the burns with a margin."
    )
    for add in (sheet, KERF, FEED):
        verb = add(verb)
    return verb


def program_alone(nest: str, made: str | None) -> bool:
    """Whether a program is given without its nest: one file, and that is no nest.

    Raises click.UsageError if a nest is given alone.
    """
    if made is not None:
        return False
    if Path(nest).suffix.lower() in SUFFIXES:
        raise click.UsageError("Missing argument 'PLAN.json|OUT.nc'.")
    return True


def read_program_alone(feed: float | None, kerf: float | None, options: Mapping[str, Any]) -> OldJob:
    """An old program in the place of the nest; options that are about a drawing are refused.

    Raises InputError with file and line, for what cannot be read or be sure of.
    """
    from kerfwise.jobs.programs import read_old_job

    request, program = program_request(feed, kerf, options["sheet"]), options["nest"]
    if named := [name for name in ("units", "frame", "repair", "origin", "refit_arcs") if options[name]]:
        option = named[0].replace("_", "-")
        raise InputError(f"--{option} is for drawings; {program} is read as a program", file=program)
    of_nest = {"job": "job", "no_job": "no-job", "settings": "set", "lock": "lock"}
    if named := [option for name, option in of_nest.items() if options[name]]:
        raise InputError(f"--{named[0]} is for a nest; {program} is a program alone", file=program)
    return read_old_job(program, plant_of(options["profile"] or DEFAULT, options["trust"]), request, tell=print_note)


def trusted_if(feed: float | None) -> Trusted | None:
    """What a program leaves to the machine's material is taken once a feed is given for it."""
    from kerfwise.postproc.check.reader.read_program import Trusted

    return None if feed is None else Trusted(feed)


def program_request(feed: float | None, kerf: float | None, sheet: str | None) -> ProgramRequest:
    """What they say."""
    from kerfwise.jobs.programs import ProgramRequest as Asked

    return Asked(feed, kerf, size_of(sheet) if sheet else None)


# Questions that a drawing raises, asked on a terminal; anywhere else they end the command with exit code 3.


def _answering(verb: Verb, *args: Any, **options: Any) -> Any:
    """What a verb gives; on a terminal it runs once more with the answers to the questions that it raises.

    Raises Questions where nobody sits before a terminal.
    """
    while True:
        try:
            return verb(*args, **options)
        except Questions as questions:
            if not (sys.stdin is not None and sys.stdin.isatty() and sys.stderr.isatty()):
                raise
            answers = [f"{question.id}={_asked(question)}" for question in questions.questions]
            options["answers"] = (*options["answers"], *answers)


def _asked(question: Question) -> str:
    """The value of the choice that somebody types, or the number of.

    Raises click.Abort where somebody ends it there, with Ctrl-C or the end of input: nothing was written then.
    """
    values = [choice.value for choice in question.choices]
    wide = max(map(len, values), default=0)
    lines = [escape_text(question.text)]
    for k, choice in enumerate(question.choices, 1):
        gives = f": {escape_text(choice.gives)}" if choice.gives else ""
        lines.append(f"  {k}  {escape_text(choice.value):{wide}}  {escape_text(choice.words)}{gives}")
    click.echo("\n".join(lines), err=True)

    def chosen(answer: str) -> str:
        if answer.strip() in values:
            return answer.strip()
        if answer.strip().isdecimal() and 0 < int(answer) <= len(values):
            return values[int(answer) - 1]
        raise click.UsageError(
            f"{answer.strip()!r} is none of the choices: type 1 to {len(values)}, or the word behind it"
        )

    try:
        value: str = click.prompt(f"Which (1-{len(values)})", value_proc=chosen, err=True)
    except click.Abort:
        click.echo(f"\nnot answered, nothing is written: {question.flag(question.choices[0])} answers it", err=True)
        raise
    return value


LANGUAGE = click.option(
    "--language",
    type=click.Choice(LANGUAGES),
    default=ENGLISH,
    show_default=True,
    help="Language of work sheets and labels.",
)
"""What is printed for the shop; the terminal stays English."""
