"""What solve says when there is no plan: which hard rules contradict each other, the way out, and a picture."""

from __future__ import annotations

from pathlib import Path

import click

from kerfwise.jobs.no_plan import NOT_SHOWN, NoPlan


def tell_conflict(no_plan: NoPlan, picture: str | Path) -> int:
    """Say why there is no plan, and draw the contours in conflict if they are known; the exit code is 1."""
    conflict, facts, profile = no_plan.conflict, no_plan.facts, no_plan.profile
    click.echo(f"kerfwise: {no_plan.why if conflict is None else conflict}", err=True)
    if conflict is None:
        if not no_plan.within_limit:
            click.echo(f"  note: {NOT_SHOWN}", err=True)
        return 1
    if conflict.relax is not None:
        click.echo("--relax takes this way out, and says so in the plan and in the program", err=True)
    if conflict.contours:
        from kerfwise.postproc.report import plot_spot

        caption = f"in conflict: {', '.join(dict.fromkeys(about.rule for about in conflict.clash))}"
        nest = facts.whole_nest  # after a stop what is out may be in conflict, too
        plot_spot(nest, conflict.contours, picture, caption=caption, home=profile.home_on(nest))
        click.echo(f"the contours in conflict: {picture}", err=True)
    return 1
