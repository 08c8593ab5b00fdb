"""kerfwise engines: what can be used to solve; kerfwise warm-up: what of it is compiled, ahead."""

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


@click.command()
def warm_up_command() -> None:
    """Compile what plans need, so that the first one is as quick as all others: in an image, or before a batch.

    Once for each machine, version and processor; a second time it only says so. NUMBA_CACHE_DIR names the folder.
    """
    from kerfwise.jobs.warm_up import warm_up

    done = warm_up()
    where = f", kept in {done.folder}" if done.folder else ", and kept nowhere: NUMBA_CACHE_DIR names a folder"
    click.echo(f"{done.kernels} kernels compiled in {done.seconds:.0f} s{where}")
