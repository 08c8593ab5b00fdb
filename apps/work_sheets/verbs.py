"""`kerfwise sheet`: a plan on paper, for the operator."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from kerfwise.app_modules import library
from kerfwise.commands.shared_options import (
    LANGUAGE,
    input_options,
    print_note,
    protect,
    read_inputs,
)
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.escape import escape_text

if TYPE_CHECKING:
    pass


@click.command()
@input_options
@click.argument("plan", metavar="PLAN.json")
@click.option("-o", "--output", metavar="OUT.pdf", help="Output file. Default: NEST.pdf.")
@click.option(
    "--program", metavar="OUT.nc", help="The program whose hash is printed. Default: as written from the plan."
)
@click.option("--date", default="", metavar="TEXT", help="Date to print. Default: none.")
@click.option(
    "--about", multiple=True, metavar="NAME=TEXT", help="Additional line to print, such as order=4711; repeatable."
)
@click.option("--labels", metavar="LABELS.pdf", help="Also print a label with a QR code for each part.")
@LANGUAGE
def sheet_command(
    plan: str,
    output: str | None,
    program: str | None,
    date: str,
    about: tuple[str, ...],
    labels: str | None,
    language: str,
    **options: Any,
) -> None:
    """Print PLAN.json of NEST as a work sheet: picture, settings, times, boxes to tick, cuts in order, program's hash.

    A4, on more pages if there are many cuts. The same plan gives the same bytes.
    """
    from kerfwise.apps.work_sheets.sheet_parts import labels_pdf, sheet_number
    from kerfwise.apps.work_sheets.work_sheet import about_of_job, sheets_pdf, work_sheet
    from kerfwise.languages import texts
    from kerfwise.models.plan.read_plan import read_plan
    from kerfwise.postproc.output_files import expect_outputs, write_files

    library("segno", "a work sheet", "sheets")
    path = Path(output or f"{Path(options['nest']).stem}.pdf")
    for written in (path, *([Path(labels)] if labels else [])):
        if written.suffix.lower() != ".pdf":
            raise InputError("a work sheet is a PDF: give a name ending in .pdf", file=written)
    facts = dict(_fact(text) for text in about)
    outputs = [path, *([Path(labels)] if labels else [])]
    expect_outputs(outputs, [Path(name) for name in (options["nest"], plan, program) if name])
    inputs = read_inputs(**options, last=plan)
    protect(inputs, options["nest"], outputs, plan, program)
    for text in inputs.profile.time_and_price_notes():
        print_note(text)
    say = texts(language)
    number = sheet_number(options["nest"], say)
    facts = ({"number": number} if number else {}) | about_of_job(inputs.job, say) | facts
    paper = work_sheet(inputs, read_plan(plan), program, about=facts, tell=print_note, language=language)
    files = {path: sheets_pdf([paper], date)}
    if labels:
        files[Path(labels)] = labels_pdf([(inputs.nest, inputs.profile)], language)
    write_files(files)
    click.echo(f"written: {', '.join(escape_text(str(file)) for file in files)}")


def _fact(text: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not (name.strip() and equals):
        raise click.UsageError(f"--about {text!r}: expected a name and a text, such as order=4711")
    return name.strip(), value.strip()
