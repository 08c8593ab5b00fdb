"""kerfwise engines: what can be used to solve."""

from __future__ import annotations

import click


@click.command()
def command() -> None:
    """List the engines of `kerfwise solve --engine`, and the solvers that MiniZinc has on this machine."""
    from ..encoder.errors import InputError
    from ..models.minizinc.installation import installed_solvers

    click.echo("cp-sat      built in: search, proof by dynamic programming, CP-SAT")
    try:
        solvers = installed_solvers()
    except InputError as error:
        click.echo(f"minizinc    not usable: {error}")
        return
    for solver in solvers:
        click.echo(f"minizinc    --solver {solver.name:12} {solver.title} {solver.version}")
