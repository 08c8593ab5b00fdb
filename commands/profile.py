"""kerfwise profile: check one, or show it with nothing left implicit."""

from __future__ import annotations

import click

from kerfwise.rules.profile.profile import load_profile
from kerfwise.rules.profile.text import profile_yaml

from .terminal import expect_printed


@click.group()
def command() -> None:
    """Check a profile (by name or path), or show it with every default filled in."""


@command.command()
@click.argument("profile", metavar="PROFILE")
def check(profile: str) -> None:
    """Say whether PROFILE can be used, and if not, where it is wrong."""
    from kerfwise.postproc.verdict.dialect_read_back import trusted_dialect

    loaded = load_profile(profile)
    trusted_dialect(loaded)
    strengths = [setting.strength for setting in loaded.settings().values()]
    hard, soft = strengths.count("hard"), strengths.count("soft")
    click.echo(f"{loaded.name}: fine, {hard} hard and {soft} soft rules")


@command.command()
@click.argument("profile", metavar="PROFILE")
def show(profile: str) -> None:
    """Print PROFILE as YAML with every default filled in."""
    click.echo(profile_yaml(load_profile(profile)), nl=False)
    expect_printed()
