"""kerfwise rules: the catalogue, one rule's page, a new rule, and the cases of rules."""

from __future__ import annotations

from pathlib import Path

import click

from kerfwise.encoder.errors import InputError
from kerfwise.rules.profile.profile import DEFAULT, load_profile

from .given import TRUST

PROFILE = click.option("-p", "--profile", default=DEFAULT, show_default=True, help="Whose strengths to list.")


class Pages(click.Group):
    """Takes a word that is no verb of its own for the name of a rule."""

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """The verb that is asked for; `page`, with all arguments, for the name of a rule."""
        return super().resolve_command(ctx, args if args[0] in self.commands else ["page", *args])


@click.group(cls=Pages, invoke_without_command=True, subcommand_metavar="[RULE | new NAME | test [RULE]]")
@PROFILE
@TRUST
@click.pass_context
def command(ctx: click.Context, profile: str, trust: bool) -> None:
    """List the rules with the strength the profile gives them, or print the page of RULE.

    `kerfwise rules RULE --picture OUT.svg` draws its cases, `kerfwise rules new NAME` begins a rule of that name,
    `kerfwise rules test [RULE]` runs the cases.
    """
    if ctx.invoked_subcommand is None:
        _list(profile, trust)


def _list(profile: str, trust: bool) -> None:
    from kerfwise.rules.pages.pages import rule_table

    loaded = load_profile(profile, trust=trust)
    for row in rule_table(loaded):
        click.echo(f"{row.id:26}{_strength(row.strength, row.weight):14}{row.sentence}")
    for own in loaded.own_rules:
        click.echo(f"{own.id:26}{_strength(own.strength, own.weight):14}{own.why}")


def _strength(strength: str, weight: float | None) -> str:
    return strength if weight is None else f"soft {weight:g} mm"


@command.command(hidden=True)
@click.argument("rule")
@click.option("--picture", metavar="OUT.svg", help="Draw the rule's first case that fails and its first that passes.")
@PROFILE
@TRUST
def page(rule: str, picture: str | None, profile: str, trust: bool) -> None:
    """Print the page of RULE."""
    from kerfwise.rules.pages.pages import rule_page

    text = rule_page(rule, load_profile(profile, trust=trust).known_rules())
    if picture is None:
        click.echo(text, nl=False)
    else:
        _draw(rule, Path(picture))


def _draw(rule: str, path: Path) -> None:
    from kerfwise.postproc.files import expect_outputs, write_files
    from kerfwise.postproc.report.case_picture import Panel, case_picture
    from kerfwise.rules.run_cases import cases_of

    if path.suffix.lower() != ".svg":
        raise InputError(f"cannot draw a case as {path.suffix or str(path)!r}: give a name ending in .svg")
    chosen = [next(case for case in cases_of(rule) if case.kind == kind) for kind in ("fails", "passes")]
    panels = [Panel(f"{rule}: {case.name}", case.nest, case.cuts, case.violations) for case in chosen]
    expect_outputs([path], [])
    write_files({path: case_picture(panels)})
    click.echo(f"written: {path}")


@command.command()
@click.argument("name")
@click.option("--into", metavar="DIR", type=click.Path(path_type=Path), help="The source checkout, if not this one.")
def new(name: str, into: Path | None) -> None:
    """Write the three files of a rule NAME, with an example in them that works: change it into your own."""
    from kerfwise.rules.pages.new_rule import is_checkout, new_rule

    running = Path(__file__).resolve().parents[1]
    root = into or (running if is_checkout(running) else Path.cwd())
    for path in new_rule(name, root):
        click.echo(f"written: {path}")
    if root.resolve() != running:
        click.echo(f"this kerfwise runs from elsewhere; to have it run from there: pip install -e {root.resolve()}")
    click.echo(f"next: kerfwise rules test {name}, then docs/writing-a-rule.md")


@command.command()
@click.argument("rule", required=False)
def test(rule: str | None) -> int:
    """Run the cases of RULE, or of every rule; exit 1 if one does not go as it says."""
    from kerfwise.rules.registry import RULES
    from kerfwise.rules.run_cases import run_cases

    failed = count = 0
    for name in [rule] if rule else RULES:
        for outcome in run_cases(name):
            count, failed = count + 1, failed + bool(outcome.wrong)
            click.echo(f"{'FAILED' if outcome.wrong else 'ok':7} {outcome.rule}: {outcome.case}")
            for line in outcome.wrong:
                click.echo(f"        {line}")
    click.echo(f"{count} cases, {failed} failed")
    return 1 if failed else 0
