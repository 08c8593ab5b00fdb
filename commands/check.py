"""kerfwise check: every rule, judged independently of whatever made the plan."""

from __future__ import annotations

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
@click.option(
    "--plan",
    metavar="PLAN.json",
    help="The plan of OUT.nc: supplies what its comments omit; the program must follow it.",
)
@FEED
@KERF
@click.argument("made", metavar="PLAN.json|OUT.nc", required=False)
def command(made: str | None, plan: str | None, feed: float | None, kerf: float | None, **given: Any) -> int:
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
