"""kerfwise nest: parts with quantities become nests, sheet by sheet, checked before they are written."""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from kerfwise.app_modules import library
from kerfwise.commands.shared_options import (
    AMOUNT_OVER_ZERO,
    ANSWER,
    DATE,
    LANGUAGE,
    SET,
    TRUST,
    length_or_zero,
    print_note,
)
from kerfwise.commands.terminal import expect_printed, status_line
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.escape import escape_text
from kerfwise.encoder.files import is_there
from kerfwise.rules.profile.load import DEFAULT

from .find_nests import Watching

if TYPE_CHECKING:
    from kerfwise.rules.profile.profile import Profile

    from .find_nests import NestingResult
    from .nest_list import GroupRequest, ListRequest
    from .nests import Nested
    from .placement.layout import Layout
    from .programs import Programs


class NestProgress(Watching):
    """Told after each round; answers False once the user has pressed Ctrl-C. In a pipe it is silent."""

    def __init__(self) -> None:
        super().__init__(shown=status_line("laying parts"))

    def __call__(self, number: int, best: Layout) -> bool:
        """Show the best so far; whether to go on."""
        if self.shown is not None:
            spent = time.monotonic() - self.started
            line = f"{spent:5.1f} s  round {number}  {len(best.sheets)} sheets, {best.use:.1%} used"
            self.shown.update(f"{line}  (Ctrl-C keeps the best so far)")
        return super().__call__(number, best)

    def going(self, doing: str) -> bool:
        """Show what is being done; whether to go on."""
        if self.shown is not None:
            self.shown.update(f"{time.monotonic() - self.started:5.1f} s  {doing}  (Ctrl-C keeps the best so far)")
        return super().going(doing)


# What a person says of parts, sheets and how to lay them: the options of `nest` and `make`.

Verb = Callable[..., Any]

_OPTIONS = (
    click.option("--sheet", "sheets", metavar="WxH[=N]|FILE[=N]", multiple=True,
                 help="A sheet in mm, such as 3000x1500, and its stock, or a list of stock; repeatable."),
    click.option("--remnant", "remnants", metavar="FILE[=N]|WxH[=N]", multiple=True,
                 help="A remnant of any shape, used before sheets; repeatable."),
    click.option("-p", "--profile", "profiles", metavar="PROFILE", multiple=True,
                 help=f"Name or path; repeatable, for lists of several materials. Default: {DEFAULT}."),
    TRUST,
    SET,
    ANSWER,
    click.option("-o", "--output", metavar="DIR", help="Output folder of the nests."),
    DATE,
    click.option("--skip-bad", is_flag=True, help="Leave out parts that cannot be read or cut, each with its reason."),
    click.option("--name-pattern", metavar="PATTERN",
                 help="What names of files say: {part}_{quantity}x, {order}, {material}, {thickness}, * for the rest."),
    click.option("--gap", metavar="LENGTH", help="Gap between parts. Default: a kerf and the profile's nesting.web."),
    click.option("--edge", metavar="LENGTH", help="Distance to the sheet's edge. Default: the profile's nesting.edge."),
    click.option("--dxf", is_flag=True, help="Also write each nest as DXF."),
    click.option("--rounds", type=click.IntRange(1, 100_000), default=12, show_default=True, metavar="N",
                 help="Rounds to search, without --time-limit. The same number gives the same bytes."),
    click.option("--time-limit", "time_s", type=AMOUNT_OVER_ZERO, metavar="S",
                 help="Time limit of the search, in seconds."),
    click.option("--seed", type=click.IntRange(min=0), default=1, show_default=True, metavar="N",
                 help="Seed of the search."),
    click.option("--engine", type=click.Choice(["own", "pavlov", "sparrow"]), default="own", show_default=True,
                 help="pavlov: the least rectangle around all parts, blocks by the defining line, for small lists. "
                 "sparrow: make the best layout denser with spyrrow (pip install kerfwise[nest])."),
    click.option("--for", "purpose", type=click.Choice(["density", "cutting"]), default="density", show_default=True,
                 help="cutting: plan several layouts that use the sheets alike, and take the cheapest to cut."),
    click.option("--weigh", type=click.IntRange(1, 100), default=4, show_default=True, metavar="N",
                 help="Number of layouts to plan with --for cutting."),
    click.option("--weigh-work", type=AMOUNT_OVER_ZERO, default=2.0, show_default=True, metavar="W",
                 help="Work limit of each of these plans."),
    click.option("--units", metavar="UNIT", help="Unit of the drawings: mm, cm, m, in, ft, pt, px, or as 90dpi."),
    click.option("--repair", is_flag=True, help="Repair the drawings where possible, and report each repair."),
    click.argument("parts", metavar="PARTS…", nargs=-1, required=True),
)  # fmt: skip


def nest_options(verb: Verb) -> Verb:
    """Add PARTS and all that says how they are laid."""
    for add in reversed(_OPTIONS):
        verb = add(verb)
    return verb


def read_list_request(
    parts: tuple[str, ...],
    profiles: tuple[str, ...],
    output: str | None,
    gap: str | None,
    edge: str | None,
    answers: tuple[str, ...],
    **options: Any,
) -> tuple[ListRequest, Path]:
    """What is asked for, group by group, and the folder of the nests; the readers speak on standard error."""
    from kerfwise.encoder.questions import answers_of

    from .api import list_request
    from .nests import expect_folder

    if output is None:
        raise click.UsageError("Missing option '-o' / '--output'.")
    out = Path(output)
    expect_folder(out)
    for name, text in (("gap", gap), ("edge", edge)):
        options[f"{name}_mm"] = None if text is None else length_or_zero(f"--{name}", text)
    options["answers"] = dict(answers_of(answers))
    return list_request(parts, profiles or DEFAULT, print_note, **options), out


def looked_for(request: ListRequest) -> list[tuple[GroupRequest, NestingResult]]:
    """The nests: progress on a terminal, Ctrl-C that keeps the best so far, or says that nothing was laid."""
    from kerfwise.commands.progress import ProgressLine

    from .find_nests import NOTHING_LAID
    from .nest_list import nest_groups

    try:
        return nest_groups(request, NestProgress, lambda name: ProgressLine(), print_note)
    except KeyboardInterrupt:
        print_note(NOTHING_LAID)
        raise


def _end(request: ListRequest, out: Path, files: list[Path]) -> None:
    from .nest_list import left_out_text

    if request.bad:
        click.echo(left_out_text(request.bad))
    click.echo(f"written: {len(files)} files in {escape_text(str(out))}")


def _code(request: ListRequest, found: list[tuple[GroupRequest, NestingResult]], interrupted: bool) -> int:
    """The exit code: 130 after Ctrl-C, 1 where parts are missing or left out."""
    if interrupted or len(found) < len(request.groups):
        return 130
    return 1 if request.bad or any(any(result.nested.layout.missing) for _, result in found) else 0


def print_nests(nested: Nested, found: NestingResult, plant: Profile) -> None:
    """Print the table of the nests that are written, and what was weighed."""
    from .find_nests import weighed_lines
    from .nests import lines_of

    click.echo("\n".join([*lines_of(nested), *weighed_lines(found, plant)]))


def _schema(context: click.Context, option: click.Parameter, asked: bool) -> None:
    """Print the schema, and nothing else."""
    if not asked:
        return
    from .part_list import schema_text

    click.echo(schema_text(), nl=False)
    expect_printed()
    context.exit()


NEW_LIST = "new-list"


@click.command()
@nest_options
@click.option("--schema", is_flag=True, is_eager=True, expose_value=False, callback=_schema,
              help="Print the JSON Schema of lists of parts, for editors.")  # fmt: skip
@click.option("--picture", type=click.Choice(["svg", "png", "pdf"]), default="svg", show_default=True,
              help="Format of the pictures.")  # fmt: skip
def nest_command(dxf: bool, picture: str, **options: Any) -> int:
    """Lay PARTS, files with their quantities (bracket.dxf=12), folders or lists of parts, on sheets; remnants first.

    `kerfwise nest new-list -o parts.csv` writes a list to fill in, as CSV or XLSX.
    """
    if options["parts"] == (NEW_LIST,):
        return _new_list(options["output"])
    from .nest_list import write_list
    from .nests import nest_files

    request, out = read_list_request(**options)
    found = looked_for(request)
    files = [(one, result.nested, nest_files(result.nested, f".{picture}", dxf)) for one, result in found]
    written = write_list(out, request, files)
    for one, result in found:
        if head := request.head(one):
            click.echo(head)
        print_nests(result.nested, result, one.cutting.plant)
    _end(request, out, written)
    return _code(request, found, any(result.interrupted for _, result in found))


def _new_list(output: str | None) -> int:
    """Write a list of parts to fill in."""
    from kerfwise.postproc.output_files import expect_outputs, write_files

    from .tables import TEMPLATE, template_workbook

    path = Path(output or "parts.csv")
    if path.suffix.lower() not in (".csv", ".xlsx"):
        raise InputError(f"-o {path}: a list is a .csv or an .xlsx file")
    if is_there(path):
        raise InputError("is there already: remove it, or give another name with -o", file=path)
    expect_outputs([path], [])
    write_files({path: TEMPLATE if path.suffix.lower() == ".csv" else template_workbook()})
    click.echo(f"written: {escape_text(str(path))}")
    return 0


# kerfwise make: a list of parts to programs in one command: nest, plan, check, write.


@click.command()
@nest_options
@click.option("--work", type=AMOUNT_OVER_ZERO, default=30.0, show_default=True, metavar="W",
              help="Deterministic limit of each plan: the same work gives the same bytes.")  # fmt: skip
@click.option(
    "--relax", is_flag=True, help="If hard rules conflict, relax the cheapest ones and mark them in the plan."
)
@click.option("--picture", type=click.Choice(["svg", "png", "pdf"]), default="svg", show_default=True,
              help="Format of the pictures.")  # fmt: skip
@click.option(
    "--sheets",
    "papers",
    is_flag=True,
    help="Also print work sheets and labels: sheets.pdf and labels.pdf in each folder.",
)
@LANGUAGE
def make_command(dxf: bool, work: float, relax: bool, picture: str, papers: bool, language: str, **options: Any) -> int:
    """Lay PARTS on sheets, and write a checked program, plan and pictures for every sheet."""
    from kerfwise.commands.progress import ProgressLine

    from .nest_list import plant_of_sheet, write_list
    from .programs import labels_of, make_programs, work_sheets_of

    if papers:
        library("segno", "a work sheet", "sheets")
    request, out = read_list_request(**options)
    found = looked_for(request)
    files: list[tuple[GroupRequest, Nested, dict[str, str | bytes]]] = []
    programs: list[Programs] = []
    for one, result in found:
        made = make_programs(
            result.nested,
            partial(plant_of_sheet, request, one, out),
            work,
            relax,
            lambda name: ProgressLine(),
            options["skip_bad"],
        )
        programs.append(made)
        pages = (
            {"sheets.pdf": work_sheets_of(made, language), "labels.pdf": labels_of(made, language)} if papers else {}
        )
        files.append((one, made.nested, {**made.files(dxf, picture), **pages}))
        if made.interrupted:
            break
    written = write_list(out, request, files)
    for (one, result), made in zip(found, programs, strict=False):
        if head := request.head(one):
            click.echo(head)
        print_nests(made.nested, result, one.cutting.plant)
        click.echo("\n".join(made.told))
    _end(request, out, written)
    stopped = any(made.interrupted for made in programs) or any(result.interrupted for _, result in found)
    return _code(request, found, stopped) or int(any(made.unplanned for made in programs))
