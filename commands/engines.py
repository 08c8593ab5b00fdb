"""kerfwise engines: what can be used to solve."""

from __future__ import annotations

import click


@click.command()
def command() -> None:
    """List the engines of `kerfwise solve --engine`, and the solvers that MiniZinc has on this machine."""
    from kerfwise.encoder.errors import InputError
    from kerfwise.models.engines import BUILT_IN, ENGINES
    from kerfwise.rules.minizinc.installation import installed_solvers

    for engine in BUILT_IN:
        click.echo(f"{engine:14}{ENGINES[engine]}")
    try:
        solvers = installed_solvers()
    except InputError as error:
        click.echo(f"minizinc      not usable: {error}")
        return
    for solver in solvers:
        click.echo(f"minizinc      --solver {solver.name:12} {solver.title} {solver.version}")
