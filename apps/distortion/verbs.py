"""kerfwise distort: how far each part of a plan or a program will be off when it is cold."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from kerfwise.commands.shared_options import (
    FEED,
    KERF,
    input_options,
    length_of,
    print_note,
    program_alone,
    protect,
    read_inputs,
    read_program_alone,
    trusted_if,
)
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.escape import escape_text
from kerfwise.encoder.readers.json_nest import nest_json

if TYPE_CHECKING:
    from .compensation import Kind

KINDS = ("size", "shape")


@click.command()
@input_options
@click.option("--grid", metavar="LENGTH", help="Width of a cell of the mesh. Default: some 7000 cells to the sheet.")
@click.option("--elastic", is_flag=True, help="Let no metal yield beside the cut.")
@click.option("--json", "as_json", is_flag=True, help="Print grid_mm and each part's errors, as JSON.")
@click.option("-o", "--output", metavar="OUT.svg", help="Write a picture of the parts as they will be, exaggerated.")
@click.option("--animate", metavar="OUT.html", help="Write a page that shows how the sheet moves, exaggerated.")
@click.option("--compensated", metavar="OUT.json", help="Write the nest with parts drawn so that they come out true.")
@click.option("--compensate", type=click.Choice(KINDS),
              help="What --compensated changes: the size of parts along x and y (default), or also shape.")  # fmt: skip
@FEED
@KERF
@click.argument("made", metavar="PLAN.json|OUT.nc", required=False)
def command(
    made: str | None,
    grid: str | None,
    elastic: bool,
    as_json: bool,
    output: str | None,
    animate: str | None,
    compensated: str | None,
    compensate: Kind | None,
    feed: float | None,
    kerf: float | None,
    **given: Any,
) -> None:
    """Predict how far each part of a plan or an NC program of NEST will be off, in mm, and where.

    The sheet warms and moves while it is cut: an error is how far the metal under the torch then is from where it lies
    when all is cold, the best rigid fit of the part taken off. Without NEST, derive the parts and holes from the
    program's burns.
    """
    for name, suffix, what in (
        (output, ".svg", "draw the parts"),
        (animate, ".html", "animate the sheet"),
        (compensated, ".json", "write the compensated nest"),
    ):
        if name and Path(name).suffix.lower() != suffix:
            kind = Path(name).suffix or name
            raise InputError(f"cannot {what} as {kind!r}: give a name ending in {suffix}", file=name)
    from kerfwise.postproc.output_files import expect_folders, write_files

    from .predict import distort_made, distort_old

    if compensate and not compensated:
        raise InputError("--compensate is for --compensated OUT.json, which names the nest to write")
    outputs = [name for name in (output, animate, compensated) if name]
    expect_folders([Path(name) for name in outputs])
    grid_mm = length_of("--grid", grid) if grid else None
    if program_alone(given["nest"], made):
        if compensated:
            raise InputError("--compensated needs NEST: a program alone does not have the parts as they are drawn")
        job = read_program_alone(feed, kerf, given)
        protect(job.given, given["nest"], outputs)
        found = distort_old(job, grid_mm, not elastic)
    else:
        inputs = read_inputs(**given, last=made)
        protect(inputs, given["nest"], outputs, made)
        found = distort_made(inputs, str(made), print_note, grid_mm, not elastic, trusted_if(feed))
    files: dict[Path, str | bytes] = {Path(output): found.picture().content} if output else {}
    if animate:
        files[Path(animate)] = found.animation().content
    changed = found.compensated(compensate or "size") if compensated else None
    if changed is not None:
        files[Path(str(compensated))] = nest_json(changed.nest)
    write_files(files)
    click.echo(json.dumps(found.as_json()) if as_json else found)
    if changed is not None:
        print_note(f"{escape_text(str(compensated))}: {changed.line(found.heat.absorbed_power_w)}")
