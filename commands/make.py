"""kerfwise make: a list of parts to programs in one command: nest, plan, check, write."""

from __future__ import annotations

from typing import Any

import click

from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.shown import shown

from .nest_options import find_nests, nest_options, read_asked, tell_found
from .numbers import AMOUNT_OVER_ZERO


@click.command()
@nest_options
@click.option("--work", type=AMOUNT_OVER_ZERO, default=30.0, show_default=True, metavar="W",
              help="Limit of the plan of each sheet. The same work gives the same bytes, on each machine.")  # fmt: skip
@click.option("--relax", is_flag=True, help="Where hard rules clash, take the cheapest way out, marked in the plan.")
def command(dxf: bool, purpose: str, weigh: int, weigh_work: float, work: float, relax: bool, **options: Any) -> int:
    """Lay PARTS on sheets, and turn every sheet into a checked program with its plan and pictures."""
    from kerfwise.jobs.nesting.files import nest_files, write_nests
    from kerfwise.jobs.nesting.programs import plan_sheet, plan_text, program_files

    from .progress import ProgressLine

    asked = read_asked(**options)
    found = find_nests(asked, purpose, weigh, weigh_work)
    nested, interrupted = found.nested, found.interrupted
    files = nest_files(nested, ".nest.svg", dxf)
    told = []
    for name, text in zip(nested.names, nested.texts, strict=True):
        listener = ProgressLine()
        try:
            done = plan_sheet(name, text, asked.plant, work, relax=relax, listener=listener)
        except RulesConflict as error:
            raise RulesConflict(f"{name}: {error.message}; nothing was written", error.reasons) from error
        interrupted = interrupted or listener.interrupted
        files |= program_files(name, done)
        told.append(plan_text(name, done))
    written = write_nests(asked.out, nested, files, profile=asked.plant.name, seed=asked.effort.seed)
    tell_found(found, asked.plant)
    click.echo("\n".join(told))
    click.echo(f"written: {len(written)} files in {shown(str(asked.out))}")
    if interrupted:
        return 130
    return 1 if any(nested.layout.missing) else 0
