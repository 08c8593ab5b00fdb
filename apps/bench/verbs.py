"""kerfwise bench: engines measured on nests and on the field's routing instances."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from kerfwise.commands.option_groups import time_and_work, together
from kerfwise.commands.shared_options import MEMORY, TRUST, EngineChoice
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.files import is_file, is_folder
from kerfwise.models.engines import BUILT_IN


@click.command()
@click.argument("files", nargs=-1, required=True, metavar="FILES…")
@click.option("--engine", "engines", type=EngineChoice(BUILT_IN), multiple=True, default=("portfolio",),
              show_default=True, help="Repeatable: each runs on every file.")  # fmt: skip
@together("limits", dict, *time_and_work("of each run"), MEMORY)
@click.option("--seed", "seeds", type=click.IntRange(min=0), multiple=True, default=(1,), show_default=True,
              help="Repeatable.")  # fmt: skip
@click.option(
    "--best-known", metavar="CSV", help="Columns instance, best_upper and, where names repeat, set (a folder)."
)
@click.option("-p", "--profile", default="", metavar="PROFILE", help="For nests: name or path of a profile.")
@TRUST
@click.option("--json", "as_list", is_flag=True, help="Print a JSON list instead of a table.")
def command(
    files: tuple[str, ...],
    engines: tuple[Any, ...],
    limits: dict[str, Any],
    seeds: tuple[int, ...],
    best_known: str | None,
    profile: str,
    trust: bool,
    as_list: bool,
) -> int:
    """Run engines on FILES: routing instances (.pcglns, .sop, also with .gz) and nests (.json, .dxf, .svg).

    Separate code judges every tour. Each run is a separate process; its clock starts when the file is read and the
    compiled kernels are loaded. A file that cannot be read is named, and the others are run.
    """
    from .bench import BenchJob, head, line, measure, read_best_known, results_as_json, results_in_all

    for file in files:
        _expect(Path(file))
    best = read_best_known(best_known) if best_known else None
    jobs = [
        BenchJob(file, engine, seed, profile=profile, trust=trust, **limits)
        for file in files
        for engine in engines
        for seed in seeds
    ]
    results, bests = [], []
    broken = interrupted = False
    if not as_list:
        click.echo(head())
    try:
        for job in jobs:
            try:
                results.append(measure(job))
            except InputError as error:
                broken = True
                click.echo(f"kerfwise: {error}", err=True)
                continue
            bests.append(best.of(job.path) if best else None)
            if not as_list:
                click.echo(line(results[-1], bests[-1]))
    except KeyboardInterrupt:
        interrupted = True
    click.echo(results_as_json(results) if as_list else results_in_all(results, bests))
    if bests and best and not any(found is not None for found in bests):
        click.echo("note: --best-known has no costs for these instances (its sets are names of folders)", err=True)
    if interrupted:
        return 130
    if broken:
        return 2
    return 0 if all(result.feasible for result in results) else 1


def _expect(file: Path) -> None:
    from kerfwise.encoder.readers.read import SUFFIXES
    from kerfwise.models.routing import KINDS, is_instance

    if is_folder(file):
        raise InputError("this is a folder; name the files in it, such as folder/*.sop", file=file)
    if not is_file(file):
        raise InputError("there is no such file", file=file)
    if not is_instance(file) and file.suffix.lower() not in SUFFIXES:
        raise InputError(f"cannot be run: expected a file of {', '.join((*KINDS, *SUFFIXES))}", file=file)
