"""kerfwise explain: why a contour is cut where it is, then, and so."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import click

from .given import given_options, read_given


@click.command()
@given_options
@click.argument("plan", metavar="PLAN.json")
@click.argument("contour", metavar="CONTOUR")
@click.option(
    "--all", "everything", is_flag=True, help="Everything that holds the contour, and the chains to the ends."
)
@click.option("--json", "as_data", is_flag=True, help="The same as data.")
def command(plan: str, contour: str, everything: bool, as_data: bool, **given: Any) -> None:
    """Say what holds CONTOUR (such as P3.outer) in its place, why it is entered so, and what moving it would cost."""
    from kerfwise.jobs.ask import facts_of
    from kerfwise.jobs.priced_heat import with_heat_prices
    from kerfwise.models.plan.conflict import state_relaxed
    from kerfwise.models.plan.explain import as_json, as_text, explain
    from kerfwise.models.plan.reader import read_plan
    from kerfwise.rules.stating.state_rules import state_rules

    from .kept import again_first

    asked = read_given(**given)
    made = read_plan(plan)
    asked = replace(asked, profile=again_first(asked.profile.at_origin(made.origin), made.already))
    facts = facts_of(asked.nest, asked.profile, made.already)
    state = state_relaxed if any(dropped.relaxed for dropped in made.dropped) else state_rules
    stated = state(facts, asked.profile, reads_files=True)
    if asked.profile.objective.heat:
        stated = with_heat_prices(facts, asked.profile, stated)
    told = explain(facts, asked.profile, stated, made, contour)
    click.echo(as_json(told) if as_data else as_text(told, everything))
