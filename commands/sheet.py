"""kerfwise sheet: a plan on paper, for the operator."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.text import escape_text

from .shared_options import input_options, print_note, protect, read_inputs


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
def command(
    plan: str, output: str | None, program: str | None, date: str, about: tuple[str, ...], **options: Any
) -> None:
    """Print PLAN.json of NEST as a work sheet: picture, settings, times, boxes to tick, cuts in order, program's hash.

    A4, on more pages if there are many cuts. The same plan gives the same bytes.
    """
    from kerfwise.jobs.work_sheet import about_of_job, sheets_pdf, work_sheet
    from kerfwise.models.plan.read_plan import read_plan
    from kerfwise.postproc.output_files import expect_outputs, write_files

    path = Path(output or f"{Path(options['nest']).stem}.pdf")
    if path.suffix.lower() != ".pdf":
        raise InputError("a work sheet is a PDF: give a name ending in .pdf", file=path)
    facts = dict(_fact(text) for text in about)
    expect_outputs([path], [Path(name) for name in (options["nest"], plan, program) if name])
    given = read_inputs(**options, last=plan)
    protect(given, options["nest"], [path], plan, program)
    for text in given.profile.time_and_price_notes():
        print_note(text)
    facts = about_of_job(given.job) | facts
    made = work_sheet(given, read_plan(plan), program, about=facts, tell=print_note)
    write_files({path: sheets_pdf([made], date)})
    click.echo(f"written: {escape_text(str(path))}")


def _fact(text: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not (name.strip() and equals):
        raise click.UsageError(f"--about {text!r}: expected a name and a text, such as order=4711")
    return name.strip(), value.strip()
