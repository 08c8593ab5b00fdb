"""What is read of a nest: what a drawing is taken for, and its facts."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.questions import Questions
from kerfwise.encoder.text import escape_text

from .shared_options import input_options, nest_request, print_note, protect, read_inputs, reading_options
from .terminal import expect_printed

if TYPE_CHECKING:
    from kerfwise.encoder.readers.read import Seen


# kerfwise read: what a drawing is taken for, before anything is made of it.

OF_READING = ("units", "sheet", "frame", "repair", "refit_arcs")


@click.command()
@input_options
@click.option("-o", "--output", metavar="READING.png|.svg|.pdf", help="A picture: cut, marked, left out, unknown.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON, with the questions.")
def read_command(output: str | None, as_json: bool, **given: Any) -> int:
    """Print how NEST is read: units, sheet, each layer, what is left out and repaired, and open questions.

    Exit code 3 if questions are open, 2 if it cannot be cut as drawn; the picture is drawn in any case.
    """
    from kerfwise.encoder.readers.read import seen
    from kerfwise.jobs.inputs import plant_of, reading
    from kerfwise.jobs.nest_job.request import job_for, kept_answers, profile_for
    from kerfwise.postproc.output_files import expect_outputs, write_files
    from kerfwise.postproc.report import expect_picture
    from kerfwise.postproc.report.simple_pictures import reading_picture

    nest, trust = given["nest"], given.pop("trust")
    if output:
        expect_picture(Path(output).suffix, output)
        expect_outputs([Path(output)], [Path(nest)])
    said = reading_options(*(given.pop(name) for name in OF_READING))
    given.pop("origin")
    asked = nest_request(given.pop("profile"), **{k: v for k, v in given.items() if k != "nest"})
    job = job_for(nest, asked.job, print_note)
    plant = profile_for(asked, job, print_note, lambda named: plant_of(named, trust))
    found = seen(nest, reading(plant, **said))
    if found.nest is not None and asked.answers and not isinstance(found.error, InputError):
        kept_answers(nest, job, asked, found.nest, print_note)
    if output:
        title = f"{Path(nest).name}: as it was understood"
        write_files({Path(output): reading_picture(found.lines, found.nest, escape_text(title), Path(output).suffix)})
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
    asked = read_inputs(**given)
    protect(asked, given["nest"], [output])
    facts = facts_of(asked.nest, asked.profile)
    facts = facts if facts.copies is None else facts.copies.whole
    if output is None:
        click.echo(facts_json(facts), nl=False)
        expect_printed()
    else:
        write_files({Path(output): facts_dzn(facts) if output.endswith(".dzn") else facts_json(facts)})
