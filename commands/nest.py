"""kerfwise nest: parts with quantities become nests, sheet by sheet, checked before they are written."""

from __future__ import annotations

from typing import Any

import click

from kerfwise.encoder.shown import shown

from .nest_options import looked_for, nest_options, read_asked, tell_found
from .terminal import expect_printed


def _schema(context: click.Context, option: click.Parameter, asked: bool) -> None:
    """Print the schema, and nothing else."""
    if not asked:
        return
    from kerfwise.jobs.nesting.schema import schema_text

    click.echo(schema_text(), nl=False)
    expect_printed()
    context.exit()


@click.command()
@nest_options
@click.option("--schema", is_flag=True, is_eager=True, expose_value=False, callback=_schema,
              help="Print the JSON Schema that editors complete lists of parts by.")  # fmt: skip
@click.option("--picture", type=click.Choice(["svg", "png", "pdf"]), default="svg", show_default=True,
              help="Of what kind the pictures are.")  # fmt: skip
def command(dxf: bool, picture: str, **options: Any) -> int:
    """Lay PARTS, files with their quantities (bracket.dxf=12) or lists of parts, on sheets; remnants first."""
    from kerfwise.jobs.nesting.files import nest_files, write_nests

    asked, out = read_asked(**options)
    found = looked_for(asked)
    files = nest_files(found.nested, f".{picture}", dxf)
    written = write_nests(out, found.nested, files, profile=asked.plant.name, seed=asked.effort.seed)
    tell_found(found.nested, found, asked.plant)
    click.echo(f"written: {len(written)} files in {shown(str(out))}")
    if found.interrupted:
        return 130
    return 1 if any(found.nested.layout.missing) else 0
