"""kerfwise plot: a nest or a plan as a picture."""

from __future__ import annotations

from typing import Any

import click

from .given import given_options, read_given


@click.command()
@given_options
@click.argument("plan", metavar="[PLAN.json]", required=False)
@click.option("-o", "--output", required=True, metavar="OUT.svg|.png|.html", help="Where to draw.")
def command(plan: str | None, output: str, **given: Any) -> None:
    """Draw NEST, or the plan PLAN.json of it: order, zones, pierces, leads, directions and idle travel."""
    from ..models.plan import read_plan
    from ..postproc.report import plot

    asked = read_given(**given)
    plot(asked.nest, read_plan(plan) if plan else None, output, asked.profile.machine.home)
