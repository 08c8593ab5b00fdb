"""kerfwise explain: why a contour is cut where it is, then, and so."""

from __future__ import annotations

from typing import Any

import click

from .shared_options import input_options, read_inputs


@click.command()
@input_options
@click.argument("plan", metavar="PLAN.json")
@click.argument("contour", metavar="CONTOUR")
@click.option(
    "--all",
    "everything",
    is_flag=True,
    help="Print all constraints on the contour, and the chains to both ends.",
)
@click.option("--json", "as_data", is_flag=True, help="Print the same as JSON.")
def command(plan: str, contour: str, everything: bool, as_data: bool, **given: Any) -> None:
    """Explain the position and entry of CONTOUR (such as P3.outer), and what moving it would cost."""
    from kerfwise.jobs.explainer import Explainer
    from kerfwise.models.plan.explain import as_text, explanation_as_json
    from kerfwise.models.plan.read_plan import read_plan

    asked = read_inputs(**given, last=plan)
    told = Explainer(asked, read_plan(plan)).explain(contour)
    click.echo(explanation_as_json(told) if as_data else as_text(told, everything))
