"""kerfwise edit: a nest with parts dropped, moved, turned, added or laid anew, or on another sheet."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from kerfwise.commands.option_groups import together
from kerfwise.commands.shared_options import (
    input_options,
    length_or_zero,
    print_note,
    protect,
    read_inputs,
    reading_of,
    size_of,
)
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.escape import escape_text
from kerfwise.encoder.files import is_file

if TYPE_CHECKING:
    from kerfwise.encoder.readers.options import ReadOptions
    from kerfwise.jobs.inputs import Inputs

    from .edited_nest import EditedNest
    from .edits import Edit


SEVERAL = ("--keep", "--drop", "--mirror", "--fix")
"""Options that take several parts."""


class _SeveralParts(click.Command):
    """A command whose options of SEVERAL may have several parts behind them, as `--keep P1 P2`."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        told = list[str]()
        option, nest_named = "", bool(args) and not args[0].startswith("-")
        for k, word in enumerate(args):
            if word.startswith("-"):
                option = word if word in SEVERAL else ""
            elif option and told[-1] != option and (nest_named or k + 1 < len(args)):
                told.append(option)
            told.append(word)
        return super().parse_args(ctx, told)


@click.command(cls=_SeveralParts)
@input_options
@together(
    "changes",
    dict,
    click.option("--keep", multiple=True, metavar="PART…", help="Leave out all parts but these."),
    click.option("--drop", multiple=True, metavar="PART…", help="Leave out parts."),
    click.option("--turn", type=(str, float), multiple=True, metavar="PART DEG",
                 help="Turn a part counter-clockwise about its middle; repeatable."),
    click.option("--mirror", multiple=True, metavar="PART…", help="Turn parts over, left to right."),
    click.option("--move", type=(str, float, float), multiple=True, metavar="PART DX DY",
                 help="Move a part; repeatable."),
    click.option("--add", multiple=True, metavar="FILE[=N]", help="Lay parts into free room; repeatable."),
    click.option("--nest-anew", is_flag=True, help="Lay all parts anew, but those of --fix."),
    click.option("--fix", multiple=True, metavar="PART…", help="With --nest-anew, parts that stay."),
)  # fmt: skip
@click.option("--gap", metavar="LENGTH", help="Gap between parts. Default: a kerf and the profile's nesting.web.")
@click.option("--edge", metavar="LENGTH", help="Distance to the sheet's edge. Default: the profile's nesting.edge.")
@click.option("--lock-from", metavar="OLD", help="A plan or program of the nest that is cut already: its parts stay.")
@click.option("--upto", type=click.IntRange(min=1), metavar="N", help="With --lock-from, its last finished cut.")
@click.option("-o", "--output", metavar="NEW.json", required=True, help="Output file.")
def command(
    changes: dict[str, Any],
    gap: str | None,
    edge: str | None,
    lock_from: str | None,
    upto: int | None,
    output: str,
    **options: Any,
) -> int:
    """Change NEST: leave parts out, turn, mirror and move them, put another --sheet under it, add parts, in this order.

    Parts keep the profile's gap; collisions are named, and nothing is written then. What is cut already stays. Parts
    off another sheet, and scrap lines that parts are in the way of, are left out and named; exit code 1.
    """
    from .edited_nest import contours_cut, editing

    if changes["fix"] and not changes["nest_anew"]:
        raise click.UsageError("--fix is for --nest-anew")
    path = Path(output)
    if path.suffix.lower() != ".json":
        raise InputError("an edited nest is JSON: give a name ending in .json", file=path)
    sheet, options["sheet"] = options["sheet"], None
    inputs = read_inputs(**options, last=lock_from)
    protect(inputs, options["nest"], [path], lock_from)
    edits = _edits(changes, sheet, reading_of(inputs, options))
    gap_mm = None if gap is None else length_or_zero("--gap", gap)
    edge_mm = None if edge is None else length_or_zero("--edge", edge)
    if upto is not None and lock_from is None:
        raise click.UsageError("--upto is for --lock-from")
    cut = contours_cut(inputs, options["nest"], lock_from, upto, print_note)
    edited = editing(inputs.nest, inputs.profile, gap_mm=gap_mm, edge_mm=edge_mm, cut=cut).do(*edits)
    return _write(edited, inputs, path)


def _edits(changes: Mapping[str, Any], sheet: str | None, reading: ReadOptions) -> list[Edit]:
    """The changes in the order in which they are made; `reading`: how drawings of parts to add are read."""
    from kerfwise.encoder.nest import Sheet

    from .edits import Drop, Keep, Mirror, Move, NestAnew, OtherSheet, Turn, added

    edits: list[Edit] = [Keep(changes["keep"])] if changes["keep"] else []
    edits += [Drop(changes["drop"])] if changes["drop"] else []
    edits += [Turn(part, degrees) for part, degrees in changes["turn"]]
    edits += [Mirror(part) for part in changes["mirror"]]
    edits += [Move(part, dx, dy) for part, dx, dy in changes["move"]]
    edits += [OtherSheet(Sheet.rectangle(*size_of(sheet)))] if sheet else []
    edits += [added(text, reading, print_note) for text in changes["add"]]
    edits += [NestAnew(changes["fix"])] if changes["nest_anew"] else []
    if not edits:
        raise click.UsageError(
            "say what changes: --drop, --keep, --turn, --mirror, --move, --sheet, --add, --nest-anew"
        )
    return edits


def _write(edited: EditedNest, inputs: Inputs, path: Path) -> int:
    """Write the nest, and its job file where the old nest has one that fits; say what it has."""
    from kerfwise.jobs.nest_job.job import beside_name
    from kerfwise.postproc.output_files import write_files

    from .edits import job_text_for

    files: dict[Path, str | bytes] = {path: edited.text()}
    beside = path.with_name(beside_name(path))
    if inputs.job is not None and not is_file(beside):
        try:
            files[beside], left_out = job_text_for(inputs.job, edited.named_as_before, beside)
            for why in left_out:
                print_note(f"the job file {inputs.job.name} is copied without a lock: {why}")
        except InputError as error:
            print_note(f"the job file {inputs.job.name} is not copied: {error.message}")
    write_files(files)
    click.echo(str(edited))
    click.echo(f"written: {', '.join(escape_text(str(file)) for file in files)}")
    return 1 if edited.off or edited.scrap_left_out else 0
