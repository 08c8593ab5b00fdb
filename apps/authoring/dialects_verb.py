"""kerfwise dialects: the languages of controls, one of them, and a plant's own to begin with."""

from __future__ import annotations

from pathlib import Path

import click

from kerfwise.encoder.errors import InputError


@click.group(invoke_without_command=True, subcommand_metavar="[show NAME | new NAME --like X | --from OLD.nc]")
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
@click.option("--like", metavar="X", help="The dialect to copy: a shipped one, or a file.")
@click.option("--from", "programs", multiple=True, metavar="OLD.nc",
              help="A program that the plant's post printed; best two of different parts (repeat it).")  # fmt: skip
@click.option("-o", "--output", metavar="OUT.yaml", help="Output file. Default: NAME.yaml.")
@click.argument("more", nargs=-1, metavar="[OLD2.nc]...")
def new(name: str, like: str | None, programs: tuple[str, ...], output: str | None, more: tuple[str, ...]) -> None:
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
