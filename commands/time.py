"""kerfwise time: how long a plan or a program takes, on what, and what that costs."""

from __future__ import annotations

import json
from typing import Any

import click

from .given import given_options, read_given, tell_note


@click.command()
@given_options
@click.option("--json", "as_json", is_flag=True, help="Print cut_s, idle_s, pierce_s, total_s, idle_share, nc_blocks.")
@click.argument("made", metavar="PLAN.json|OUT.nc")
def command(made: str, as_json: bool, **given: Any) -> None:
    """Say how long a plan or an NC program of NEST takes by the profile's time model, and what it costs."""
    from kerfwise.jobs.times import time_made

    times = time_made(read_given(**given), made, tell_note)
    click.echo(json.dumps(times.as_json()) if as_json else times)
