"""kerfwise resequence: an old program, or a folder of them, in a better order."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from kerfwise import __version__
from kerfwise.commands.option_groups import limit_options, together
from kerfwise.commands.shared_options import TRUST, old_options, print_note, program_request
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.escape import escape_text
from kerfwise.encoder.files import is_folder
from kerfwise.rules.profile.load import DEFAULT, files_of

if TYPE_CHECKING:
    from kerfwise.models.engines.solution import Limits
    from kerfwise.rules.profile.profile import Profile

    from .resequence import Reordering


@click.command()
@old_options
@click.option("-p", "--profile", metavar="PROFILE", default=DEFAULT, show_default=True,
              help="Name or path of the profile; its dialect says which control the program is for.")  # fmt: skip
@TRUST
@together(
    "outputs",
    dict,
    click.option("-o", "--output", metavar="OUT", help="The new program, or for a folder the folder of the new ones."),
    click.option("--picture", metavar="OUT.svg|.png", help="Write a picture of both orders."),
    click.option("--plan", metavar="PLAN.json", help="Write the plan of the new program, if there is one."),
)
@click.option("--paths", type=click.Choice(["keep", "new"]), default="keep", show_default=True,
              help="Keep every burn, or plan all contours anew.")  # fmt: skip
@click.option("--without-rules", is_flag=True,
              help="If the burns do not show what they cut, order them by travel alone.")  # fmt: skip
@limit_options()
@click.option("--jobs", type=click.IntRange(min=1), default=1, show_default=True, metavar="N",
              help="Number of programs of a folder to plan at once.")  # fmt: skip
@click.argument("old", metavar="OLD.nc|DIR")
def command(
    old: str,
    profile: str,
    trust: bool,
    outputs: dict[str, Any],
    paths: Any,
    without_rules: bool,
    limits: Limits,
    jobs: int,
    **given: Any,
) -> int:
    """Re-order the burns of an old program, or plan its contours anew; or of all programs in a folder."""
    from kerfwise.commands.progress import ProgressLine
    from kerfwise.jobs.inputs import plant_of

    from .resequence import resequence

    plant, request = plant_of(profile, trust), program_request(**given)
    output, picture, plan_path = outputs["output"], outputs["picture"], outputs["plan"]
    how: Reordering = {**limits, "paths": paths, "request": request, "without_rules": without_rules}
    if is_folder(Path(old)):
        if picture or plan_path:
            raise InputError(f"{'--picture' if picture else '--plan'} is of one program: give one, not a folder")
        return _folder(Path(old), plant, output, jobs, how)
    file = Path(old)
    out = output or f"{file.stem}.resequenced{file.suffix or '.nc'}"
    _expect(plant, file, out, picture, plan_path)
    listener = ProgressLine()
    result = resequence(old, plant, listener, print_note, **how)
    files: dict[Path, str | bytes] = {Path(out): result.program}
    if picture:
        files[Path(picture)] = result.picture("png" if Path(picture).suffix.lower() == ".png" else "svg").content
    if plan_path and result.plan is not None:
        files[Path(plan_path)] = result.plan.to_json()
    elif plan_path:
        print_note(f"no plan is written: {result.ends if result.nest is not None else 'the burns make no nest'}")
    from kerfwise.postproc.output_files import write_files

    write_files(files)
    click.echo(result)
    click.echo("written: " + ", ".join(escape_text(str(path)) for path in files))
    return 130 if result.interrupted else 0


def _expect(plant: Profile, file: Path, out: str, picture: str | None, plan_path: str | None) -> None:
    """Say before the work what could not be written after it."""
    from kerfwise.postproc.output_files import expect_outputs
    from kerfwise.postproc.report.simple_pictures import expect_kind

    outputs = [Path(name) for name in (out, picture, plan_path) if name]
    expect_outputs(outputs, [file, *files_of(plant)])
    if picture:
        expect_kind(picture)


def _folder(folder: Path, plant: Profile, output: str | None, jobs: int, how: Reordering) -> int:
    from kerfwise.commands.crash_report import arguments, crash_message

    from .archive import resequence_folder

    if output is None:
        raise InputError("a folder of programs needs one for the new ones: give it with -o", file=folder)
    archive = resequence_folder(folder, Path(output), plant, jobs=jobs, version=__version__, tell=print_note, **how)
    click.echo(archive)
    for name, error in archive.faults.items():
        click.echo(f"{escape_text(name)}: {crash_message(error, arguments(None))}", err=True)
    return archive.exit_code
