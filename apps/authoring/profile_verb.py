"""kerfwise profile: check one, show it with nothing left implicit, hold two against each other, or begin one."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Mapping, Sequence
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
def command() -> None:
    """Check a profile (name or path), print it in full, compare two, create one, or print the schema of profiles."""


@command.command()
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


@command.command()
@click.argument("profile", metavar="[PROFILE]", required=False)
@click.option("--sources", is_flag=True, help="Say of each value where it is from: file and line.")
@click.option("--job", metavar="JOB", help="Apply this job file; PROFILE may then be the one that it names.")
@SET
@LOCK
@TRUST
def show(
    profile: str | None, sources: bool, job: str | None, settings: Sequence[str], lock: Sequence[str], trust: bool
) -> None:
    """Print PROFILE as YAML with every default filled in, and with the values of a job file, --set and --lock."""
    from kerfwise.jobs.nest_job.request import job_for, profile_for, profile_with_locks

    if profile is None and job is None:
        raise click.UsageError("Missing argument 'PROFILE', or --job JOB.")
    request = nest_request(profile, job, job is None, settings, lock)
    read = job_for("", request.job, print_note)
    loaded = profile_for(request, read, print_note, lambda named: load_profile(str(named), trust=trust))
    click.echo(profile_yaml(profile_with_locks(loaded, request, read), sources), nl=False)
    expect_printed()


@command.command()
@click.argument("profile", metavar="[PROFILE]", default=DEFAULT)
@TRUST
def schema(profile: str, trust: bool) -> None:
    """Print the JSON Schema of profiles, for editors, with the rules of PROFILE and of packages."""
    from kerfwise.rules.profile.schema import schema_text

    click.echo(schema_text(load_profile(profile, trust=trust).known_rules()), nl=False)
    expect_printed()


@command.command()
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


@command.command()
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


@command.command()
@click.argument("name", metavar="NAME")
@click.option("--like", metavar="PROFILE", help="The profile to copy: a shipped one, or a file. Asks no questions.")
@click.option("-o", "--output", metavar="OUT.yaml", help="Output file. Default: NAME.yaml.")
@TRUST
def new(name: str, like: str | None, output: str | None, trust: bool) -> None:
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
