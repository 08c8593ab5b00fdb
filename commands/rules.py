"""kerfwise rules: the catalogue, and one rule's page."""

from __future__ import annotations

import click

from ..rules.profile import DEFAULT, load_profile


@click.command()
@click.argument("rule", required=False)
@click.option("-p", "--profile", default=DEFAULT, show_default=True, help="Whose strengths to list.")
def command(rule: str | None, profile: str) -> None:
    """List the rules with the strength the profile gives them, or print the page of RULE."""
    from ..rules.pages import rule_page, rule_table

    if rule is not None:
        click.echo(rule_page(rule), nl=False)
        return
    for row in rule_table(load_profile(profile)):
        strength = row.strength if row.weight is None else f"soft {row.weight:g} mm"
        click.echo(f"{row.id:26}{strength:14}{row.sentence}")
