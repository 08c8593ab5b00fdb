"""What is told of a nest, a plan or a program: read, facts, check, explain, time and plot."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from kerfwise.app_modules import app_module
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.escape import escape_text
from kerfwise.encoder.questions import Questions
from kerfwise.encoder.readers.read import SUFFIXES
from kerfwise.jobs.inputs import reading

from .shared_options import (
    FEED,
    KERF,
    OF_READING,
    drawing_said,
    input_options,
    nest_request,
    print_note,
    program_alone,
    protect,
    read_inputs,
    read_program_alone,
    trusted_if,
)
from .terminal import expect_printed

if TYPE_CHECKING:
    from kerfwise.encoder.readers.read import BrokenNest, Seen
    from kerfwise.jobs.nest_job.job import Job
    from kerfwise.jobs.nest_job.request import NestRequest


# What is read of a nest: what a drawing is taken for, and its facts.


def seen_nest(given: Mapping[str, Any]) -> tuple[Seen, NestRequest, Job | None]:
    """How a nest is understood, whether it can be cut or not, what the command line asks of it, and its job file."""
    from kerfwise.encoder.readers.read import seen
    from kerfwise.jobs.nest_job.request import job_for, profile_for

    of_nest = {k: v for k, v in given.items() if k not in (*OF_READING, "nest", "trust", "origin")}
    request = replace(nest_request(**of_nest), trust=given["trust"])
    job = job_for(given["nest"], request.job, print_note)
    plant = profile_for(request, job, print_note)
    return seen(given["nest"], reading(plant, drawing_said(given))), request, job


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
    from kerfwise.encoder.facts.export import facts_dzn, facts_json
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


@click.command()
@input_options
@click.option(
    "--plan",
    metavar="PLAN.json",
    help="The plan of OUT.nc: supplies what its comments omit; the program must follow it.",
)
@FEED
@KERF
@click.argument("made", metavar="PLAN.json|OUT.nc", required=False)
def check_command(made: str | None, plan: str | None, feed: float | None, kerf: float | None, **given: Any) -> int:
    """Check a plan or an NC program of NEST against every rule; exit 1 if a hard one is broken.

    Without NEST, derive the parts and holes from the program's burns.
    """
    from kerfwise.jobs.programs import check_made, check_old
    from kerfwise.postproc.check import report

    if program_alone(given["nest"], made):
        if plan is not None:
            raise click.UsageError("--plan is held against a program of a nest: give the nest too")
        result = check_old(read_program_alone(feed, kerf, given))
    else:
        result = check_made(read_inputs(**given, last=made), str(made), print_note, plan, trusted_if(feed))
    click.echo(report(result))
    return 0 if result.ok else 1


# kerfwise explain: why a contour is cut where it is, then, and so.


@click.command()
@input_options
@click.argument("plan", metavar="PLAN.json")
@click.argument("contour", metavar="CONTOUR")
@click.option(
    "--all",
    "everything",
    is_flag=True,
    help="Print all constraints on the contour, and the chains to both ends.",
)
@click.option("--json", "as_data", is_flag=True, help="Print the same as JSON.")
def explain_command(plan: str, contour: str, everything: bool, as_data: bool, **given: Any) -> None:
    """Explain the position and entry of CONTOUR (such as P3.outer), and what moving it would cost."""
    from kerfwise.jobs.explainer import Explainer
    from kerfwise.jobs.inputs import differences
    from kerfwise.models.plan.explain.explain import as_text, explanation_as_json
    from kerfwise.models.plan.read_plan import read_plan

    inputs = read_inputs(**given, last=plan)
    planned = read_plan(plan)
    explanation = Explainer(inputs, planned).explain(contour)
    for text in differences(planned, inputs):
        print_note(text)
    click.echo(explanation_as_json(explanation) if as_data else as_text(explanation, everything))


# kerfwise time: how long a plan or a program takes, on what, and what that costs.


@click.command()
@input_options
@click.option("--json", "as_json", is_flag=True, help="Print cut_s, idle_s, pierce_s, total_s, idle_share, nc_blocks.")
@FEED
@KERF
@click.argument("made", metavar="PLAN.json|OUT.nc", required=False)
def time_command(made: str | None, as_json: bool, feed: float | None, kerf: float | None, **given: Any) -> None:
    """Print the time of a plan or an NC program of NEST by the profile's time model, and its cost.

    A program needs no NEST.
    """
    from kerfwise.jobs.programs import time_made, time_old

    if program_alone(given["nest"], made):
        times = time_old(read_program_alone(feed, kerf, given))
    else:
        inputs = read_inputs(**given, last=made)
        for text in inputs.profile.time_and_price_notes():
            print_note(text)
        times = time_made(inputs, str(made), print_note, trusted_if(feed))
    click.echo(json.dumps(times.as_json()) if as_json else times)


# kerfwise plot: a nest or a plan as a picture.


@click.command()
@input_options
@click.argument("plan", metavar="[PLAN.json]", required=False)
@click.option("-o", "--output", required=True, metavar="OUT.svg|.png|.pdf|.html", help="Output file.")
@click.option(
    "--heat/--no-heat", default=None, help="For a page: simulate the heat or not. Default: if it takes only seconds."
)
@click.option(
    "--why", is_flag=True, help="For a page: compute the cost of moving each contour, however many there are."
)
@FEED
@KERF
def plot_command(
    plan: str | None,
    output: str,
    heat: bool | None,
    why: bool,
    feed: float | None,
    kerf: float | None,
    **given: Any,
) -> None:
    """Draw NEST, or the plan PLAN.json of it: order, zones, pierces, leads, directions and idle travel.

    An .html is a page for the browser, in one file: it plays the cuts, says why each is where it is, and has the
    verdict on every rule, the heat and the program.

    A nest that cannot be cut as it is drawn is drawn all the same, with the wrong contours in red; so is one that
    raises questions, with what these are about (exit 3). An NC program in the place of NEST is drawn as it burns:
    paths, order and travel.
    """
    from kerfwise.encoder.readers.read import BrokenNest
    from kerfwise.jobs.inputs import differences
    from kerfwise.models.plan.read_plan import read_plan
    from kerfwise.postproc.output_files import expect_outputs, write_files
    from kerfwise.postproc.report import PAGE, expect_picture, plot

    expect_picture(Path(output).suffix, output)
    expect_outputs([Path(output)], [Path(given["nest"])])
    if plan is None and Path(given["nest"]).suffix.lower() not in (*SUFFIXES, ""):
        _draw_program(output, feed, kerf, given)
        return
    try:
        inputs = read_inputs(**given, last=plan)
    except BrokenNest as broken:
        _draw_broken(broken, output)
        return
    except Questions:
        if plan is None:
            found, _, _ = seen_nest(given)
            draw_seen(found, given["nest"], output)
            print_note(f"written: {escape_text(output)}: what is read so far, what the questions are about in red")
        raise
    protect(inputs, given["nest"], [output], plan)
    loaded = read_plan(plan) if plan else None
    if loaded is not None:
        for text in differences(loaded, inputs):
            print_note(text)
    if Path(output).suffix.lower() == PAGE and loaded is not None:
        page = app_module("viewer.page.page_data")
        data = page.page_data(inputs, loaded, heat=heat, detail="full" if why else None)
        write_files({Path(output): page.page_bytes(data)})
        return
    profile = inputs.profile if loaded is None else inputs.profile.at_origin(loaded.origin)
    plot(inputs.nest, loaded, output, profile.home_on(inputs.nest))


def _draw_program(output: str, feed: float | None, kerf: float | None, options: dict[str, Any]) -> None:
    from kerfwise.postproc.output_files import write_files
    from kerfwise.postproc.report.simple_pictures import Panel, draw_burns, expect_kind

    expect_kind(output)
    job = read_program_alone(feed, kerf, options)
    name = Path(options["nest"]).name
    summary = f"idle {job.program.idle_mm / 1000:.3f} m, {len(job.program.burns)} burns"
    panel = Panel(name, summary, job.program.burns, job.home, job.program.end)
    write_files({Path(output): draw_burns([panel], Path(output).suffix, name)})


def _draw_broken(broken: BrokenNest, output: str) -> None:
    from kerfwise.postproc.report import plot, plot_spot

    click.echo(f"warning: {broken}", err=True)
    if broken.wrong:
        plot_spot(broken.nest, broken.wrong, output, caption=escape_text(broken.message))
    else:
        plot(broken.nest, None, output)
