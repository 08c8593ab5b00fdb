"""kerfwise time: how long a plan or a program takes, on what, and what that costs."""

from __future__ import annotations

import json
from typing import Any

import click

from .shared_options import (
    FEED,
    KERF,
    input_options,
    print_note,
    program_alone,
    read_inputs,
    read_program_alone,
    trusted_if,
)


@click.command()
@input_options
@click.option("--json", "as_json", is_flag=True, help="Print cut_s, idle_s, pierce_s, total_s, idle_share, nc_blocks.")
@FEED
@KERF
@click.argument("made", metavar="PLAN.json|OUT.nc", required=False)
def command(made: str | None, as_json: bool, feed: float | None, kerf: float | None, **given: Any) -> None:
    """Print the time of a plan or an NC program of NEST by the profile's time model, and its cost.

    A program needs no NEST.
    """
    from kerfwise.jobs.programs import time_made, time_old

    if program_alone(given["nest"], made):
        times = time_old(read_program_alone(feed, kerf, given))
    else:
        asked = read_inputs(**given, last=made)
        for text in asked.profile.time_and_price_notes():
            print_note(text)
        times = time_made(asked, str(made), print_note, trusted_if(feed))
    click.echo(json.dumps(times.as_json()) if as_json else times)
