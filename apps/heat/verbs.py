"""kerfwise heat: how hot a plan or a program makes the sheet, where, and for how long."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import click

from kerfwise.commands.shared_options import (
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
from kerfwise.encoder.errors import InputError

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
def command(
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
    from kerfwise.postproc.output_files import expect_folders, expect_place, make_folder, write_files

    from .simulation import simulate_made, simulate_old

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
