"""kerfwise dialects: the languages of controls, one of them, and a plant's own to begin with."""

from __future__ import annotations

from pathlib import Path

import click

from kerfwise.encoder.errors import InputError


@click.group(invoke_without_command=True, subcommand_metavar="[show NAME | new NAME --like X]")
@click.pass_context
def command(ctx: click.Context) -> None:
    """List the dialects with their controls, processes, and the outside readers that agree with their programs.

    `kerfwise dialects new NAME --like X` writes a copy to edit, `kerfwise dialects show X` prints a dialect.
    """
    if ctx.invoked_subcommand is None:
        _list()


def _list() -> None:
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


@command.command()
@click.argument("name")
def show(name: str) -> None:
    """Print the file of dialect NAME."""
    from kerfwise.postproc.dialects import dialect_text

    click.echo(dialect_text(name), nl=False)


@command.command()
@click.argument("name")
@click.option("--like", required=True, metavar="X", help="The dialect to copy: a shipped one, or a file.")
@click.option("-o", "--output", metavar="OUT.yaml", help="Output file. Default: NAME.yaml.")
def new(name: str, like: str, output: str | None) -> None:
    """Write NAME.yaml, a copy of the dialect X to edit."""
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
    expect_outputs([path], [Path(like)])
    text = new_dialect_text(name, like)
    write_files({path: text})
    click.echo(f"{path} written; name it in a profile, machine: {{dialect: {path}}}, then: kerfwise profile check")
