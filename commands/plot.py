"""kerfwise plot: a nest or a plan as a picture."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from .given import given_options, protect, read_given, tell_note


@click.command()
@given_options
@click.argument("plan", metavar="[PLAN.json]", required=False)
@click.option("-o", "--output", required=True, metavar="OUT.svg|.png|.html", help="Where to draw.")
def command(plan: str | None, output: str, **given: Any) -> None:
    """Draw NEST, or the plan PLAN.json of it: order, zones, pierces, leads, directions and idle travel."""
    from kerfwise.jobs.given import differences
    from kerfwise.models.plan.reader import read_plan
    from kerfwise.postproc.files import expect_outputs
    from kerfwise.postproc.report import expect_picture, plot

    expect_picture(Path(output).suffix)
    expect_outputs([Path(output)], [Path(given["nest"])])
    asked = read_given(**given)
    protect(asked, given["nest"], [output], plan)
    made = read_plan(plan) if plan else None
    if made is not None:
        for text in differences(made, asked):
            tell_note(text)
    profile = asked.profile if made is None else asked.profile.at_origin(made.origin)
    plot(asked.nest, made, output, profile.home_on(asked.nest))
