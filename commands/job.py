"""kerfwise job: check a job file, or print the schema of job files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from kerfwise.encoder.files import is_file
from kerfwise.encoder.readers.read import SUFFIXES

from .shared_options import TRUST, print_note
from .terminal import expect_printed

if TYPE_CHECKING:
    from kerfwise.jobs.nest_job import Job


@click.group()
def command() -> None:
    """Check a job file, NEST.job.yaml, or print the schema of job files."""


@command.command()
@click.argument("job", metavar="JOB")
@click.argument("nest", metavar="[NEST]", required=False)
@TRUST
def check(job: str, nest: str | Path | None, trust: bool) -> None:
    """Validate JOB against its profile and nest; report every error with its place.

    Its profile is looked up, and its contours in NEST, or in the nest beside it.
    """
    from kerfwise.jobs.inputs import drawn_nest
    from kerfwise.jobs.nest_job import read_job
    from kerfwise.jobs.nest_job.request import NestRequest, locked_for, profile_for

    read = read_job(job)
    plant = profile_for(NestRequest(job=read, trust=trust), read, print_note)
    for text in (*plant.chart_notes(), *plant.time_and_price_notes()):
        print_note(text)
    nest = nest or _beside(job)
    if nest is not None:
        locked_for(plant.as_cut(drawn_nest(nest, plant)), nest, plant, NestRequest(), read, print_note)
    elif read.locks:
        print_note("there is no nest beside the job file: whether the contours of its locks are there is not known")
    click.echo(f"{read.name}: fine, {', '.join(_told(read, plant.name))}")


@command.command()
def schema() -> None:
    """Print the JSON Schema of job files, for editors."""
    from kerfwise.jobs.nest_job.job import schema_text

    click.echo(schema_text(), nl=False)
    expect_printed()


def _beside(job: str) -> Path | None:
    """The nest that a job file is beside; None where there is none. An SVG there may be a picture of a plan."""
    from kerfwise.jobs.nest_job.job import ENDING

    path = Path(job)
    named = [path.with_name(path.name.removesuffix(ENDING) + suffix) for suffix in SUFFIXES if suffix != ".svg"]
    return next((file for file in named if is_file(file)), None)


def _told(job: Job, profile: str) -> list[str]:
    from kerfwise.postproc.report.legend import counted

    phrases = [f"profile {profile}", counted(job.quantity, "sheet")]
    phrases += [f"order {job.order}"] if job.order else []
    phrases += [f"due {job.due}"] if job.due else []
    phrases += [counted(len(job.locks), "lock")] if job.locks else []
    return phrases + ([counted(len(job.settings), "value") + " of its own"] if job.settings else [])
