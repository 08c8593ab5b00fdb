"""kerfwise rules: the catalogue, one rule's page, a new rule, and the cases of rules."""

from __future__ import annotations

from pathlib import Path

import click

from kerfwise.commands.shared_options import TRUST
from kerfwise.encoder.errors import InputError
from kerfwise.rules.profile.load import DEFAULT, load_profile

PROFILE = click.option("-p", "--profile", default=DEFAULT, show_default=True, help="Whose strengths to list.")


class Pages(click.Group):
    """Takes a word that is no verb of its own for the name of a rule."""

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """The verb that is asked for; `page`, with all arguments, for the name of a rule."""
        return super().resolve_command(ctx, args if args[0] in self.commands else ["page", *args])


@click.group(cls=Pages, invoke_without_command=True, subcommand_metavar="[RULE | new NAME | test [RULE]]")
@click.option("--texts", is_flag=True, help="Which text is the source of each rule, and which a file may replace.")
@PROFILE
@TRUST
@click.pass_context
def command(ctx: click.Context, texts: bool, profile: str, trust: bool) -> None:
    """List the rules with the strength the profile gives them, or print the page of RULE.

    `kerfwise rules RULE --picture OUT.svg` draws its cases, `kerfwise rules new NAME` writes a new rule,
    `kerfwise rules test [RULE]` runs the cases.
    """
    if ctx.invoked_subcommand is None and texts:
        from kerfwise.rules.pages import texts_page

        click.echo(texts_page(), nl=False)
    elif ctx.invoked_subcommand is None:
        _list(profile, trust)


def _list(profile: str, trust: bool) -> None:
    from kerfwise.rules.pages import rule_table

    loaded = load_profile(profile, trust=trust)
    for row in rule_table(loaded):
        click.echo(f"{row.id:26}{_strength(row.strength, row.weight):14}{row.sentence}{row.from_where}")


def _strength(strength: str, weight: float | None) -> str:
    return strength if weight is None else f"soft {weight:g} mm"


@command.command(hidden=True)
@click.argument("rule")
@click.option("--picture", metavar="OUT.svg", help="Draw a case of the rule that fails and one that passes.")
@PROFILE
@TRUST
def page(rule: str, picture: str | None, profile: str, trust: bool) -> None:
    """Print the page of RULE."""
    from kerfwise.rules.pages import rule_page

    text = rule_page(rule, load_profile(profile, trust=trust).known_rules())
    if picture is None:
        click.echo(text, nl=False)
    else:
        _draw(rule, picture)


def _draw(rule: str, picture: str) -> None:
    from kerfwise.postproc.output_files import expect_outputs, write_files
    from kerfwise.postproc.report.rule_pictures import case_picture, rule_panels
    from kerfwise.rules.run_cases import cases_of

    path = Path(picture)
    if path.suffix.lower() != ".svg":
        raise InputError(f"cannot draw a case as {path.suffix or picture!r}: give a name ending in .svg", file=picture)
    panels = [*rule_panels(cases_of(rule)).values()]
    expect_outputs([path], [])
    write_files({path: case_picture(panels)})
    click.echo(f"written: {path}")


@command.command()
@click.argument("name")
@click.option("--python", "language", flag_value="python", help="Write one Python file with the rule and its cases.")
@click.option("--mzn", "language", flag_value="mzn", help="Write one MiniZinc file with the rule and its cases.")
@click.option(
    "-o", "folder", metavar="FOLDER", type=click.Path(path_type=Path), help="Output folder. Default: the current one."
)
@click.option("--into", metavar="DIR", type=click.Path(path_type=Path), help="The source checkout, if not this one.")
@click.option("--like", metavar="SHIPPED", help="Copy the MiniZinc text of that shipped rule; NAME may be its own.")
def new(name: str, language: str | None, folder: Path | None, into: Path | None, like: str | None) -> None:
    """Write a working example of a rule NAME, to change into your own.

    With --python or --mzn it is one file, in any folder; with --like it is the text of a shipped rule. Without, it is
    the three files of a rule of the catalogue, in a source checkout of kerfwise.
    """
    if like is not None:
        if into is not None or language == "python":
            raise InputError("--like copies a text in MiniZinc: say -o FOLDER, and neither --python nor --into")
        from kerfwise.rules.pages import copied_rule

        _told_outside(copied_rule(name, like, folder or Path()), "models")
        return
    if language is not None:
        if into is not None:
            raise InputError(
                "--into names a checkout, for a rule of the catalogue: say -o FOLDER with --python or --mzn"
            )
        _new_outside(name, language, folder or Path())
        return
    if folder is not None:
        raise InputError("-o goes with --python or --mzn: a rule of the catalogue is written --into a checkout")
    from kerfwise.rules.pages import is_checkout, new_rule

    running = Path(__file__).resolve().parents[2]
    root = into or (running if is_checkout(running) else Path.cwd())
    for path in new_rule(name, root):
        click.echo(f"written: {path}")
    if root.resolve() != running:
        click.echo(f"this kerfwise runs from elsewhere; to have it run from there: pip install -e {root.resolve()}")
    click.echo(f"next: kerfwise rules test {name}, then docs/writing-a-rule.md")


def _new_outside(name: str, language: str, folder: Path) -> None:
    from kerfwise.rules.pages import new_outside_rule

    path = new_outside_rule(name, language, folder)
    _told_outside(path, {"python": "python", "mzn": "models"}[language])


def _told_outside(path: Path, key: str) -> None:
    click.echo(f"written: {path}")
    click.echo(f"next: kerfwise rules test {path}, then in your profile: {key}: [{path.name}]")


@command.command()
@click.argument("rules", nargs=-1, metavar="[FILE|NAME]…")
@click.option("--cases", "cases_only", is_flag=True, help="Run the cases only.")
@PROFILE
@TRUST
def test(rules: tuple[str, ...], cases_only: bool, profile: str, trust: bool) -> int:
    """Try each rule in a FILE (.py or .mzn), or of that NAME, or every rule; exit 1 if something is wrong.

    The cases of a rule are run. Then, on all plans of small nests, its statements, its violations, its text in MiniZinc
    and every engine are held against each other. A file of Python that is named here is run.
    """
    from .trials import rules_to_try, try_rule

    with_rules, names = rules_to_try(load_profile(profile, trust=trust), rules)
    cases = tried = failed = 0
    for name in names:
        for outcome in try_rule(name, with_rules, cases_only):
            cases, tried = cases + outcome.is_case, tried + (not outcome.is_case)
            failed += bool(outcome.wrong)
            note = f" ({outcome.note})" if outcome.note else ""
            click.echo(f"{'FAILED' if outcome.wrong else 'ok':7} {outcome.rule}: {outcome.case}{note}")
            for line in outcome.wrong:
                click.echo(f"        {line}")
    comparisons = f" and {tried} comparisons" if tried else ""
    click.echo(f"{cases} cases{comparisons}, {failed} failed")
    return 1 if failed else 0
