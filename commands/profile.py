"""kerfwise profile: check one, or show it with nothing left implicit."""

from __future__ import annotations

import click

from kerfwise.rules.profile.profile import DEFAULT, load_profile
from kerfwise.rules.profile.said_at import Sources
from kerfwise.rules.profile.text import profile_yaml

from .given import TRUST
from .terminal import expect_printed


@click.group()
def command() -> None:
    """Check a profile (by name or path), show it with every default filled in, or print the schema of profiles."""


@command.command()
@click.argument("profile", metavar="PROFILE")
@TRUST
def check(profile: str, trust: bool) -> None:
    """Say whether PROFILE can be used, and if not, where it is wrong."""
    from kerfwise.postproc.verdict.dialect_read_back import trusted_dialect

    loaded = load_profile(profile, trust=trust)
    trusted_dialect(loaded)
    strengths = [setting.strength for setting in loaded.settings().values()]
    hard, soft = strengths.count("hard"), strengths.count("soft")
    click.echo(f"{loaded.name}: fine, {hard} hard and {soft} soft rules")
    for text in Sources(loaded).charted():
        click.echo(f"  {text}")
    for text in loaded.chart_notes():
        click.echo(f"note: {text}", err=True)


@command.command()
@click.argument("profile", metavar="PROFILE")
@click.option("--sources", is_flag=True, help="Say of each value where it is from: file and line.")
@TRUST
def show(profile: str, sources: bool, trust: bool) -> None:
    """Print PROFILE as YAML with every default filled in."""
    click.echo(profile_yaml(load_profile(profile, trust=trust), sources), nl=False)
    expect_printed()


@command.command()
@click.argument("profile", metavar="[PROFILE]", default=DEFAULT)
@TRUST
def schema(profile: str, trust: bool) -> None:
    """Print the JSON Schema that editors complete profiles by, with the rules that PROFILE and packages bring."""
    from kerfwise.rules.profile.schema import schema_text

    click.echo(schema_text(load_profile(profile, trust=trust).known_rules()), nl=False)
    expect_printed()
