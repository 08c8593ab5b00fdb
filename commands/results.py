"""What is done with a plan or a program: check, explain, time, heat and plot."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from kerfwise.app_modules import app_module
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.questions import Questions
from kerfwise.encoder.readers.read import SUFFIXES
from kerfwise.encoder.text import escape_text

from .read import draw_seen, seen_nest
from .shared_options import (
    FEED,
    KERF,
    input_options,
    print_note,
    program_alone,
    protect,
    read_inputs,
    read_program_alone,
    trusted_if,
)

if TYPE_CHECKING:
    from kerfwise.encoder.readers.read import BrokenNest


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
    from kerfwise.models.plan.explain import as_text, explanation_as_json
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


# kerfwise heat: how hot a plan or a program makes the sheet, where, and for how long.

FRAMES = 60


@click.command()
@input_options
@click.option("--model", type=click.Choice(["physical", "logical"]), help="Override heat.model.")
@click.option("--json", "as_json", is_flag=True, help="Print model, overheats, peak_c and more, as JSON.")
@click.option("-o", "--output", metavar="MAP.png", help="Write a picture of the peak temperature of every point.")
@click.option("--frames", metavar="DIR", help=f"{FRAMES} pictures of the sheet, evenly spread over the program.")
@FEED
@KERF
@click.argument("made", metavar="PLAN.json|OUT.nc", required=False)
def heat_command(
    made: str | None,
    model: Any,
    as_json: bool,
    output: str | None,
    frames: str | None,
    feed: float | None,
    kerf: float | None,
    **given: Any,
) -> None:
    """Simulate the sheet temperatures of a plan or an NC program of NEST, and count the overheated points.

    Without NEST, derive the parts and holes from the program's burns.
    """
    if output and Path(output).suffix.lower() != ".png":
        kind = Path(output).suffix or output
        raise InputError(f"cannot draw temperatures as {kind!r}: give a name ending in .png", file=output)
    from kerfwise.jobs.simulation import simulate_made, simulate_old
    from kerfwise.postproc.output_files import expect_folders, expect_place, make_folder, write_files

    if output:
        expect_folders([Path(output)])
    if frames:
        expect_place(Path(frames))

    count = FRAMES if frames else 0
    if program_alone(given["nest"], made):
        job = read_program_alone(feed, kerf, given)
        inputs = job.given
        protect(inputs, given["nest"], [output])
        found = simulate_old(job, model, print_note, count)
    else:
        inputs = read_inputs(**given, last=made)
        protect(inputs, given["nest"], [output], made)
        found = simulate_made(inputs, str(made), model, print_note, count, trusted_if(feed))
    files: dict[Path, str | bytes] = {Path(frames or "") / name: png for name, png in found.frames.items()}
    if output:
        files[Path(output)] = found.picture().content
    if frames:
        make_folder(Path(frames))
    protect(inputs, given["nest"], files, made)
    write_files(files)
    click.echo(json.dumps(found.as_json()) if as_json else found)


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
