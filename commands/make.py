"""kerfwise make: a list of parts to programs in one command: nest, plan, check, write."""

from __future__ import annotations

from typing import Any

import click

from kerfwise.encoder.text import escape_text

from .nest import looked_for, nest_options, print_nests, read_nesting_request
from .shared_options import AMOUNT_OVER_ZERO


@click.command()
@nest_options
@click.option("--work", type=AMOUNT_OVER_ZERO, default=30.0, show_default=True, metavar="W",
              help="Deterministic limit of each plan: the same work gives the same bytes.")  # fmt: skip
@click.option(
    "--relax", is_flag=True, help="If hard rules conflict, relax the cheapest ones and mark them in the plan."
)
def command(dxf: bool, work: float, relax: bool, **options: Any) -> int:
    """Lay PARTS on sheets, and write a checked program, plan and pictures for every sheet."""
    from kerfwise.jobs.nesting.nests import write_nests
    from kerfwise.jobs.nesting.programs import make_programs

    from .progress import ProgressLine

    asked, out = read_nesting_request(**options)
    found = looked_for(asked)
    made = make_programs(found.nested, asked.plant, work, relax, lambda name: ProgressLine())
    written = write_nests(out, made.nested, made.files(dxf), profile=asked.plant.name, seed=asked.effort.seed)
    print_nests(made.nested, found, asked.plant)
    click.echo("\n".join(made.told))
    click.echo(f"written: {len(written)} files in {escape_text(str(out))}")
    if found.interrupted or made.interrupted:
        return 130
    return 1 if any(made.nested.layout.missing) else 0
