"""What solve says when the hard rules cannot all hold: which contradict each other, the way out, and a picture."""

from __future__ import annotations

from pathlib import Path

import click

from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.facts.facts import Facts
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.stating.state_rules import unread_files


def tell_conflict(
    facts: Facts, profile: Profile, error: RulesConflict, picture: str | Path, limits: SolveOptions
) -> int:
    """Say why there is no plan, and draw the contours in conflict if they are known; the exit code is 1.

    The look for what contradicts what takes no longer than the limits of the plan once more.
    """
    from kerfwise.models.plan.conflict import NotAnswered, Purse, find_conflict
    from kerfwise.postproc.report import plot_spot

    try:
        conflict, within = find_conflict(facts, profile, Purse.of(limits)), True
    except NotAnswered:
        conflict, within = None, False
    if conflict is None:
        click.echo(f"kerfwise: {error}", err=True)
        if not within:
            click.echo("  note: which rules contradict each other, if any do, was not shown within the limit", err=True)
        for note in unread_files(profile):
            click.echo(f"  note: {note}", err=True)
        return 1
    click.echo("kerfwise: " + "\n".join(conflict.lines()), err=True)
    if conflict.relax is not None:
        click.echo("--relax takes this way out, and says so in the plan and in the program", err=True)
    if conflict.contours:
        caption = f"in conflict: {', '.join(dict.fromkeys(about.rule for about in conflict.clash))}"
        plot_spot(facts.nest, conflict.contours, picture, caption=caption, home=profile.home_on(facts.nest))
        click.echo(f"the contours in conflict: {picture}", err=True)
    return 1
