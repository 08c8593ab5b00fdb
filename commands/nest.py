"""kerfwise nest: parts with quantities become nests, sheet by sheet, checked before they are written."""

from __future__ import annotations

from typing import Any

import click

from kerfwise.encoder.shown import shown

from .nest_options import looked_for, nest_options, read_asked, tell_found


@click.command()
@nest_options
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
