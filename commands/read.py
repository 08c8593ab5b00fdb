"""What is read of a nest: what a drawing is taken for, and its facts."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.questions import Questions
from kerfwise.encoder.text import escape_text
from kerfwise.jobs.inputs import plant_of, reading

from .shared_options import (
    OF_READING,
    input_options,
    nest_request,
    print_note,
    protect,
    read_inputs,
    reading_options,
)
from .terminal import expect_printed

if TYPE_CHECKING:
    from kerfwise.encoder.readers.read import Seen
    from kerfwise.jobs.nest_job.job import Job
    from kerfwise.jobs.nest_job.request import NestRequest


def seen_nest(given: Mapping[str, Any]) -> tuple[Seen, NestRequest, Job | None]:
    """How a nest is understood, whether it can be cut or not, what the command line asks of it, and its job file."""
    from kerfwise.encoder.readers.read import seen
    from kerfwise.jobs.nest_job.request import job_for, profile_for

    of_nest = {k: v for k, v in given.items() if k not in (*OF_READING, "nest", "profile", "trust", "origin")}
    request = nest_request(given["profile"], **of_nest)
    job = job_for(given["nest"], request.job, print_note)
    plant = profile_for(request, job, print_note, lambda named: plant_of(named, given["trust"]))
    options = reading_options(*(given[name] for name in OF_READING))
    return seen(given["nest"], reading(plant, **options)), request, job


def draw_seen(found: Seen, nest: str, output: str) -> None:
    """A picture of how a nest is understood: what is cut, marked, left out and unclear in colours of their own."""
    from kerfwise.postproc.output_files import write_files
    from kerfwise.postproc.report.simple_pictures import reading_picture

    title = escape_text(f"{Path(nest).name}: as it was understood")
    write_files({Path(output): reading_picture(found.lines, found.nest, title, Path(output).suffix)})


@click.command()
@input_options
@click.option("-o", "--output", metavar="READING.png|.svg|.pdf", help="A picture: cut, marked, left out, unknown.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON, with the questions.")
def read_command(output: str | None, as_json: bool, **given: Any) -> int:
    """Print how NEST is read: units, sheet, each layer, what is left out and repaired, and open questions.

    Exit code 3 if questions are open, 2 if it cannot be cut as drawn; the picture is drawn in any case.
    """
    from kerfwise.jobs.nest_job.request import kept_answers
    from kerfwise.postproc.output_files import expect_outputs
    from kerfwise.postproc.report import expect_picture

    nest = given["nest"]
    if output:
        expect_picture(Path(output).suffix, output)
        expect_outputs([Path(output)], [Path(nest)])
    found, request, job = seen_nest(given)
    if found.nest is not None and not isinstance(found.error, InputError):
        kept_answers(nest, job, request, found.nest, print_note)
    if output:
        draw_seen(found, nest, output)
    if as_json:
        click.echo(json.dumps(_data(nest, found), indent=1, ensure_ascii=False))
    elif found.reading is not None:
        click.echo("\n".join(escape_text(line) for line in found.reading.lines()))
    if output and not as_json:
        click.echo(f"written: {escape_text(output)}")
    if found.error is not None and not (as_json and isinstance(found.error, Questions)):
        raise found.error
    return 3 if isinstance(found.error, Questions) else 0


def _data(nest: str, found: Seen) -> dict[str, Any]:
    """The reading, the questions and the error as data."""
    error = found.error
    return {
        "format": "kerfwise-reading/1",
        "nest": nest,
        "reading": None if found.reading is None else found.reading.as_json(),
        "questions": error.as_json() if isinstance(error, Questions) else [],
        "refused": None if error is None or isinstance(error, Questions) else str(error),
    }


# kerfwise facts: what the rules are told of a nest.


@click.command()
@input_options
@click.option(
    "-o",
    "--output",
    metavar="FACTS.json|FACTS.dzn",
    help="Output file, .json or .dzn. Default: print JSON.",
)
def facts_command(output: str | None, **given: Any) -> None:
    """Write the facts of NEST: containment, what lies ahead, hulls, neighbours, zones, candidates."""
    if output and Path(output).suffix not in (".json", ".dzn"):
        raise InputError(
            f"cannot write facts as {Path(output).suffix or output!r}: give a name ending in .json or .dzn",
            file=output,
        )
    from kerfwise.encoder.facts import facts_dzn, facts_json
    from kerfwise.jobs.request import facts_of
    from kerfwise.postproc.output_files import expect_outputs, write_files

    expect_outputs([Path(output)] if output else [], [Path(given["nest"])])
    try:
        inputs = read_inputs(**given)
    except Questions:
        nest = escape_text(given["nest"])
        print_note(f"the facts wait for the answers; kerfwise read {nest} -o READING.png draws what is read so far")
        raise
    protect(inputs, given["nest"], [output])
    facts = facts_of(inputs.nest, inputs.profile)
    facts = facts if facts.copies is None else facts.copies.whole
    if output is None:
        click.echo(facts_json(facts), nl=False)
        expect_printed()
    else:
        write_files({Path(output): facts_dzn(facts) if output.endswith(".dzn") else facts_json(facts)})
