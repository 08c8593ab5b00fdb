"""kerfwise profile, rules and dialects: a plant's own checked, shown, compared, tried, or begun."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from kerfwise.commands.shared_options import LOCK, SET, TRUST, nest_request, print_note
from kerfwise.commands.terminal import expect_printed
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nearest_name import unknown
from kerfwise.rules.profile.load import DEFAULT, load_profile
from kerfwise.rules.profile.profile_yaml import Provenance, profile_yaml

if TYPE_CHECKING:
    from kerfwise.rules.profile.profile import Profile


_YAML = (".yaml", ".yml")


@click.group()
def profile_command() -> None:
    """Check a profile (name or path), print it in full, compare two, create one, or print the schema of profiles."""


@profile_command.command()
@click.argument("profile", metavar="PROFILE")
@TRUST
def check(profile: str, trust: bool) -> None:
    """Validate PROFILE; report every error with its place, and options that have no effect.

    What solve would refuse of a profile, whatever the nest, is refused here, too; model files are compiled.
    """
    from kerfwise.jobs.nest_job.request import locks_told

    from .profile_check import checked, notes

    loaded = checked(profile, trust)
    strengths = [setting.strength for setting in loaded.settings().values()]
    hard, soft = strengths.count("hard"), strengths.count("soft")
    click.echo(f"{loaded.name}: fine, {hard} hard and {soft} soft rules")
    for text in Provenance(loaded).charted():
        click.echo(f"  {text}")
    for text in (*loaded.chart_notes(), *loaded.time_and_price_notes(), *notes(loaded), locks_told(loaded)):
        if text:
            print_note(text)


@profile_command.command("show")
@click.argument("profile", metavar="[PROFILE]", required=False)
@click.option("--sources", is_flag=True, help="Say of each value where it is from: file and line.")
@click.option("--job", metavar="JOB", help="Apply this job file; PROFILE may then be the one that it names.")
@SET
@LOCK
@TRUST
def profile_show(
    profile: str | None, sources: bool, job: str | None, settings: Sequence[str], lock: Sequence[str], trust: bool
) -> None:
    """Print PROFILE as YAML with every default filled in, and with the values of a job file, --set and --lock."""
    from kerfwise.jobs.nest_job.request import job_for, profile_for, profile_with_locks

    if profile is None and job is None:
        raise click.UsageError("Missing argument 'PROFILE', or --job JOB.")
    request = replace(nest_request(profile, job, job is None, settings, lock), trust=trust)
    read = job_for("", request.job, print_note)
    loaded = profile_for(request, read, print_note)
    click.echo(profile_yaml(profile_with_locks(loaded, request, read), sources), nl=False)
    expect_printed()


@profile_command.command()
@click.argument("profile", metavar="[PROFILE]", default=DEFAULT)
@TRUST
def schema(profile: str, trust: bool) -> None:
    """Print the JSON Schema of profiles, for editors, with the rules of PROFILE and of packages."""
    from kerfwise.rules.profile.schema import schema_text

    click.echo(schema_text(load_profile(profile, trust=trust).known_rules()), nl=False)
    expect_printed()


@profile_command.command()
@click.argument("a", metavar="A")
@click.argument("b", metavar="B")
@click.option("--sources", is_flag=True, help="Say of each value where it is from: file and line.")
@click.option("--json", "as_json", is_flag=True, help="Print key, a, b, a_from and b_from of each, as JSON.")
@TRUST
def diff(a: str, b: str, sources: bool, as_json: bool, trust: bool) -> None:
    """Print every key whose value differs between the profiles A and B."""
    from kerfwise.encoder.display import align_columns
    from kerfwise.rules.profile.profile_yaml import differences

    found = differences(load_profile(a, trust=trust), load_profile(b, trust=trust))
    if as_json:
        rows = [{name: getattr(one, name) for name in one.__slots__} for one in found]
        click.echo(json.dumps(rows, ensure_ascii=False))
    elif not found:
        click.echo("the same in every key")
    else:
        more = [(one.a_from, one.b_from) if sources else () for one in found]
        head = ("key", "A", "B", *(("A from", "B from") if sources else ()))
        lines = align_columns([head, *((one.key, one.a, one.b, *row) for one, row in zip(found, more, strict=True))])
        click.echo("\n".join(lines))
    expect_printed()


@profile_command.command()
@click.argument("name", metavar="[CHART]", required=False)
@click.option("-o", "--output", metavar="MACHINE_material.cfg", help="Write it as QtPlasmaC's material file, in mm.")
def chart(name: str | None, output: str | None) -> None:
    """List the cut charts that come with kerfwise, or print one, or a chart of a file: starting values with sources.

    A profile takes the row of its material and thickness: material: {chart: plasma-air, name: S235, thickness: 8 mm}.
    """
    from kerfwise.encoder.files import read_limited
    from kerfwise.postproc.output_files import expect_outputs, write_files
    from kerfwise.rules.charts import qtplasmac_text, read_chart, shipped_charts

    shipped = shipped_charts()
    if name is None:
        for known, path in shipped.items():
            rows = read_chart(path).rows
            sources = ", ".join(dict.fromkeys(str(row.values.get("source", "")) for row in rows))
            click.echo(f"{known}: {len(rows)} rows, starting values of {sources}")
        return
    if name not in shipped and not Path(name).suffix:
        raise InputError(unknown("chart", name, shipped))
    loaded = read_chart(shipped.get(name, Path(name)))
    if output is None:
        click.echo(read_limited(loaded.file).decode("utf-8-sig"), nl=False)
        return
    if Path(output).suffix != ".cfg":
        raise InputError("QtPlasmaC's material file is called MACHINE_material.cfg", file=output)
    expect_outputs([Path(output)], [Path(loaded.file)])
    write_files({Path(output): qtplasmac_text(loaded)})
    click.echo(f"written: {output}")


@profile_command.command("new")
@click.argument("name", metavar="NAME")
@click.option("--like", metavar="PROFILE", help="The profile to copy: a shipped one, or a file. Asks no questions.")
@click.option("-o", "--output", metavar="OUT.yaml", help="Output file. Default: NAME.yaml.")
@TRUST
def profile_new(name: str, like: str | None, output: str | None, trust: bool) -> None:
    """Write a new profile NAME.yaml: by questions on a terminal, or as a copy of another.

    NAME may be a path, such as plants/laser-2.yaml: the profile is then named after its file. Comments of the profile
    that it copies are kept.
    """
    from kerfwise.postproc.output_files import expect_outputs, write_files

    from .profile_check import expect_usable, new_profile_text

    bare = name if Path(name).suffix in _YAML else f"{name}.yaml"
    if output is None:  # a file may be named, too
        name = Path(bare).stem
    path = Path(output or bare)
    new_profile_text(name, DEFAULT)  # a name that no profile can have is refused first
    if path.suffix not in _YAML:
        raise InputError("a profile's file ends in .yaml", file=path)
    expect_outputs([path], [Path(like)] if like else [])
    if path.exists():
        raise InputError("the file is there already: nothing is written", file=path)
    if like is None:
        if not sys.stdin.isatty():
            raise click.UsageError("there is no terminal to ask on: say --like PROFILE")
        like, answers = _asked(trust)
    else:
        answers = {}
    text = new_profile_text(name, like, answers, path.parent)
    expect_usable(text, path, trust)
    write_files({path: text})
    click.echo(f"{path} written, and fine; next: kerfwise solve NEST -p {path}")


def _asked(trust: bool) -> tuple[str, Mapping[tuple[str, str], str]]:
    """The profile to begin from, and the answers that differ from what it says."""
    from kerfwise.rules.profile.load import shipped_profiles

    from .profile_check import questions

    for name in shipped_profiles():
        loaded = load_profile(name)
        material = loaded.material
        click.echo(f"  {name:22}{loaded.machine.process}, {material.name}, {material.thickness_mm:g} mm")
    like: str = click.prompt("begin from which of these, or which file", default=DEFAULT)
    base: Profile = load_profile(like, trust=trust)
    answers = {}
    for question in questions(base):
        answer: str = click.prompt(question.text, default=question.default, value_proc=_asking_again(question.answered))
        if answer != question.default:
            answers[question.key] = answer
    return like, answers


def _asking_again(read: Callable[[str], str]) -> Callable[[str], str]:
    """A wrong answer is said, and asked for again."""

    def answered(text: str) -> str:
        try:
            return read(text)
        except InputError as error:
            raise click.UsageError(error.message) from None

    return answered


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
def rules_command(ctx: click.Context, texts: bool, profile: str, trust: bool) -> None:
    """List the rules with the strength the profile gives them, or print the page of RULE.

    `kerfwise rules RULE --picture OUT.svg` draws its cases, `kerfwise rules new NAME` writes a new rule,
    `kerfwise rules test [RULE]` runs the cases.
    """
    if ctx.invoked_subcommand is None and texts:
        from kerfwise.rules.pages import texts_page

        click.echo(texts_page(), nl=False)
    elif ctx.invoked_subcommand is None:
        _list_rules(profile, trust)


def _list_rules(profile: str, trust: bool) -> None:
    from kerfwise.rules.pages import rule_table

    loaded = load_profile(profile, trust=trust)
    for row in rule_table(loaded):
        click.echo(f"{row.id:26}{_strength(row.strength, row.weight):14}{row.sentence}{row.from_where}")


def _strength(strength: str, weight: float | None) -> str:
    return strength if weight is None else f"soft {weight:g} mm"


@rules_command.command(hidden=True)
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


@rules_command.command("new")
@click.argument("name")
@click.option("--python", "language", flag_value="python", help="Write one Python file with the rule and its cases.")
@click.option("--mzn", "language", flag_value="mzn", help="Write one MiniZinc file with the rule and its cases.")
@click.option(
    "-o", "folder", metavar="FOLDER", type=click.Path(path_type=Path), help="Output folder. Default: the current one."
)
@click.option("--into", metavar="DIR", type=click.Path(path_type=Path), help="The source checkout, if not this one.")
@click.option("--like", metavar="SHIPPED", help="Copy the MiniZinc text of that shipped rule; NAME may be its own.")
def rules_new(name: str, language: str | None, folder: Path | None, into: Path | None, like: str | None) -> None:
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


@rules_command.command()
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


@click.group(invoke_without_command=True, subcommand_metavar="[show NAME | new NAME --like X | --from OLD.nc]")
@click.pass_context
def dialects_command(ctx: click.Context) -> None:
    """List the dialects with their controls, processes, and the outside readers that agree with their programs.

    `kerfwise dialects new NAME --like X` writes a copy to edit, `kerfwise dialects show X` prints a dialect.
    """
    if ctx.invoked_subcommand is None:
        _list_dialects()


def _list_dialects() -> None:
    from kerfwise.postproc.dialects import dialect_names, load_dialect

    for name in dialect_names():
        dialect = load_dialect(name)
        click.echo(
            f"{name:20}{dialect.title}: {', '.join(dialect.processes)}; marks {'yes' if dialect.marks else 'no'}"
        )
        for reader in dialect.verified_by:
            click.echo(f"{'':20}  read back by {reader}")
        if not dialect.verified_by:
            click.echo(f"{'':20}  not verified by any reader but the check's own, nor on a control")
    click.echo(f"{'DXF':20}the torch's paths as a drawing, a polyline a cut, in order: kerfwise solve … --dxf OUT.dxf")
    click.echo(f"{'':20}  read back by GDAL (pyogrio)")


@dialects_command.command("show")
@click.argument("name")
def dialects_show(name: str) -> None:
    """Print the file of dialect NAME."""
    from kerfwise.postproc.dialects import dialect_text

    click.echo(dialect_text(name), nl=False)


@dialects_command.command("new")
@click.argument("name")
@click.option("--like", metavar="X", help="The dialect to copy: a shipped one, or a file.")
@click.option("--from", "programs", multiple=True, metavar="OLD.nc",
              help="A program that the plant's post printed; best two of different parts (repeat it).")  # fmt: skip
@click.option("-o", "--output", metavar="OUT.yaml", help="Output file. Default: NAME.yaml.")
@click.argument("more", nargs=-1, metavar="[OLD2.nc]...")
def dialects_new(
    name: str, like: str | None, programs: tuple[str, ...], output: str | None, more: tuple[str, ...]
) -> None:
    """Write NAME.yaml: a copy of the dialect X to edit, or what is told from old programs, and what is not."""
    from kerfwise.postproc.dialects import dialect_names
    from kerfwise.postproc.dialects.load import new_dialect_text
    from kerfwise.postproc.output_files import expect_outputs, write_files

    if name in dialect_names():
        raise InputError(f"{name} is the name of a dialect that comes with kerfwise: choose another")
    path = Path(output or f"{name}.yaml")
    if path.suffix not in (".yaml", ".yml"):
        raise InputError("a dialect's file ends in .yaml", file=str(path))
    if path.exists():
        raise InputError("the file is there already: nothing is written", file=str(path))
    if more and not programs:
        raise click.UsageError(f"{more[0]}: expected --from before the first program")
    if not programs and like is None:
        raise click.UsageError("expected --like X, a dialect to copy, or --from OLD.nc, a program to tell one from")
    expect_outputs([path], [Path(old) for old in (*programs, *more, *([like] if like else []))])
    text = _told(name, (*programs, *more), like) if programs else new_dialect_text(name, like or "")
    write_files({path: text})
    for row in text.split("\n") if programs else ():
        if row.startswith("# "):
            click.echo(row.removeprefix("# "))
    click.echo(f"{path} written; name it in a profile, machine: {{dialect: {path}}}, then: kerfwise profile check")


def _told(name: str, programs: tuple[str, ...], like: str | None) -> str:
    """The dialect that is told from old programs."""
    from kerfwise.jobs.inputs import program_text

    from .proposed_dialect import propose_dialect, try_proposal

    proposal = propose_dialect([program_text(old) for old in programs], like)
    return try_proposal(proposal, name, [Path(old).name for old in programs])
