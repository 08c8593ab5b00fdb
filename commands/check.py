"""kerfwise check: every rule, judged independently of whatever made the plan."""

from __future__ import annotations

from typing import Any

import click

from .given import given_options, note_if_others, program_text, read_given


@click.command()
@given_options
@click.argument("made", metavar="PLAN.json|OUT.nc")
def command(made: str, **given: Any) -> int:
    """Judge a plan or an NC program of NEST by every rule; exit 1 if a hard one is broken."""
    from kerfwise.models.plan.reader import read_plan
    from kerfwise.postproc.check import report
    from kerfwise.postproc.dialects import fitting_dialect
    from kerfwise.postproc.verdict.checking import check_plan, check_program

    asked = read_given(**given)
    fitting_dialect(asked.profile)  # a plan is worth nothing on a machine whose programs would not run
    if made.endswith(".json"):
        plan = read_plan(made)
        note_if_others(plan, asked)
        result = check_plan(asked.nest, plan, asked.profile)
    else:
        result = check_program(asked.nest, program_text(made), asked.profile, made)
    click.echo(report(result))
    return 0 if result.ok else 1
