"""kerfwise plot: a nest or a plan as a picture."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from kerfwise.encoder.readers.read import SUFFIXES
from kerfwise.encoder.text import escape_text

from .shared_options import FEED, KERF, input_options, print_note, protect, read_inputs, read_program_alone

if TYPE_CHECKING:
    from kerfwise.encoder.readers.read import BrokenNest


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
def command(
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

    A nest that cannot be cut as it is drawn is drawn all the same, with the wrong contours in red. An NC program in the
    place of NEST is drawn as it burns: paths, order and travel.
    """
    from kerfwise.encoder.readers.read import BrokenNest
    from kerfwise.jobs.inputs import differences
    from kerfwise.jobs.page import page_bytes, page_data
    from kerfwise.models.plan.read_plan import read_plan
    from kerfwise.postproc.output_files import expect_outputs, write_files
    from kerfwise.postproc.report import PAGE, expect_picture, plot

    expect_picture(Path(output).suffix, output)
    expect_outputs([Path(output)], [Path(given["nest"])])
    if plan is None and Path(given["nest"]).suffix.lower() not in (*SUFFIXES, ""):
        _draw_program(output, feed, kerf, given)
        return
    try:
        asked = read_inputs(**given, last=plan)
    except BrokenNest as broken:
        _draw_broken(broken, output)
        return
    protect(asked, given["nest"], [output], plan)
    made = read_plan(plan) if plan else None
    if made is not None:
        for text in differences(made, asked):
            print_note(text)
    if Path(output).suffix.lower() == PAGE and made is not None:
        data = page_data(asked, made, heat=heat, detail="full" if why else None)
        write_files({Path(output): page_bytes(data)})
        return
    profile = asked.profile if made is None else asked.profile.at_origin(made.origin)
    plot(asked.nest, made, output, profile.home_on(asked.nest))


def _draw_program(output: str, feed: float | None, kerf: float | None, given: dict[str, Any]) -> None:
    from kerfwise.postproc.output_files import write_files
    from kerfwise.postproc.report.simple_pictures import Panel, draw_burns, expect_kind

    expect_kind(output)
    job = read_program_alone(feed, kerf, given)
    name = Path(given["nest"]).name
    told = f"idle {job.program.idle_mm / 1000:.3f} m, {len(job.program.burns)} burns"
    panel = Panel(name, told, job.program.burns, job.home, job.program.end)
    write_files({Path(output): draw_burns([panel], Path(output).suffix, name)})


def _draw_broken(broken: BrokenNest, output: str) -> None:
    from kerfwise.postproc.report import plot, plot_spot

    click.echo(f"warning: {broken}", err=True)
    if broken.wrong:
        plot_spot(broken.nest, broken.wrong, output, caption=escape_text(broken.message))
    else:
        plot(broken.nest, None, output)
