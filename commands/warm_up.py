"""kerfwise warm-up: what plans need is compiled ahead."""

from __future__ import annotations

import click


@click.command()
def command() -> None:
    """Compile what plans need, so that the first one is as quick as all others: in an image, or before a batch.

    Once for each machine, version and processor; a second time it only says so. NUMBA_CACHE_DIR names the folder.
    """
    from kerfwise.jobs.warm_up import warm_up

    done = warm_up()
    where = f", kept in {done.folder}" if done.folder else ", and kept nowhere: NUMBA_CACHE_DIR names a folder"
    click.echo(f"{done.kernels} kernels compiled in {done.seconds:.0f} s{where}")
