"""kerfwise pareto: idle travel against overheats and errors of parts, each point a plan."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from kerfwise.commands.option_groups import RELAX, Stopped, limit_options, stopped_options, together
from kerfwise.commands.shared_options import (
    AMOUNT,
    AMOUNT_OVER_ZERO,
    input_options,
    note_placing,
    protect,
    read_inputs,
)
from kerfwise.encoder.errors import InputError
from kerfwise.rules.profile.plant_sections import PRICES_MM

if TYPE_CHECKING:
    from kerfwise.jobs.inputs import Inputs
    from kerfwise.models.engines.solution import Limits

    from .pareto import Straightness


@click.command()
@input_options
@click.option("--price", "prices", type=AMOUNT, multiple=True, default=PRICES_MM, show_default=True,
              help="Price of an overheat in mm of idle travel; repeatable.")  # fmt: skip
@limit_options(work=10.0)
@stopped_options("Resume after a stop: plan only what this plan or program has not cut.")
@RELAX
@together(
    "outputs",
    dict,
    click.option("-o", "--output", metavar="FRONT.png", help="Output of the plot. Default: NEST.pareto.png."),
    click.option(
        "--plans", metavar="DIR", help="Folder for the plan and program of every point. Default: NEST.pareto."
    ),
)
@click.option("--distortion", is_flag=True, help="Simulate how far the parts of each plan will be off: a third axis.")
@click.option("--off-price", "off_prices", type=AMOUNT_OVER_ZERO, multiple=True,
              help="Plan at this price of a mm that parts are off, in mm of idle travel, too; repeatable; "
              "with --distortion.")  # fmt: skip
@click.option("--json", "as_json", is_flag=True, help="Print the table as JSON.")
def command(
    prices: tuple[float, ...],
    limits: Limits,
    stopped: Stopped,
    relax: bool,
    outputs: dict[str, Any],
    distortion: bool,
    off_prices: tuple[float, ...],
    as_json: bool,
    **options: Any,
) -> int:
    """Plan NEST at several prices per overheat, simulate every plan, and print the Pareto front.

    With --distortion the errors of parts count, too: the front is that of travel, overheats and mm.
    """
    if off_prices and not distortion:
        raise click.UsageError("--off-price is a price on what --distortion simulates: give both")
    output, plans = outputs["output"], outputs["plans"]
    if output and Path(output).suffix.lower() != ".png":
        raise InputError(f"cannot plot as {Path(output).suffix or output!r}: give a name ending in .png", file=output)
    if output is plans is None:
        stem = Path(options["nest"]).stem
        output, plans = f"{stem}.pareto.png", f"{stem}.pareto"
    from kerfwise.commands.progress import ProgressLine
    from kerfwise.jobs.request import options_for
    from kerfwise.postproc.output_files import expect_folders, expect_place, make_folder, write_files

    from .pareto import trade_off

    if output:
        expect_folders([Path(output)])
    if plans:
        expect_place(Path(plans))
    inputs = read_inputs(**options, last=stopped.lock_from)
    protect(inputs, options["nest"], [output], stopped.lock_from)
    note_placing(inputs)
    already = stopped.already_cut(inputs)
    of_plans = options_for(inputs.nest, inputs.profile, **limits)
    name = Path(options["nest"]).name
    axis = _straightness(inputs, off_prices) if distortion else None
    offer = trade_off(inputs, prices, of_plans, ProgressLine, name, already=already, relax=relax, straightness=axis)
    if offer.refused is not None:
        click.echo(f"kerfwise: {offer.refused}", err=True)
    files: dict[Path, str | bytes] = {}
    if plans:
        make_folder(Path(plans))
        files |= {Path(plans) / name: content for name, content in offer.files().items()}
    if output:
        files[Path(output)] = offer.picture().content
    protect(inputs, options["nest"], files, stopped.lock_from)
    write_files(files)
    click.echo(json.dumps(offer.rows()) if as_json else offer)
    if not as_json:
        every = [f"{plans}/{'*' if off_prices else ''}price-*"] if plans else []
        click.echo(f"written: {', '.join(([output] if output else []) + every)}")
    if offer.interrupted:
        return 130
    return 0 if offer.refused is None and all(trade.lawful for trade in offer.trades) else 1


def _straightness(inputs: Inputs, prices: tuple[float, ...]) -> Straightness:
    """The axis of mm: errors of the parts of a plan, and plans at these prices on them."""
    from kerfwise.apps.distortion.elasticity import metal_of
    from kerfwise.apps.distortion.predict import distort_made
    from kerfwise.apps.distortion.straighter import StraighterOrders

    from .pareto import Straightness

    metal_of(inputs.profile.heat.material)
    return Straightness(lambda given, plan: distort_made(given, plan).mean_mm, StraighterOrders, prices)
