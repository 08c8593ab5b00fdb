"""kerfwise pareto: idle travel against overheats, each point a plan."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import click

from kerfwise.encoder.errors import InputError
from kerfwise.jobs.prices import PRICES_MM

from .given import given_options, note_placing, protect, read_given
from .numbers import AMOUNT, AMOUNT_OVER_ZERO


@click.command()
@given_options
@click.option("--price", "prices", type=AMOUNT, multiple=True, default=PRICES_MM, show_default=True,
              help="Cost of an overheat in mm of idle travel; may be given more than once.")  # fmt: skip
@click.option(
    "--work",
    type=AMOUNT_OVER_ZERO,
    default=10.0,
    show_default=True,
    help="Limit of each plan, the same on each machine.",
)
@click.option("--seed", type=click.IntRange(min=0), default=1, show_default=True, help="Seed of the search.")
@click.option("-o", "--output", metavar="FRONT.png", help="The plot. If no output is named: NEST.pareto.png.")
@click.option("--plans", metavar="DIR", help="Folder for the plan and program of every point: NEST.pareto.")
@click.option("--json", "as_json", is_flag=True, help="Print the table as JSON.")
def command(
    prices: tuple[float, ...],
    work: float,
    seed: int,
    output: str | None,
    plans: str | None,
    as_json: bool,
    **options: Any,
) -> int:
    """Plan NEST at several prices of an overheat, simulate every plan, and say which are worth choosing from."""
    if output and Path(output).suffix.lower() != ".png":
        raise InputError(f"cannot plot as {Path(output).suffix or output!r}: give a name ending in .png")
    if output is plans is None:
        stem = Path(options["nest"]).stem
        output, plans = f"{stem}.pareto.png", f"{stem}.pareto"
    from kerfwise.jobs.solve_options import options_for
    from kerfwise.jobs.trade_off import trade_off
    from kerfwise.postproc.files import expect_folders, expect_place, make_folder, write_files

    from .progress import ProgressLine

    if output:
        expect_folders([Path(output)])
    if plans:
        expect_place(Path(plans))
    given = read_given(**options)
    protect(given, options["nest"], [output])
    note_placing(given)
    limits = options_for(given.nest, given.profile, work=work, seed=seed)
    offer = trade_off(given, prices, limits, ProgressLine, Path(options["nest"]).name)
    if offer.refused is not None:
        click.echo(f"kerfwise: {offer.refused}", err=True)
    files: dict[Path, str | bytes] = {}
    if plans:
        make_folder(Path(plans))
        files |= {Path(plans) / name: content for name, content in offer.files().items()}
    if output:
        files[Path(output)] = offer.picture().content
    protect(given, options["nest"], files)
    write_files(files)
    click.echo(json.dumps(offer.rows()) if as_json else offer)
    if not as_json:
        click.echo(f"written: {', '.join(([output] if output else []) + ([f'{plans}/price-*'] if plans else []))}")
    if offer.interrupted:
        return 130
    return 0 if offer.refused is None and all(trade.lawful for trade in offer.trades) else 1
