"""kerfwise make: a list of parts to programs in one command: nest, plan, check, write."""

from __future__ import annotations

from typing import Any

import click

from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.shown import shown

from .nest_options import looked_for, nest_options, read_asked, tell_found
from .numbers import AMOUNT_OVER_ZERO


@click.command()
@nest_options
@click.option("--work", type=AMOUNT_OVER_ZERO, default=30.0, show_default=True, metavar="W",
              help="Limit of the plan of each sheet. The same work gives the same bytes, on each machine.")  # fmt: skip
@click.option("--relax", is_flag=True, help="Where hard rules clash, take the cheapest way out, marked in the plan.")
def command(dxf: bool, work: float, relax: bool, **options: Any) -> int:
    """Lay PARTS on sheets, and turn every sheet into a checked program with its plan and pictures."""
    from kerfwise.jobs.nesting.files import nest_files, write_nests
    from kerfwise.jobs.nesting.programs import plan_text, program_files
    from kerfwise.jobs.nesting.repair import planned

    from .progress import ProgressLine

    asked, out = read_asked(**options)
    found = looked_for(asked)
    nested, interrupted, told = found.nested, found.interrupted, list[str]()
    programs: dict[str, str | bytes] = {}
    for number, name in enumerate(nested.names):
        heard: list[ProgressLine] = []

        def listener(name: str) -> ProgressLine:
            heard.append(ProgressLine())  # noqa: B023 - called in this round only
            return heard[-1]  # noqa: B023

        try:
            nested, done, how = planned(nested, number, asked.plant, work, listener, relax)
        except RulesConflict as error:
            raise RulesConflict(f"{name}: {error.message}; nothing was written", error.reasons) from error
        interrupted = interrupted or any(line.interrupted for line in heard)
        programs |= program_files(name, done)
        told += [plan_text(name, done), *([how] if how else [])]
    files = nest_files(nested, ".nest.svg", dxf) | programs
    written = write_nests(out, nested, files, profile=asked.plant.name, seed=asked.effort.seed)
    tell_found(nested, found, asked.plant)
    click.echo("\n".join(told))
    click.echo(f"written: {len(written)} files in {shown(str(out))}")
    if interrupted:
        return 130
    return 1 if any(nested.layout.missing) else 0
