"""kerfwise check: every rule, judged independently of whatever made the plan."""

from __future__ import annotations

from typing import Any

import click

from .given import given_options, read_given, tell_note


@click.command()
@given_options
@click.option("--plan", metavar="PLAN.json", help="The plan of OUT.nc: says what its comments do not, and is followed.")
@click.argument("made", metavar="PLAN.json|OUT.nc")
def command(made: str, plan: str | None, **given: Any) -> int:
    """Judge a plan or an NC program of NEST by every rule; exit 1 if a hard one is broken."""
    from kerfwise.jobs.checking import check_made
    from kerfwise.postproc.check import report

    result = check_made(read_given(**given), made, tell_note, plan)
    click.echo(report(result))
    return 0 if result.ok else 1
