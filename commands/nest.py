"""kerfwise nest: parts with quantities become nests, sheet by sheet, checked before they are written."""

from __future__ import annotations

from pathlib import Path

import click

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.shown import shown
from kerfwise.rules.profile.profile import DEFAULT

from .given import TRUST, tell_note
from .lengths import length_or_zero
from .numbers import AMOUNT_OVER_ZERO

PICTURES = (".svg", ".png", ".pdf")


@click.command()
@click.option("--sheet", "sheets", metavar="WxH[=N]|FILE[=N]", multiple=True,
              help="A sheet in mm, such as 3000x1500, and how many there are; may be repeated.")  # fmt: skip
@click.option("--remnant", "remnants", metavar="FILE[=N]|WxH[=N]", multiple=True,
              help="A remnant of any shape, used before sheets; may be repeated.")  # fmt: skip
@click.option("-p", "--profile", metavar="PROFILE", default=DEFAULT, show_default=True, help="Name or path.")
@TRUST
@click.option("-o", "--output", metavar="DIR", required=True, help="The folder of the nests.")
@click.option("--gap", metavar="LENGTH", help="Between parts, instead of a kerf and the profile's nesting.web.")
@click.option("--edge", metavar="LENGTH", help="To the edge of the sheet, instead of the profile's nesting.edge.")
@click.option("--dxf", is_flag=True, help="Write each nest as DXF, too.")
@click.option("--picture", type=click.Choice([kind[1:] for kind in PICTURES]), default="svg", show_default=True,
              help="Of what kind the pictures are.")  # fmt: skip
@click.option("--rounds", type=click.IntRange(1, 100_000), default=12, show_default=True, metavar="N",
              help="Orders that are tried, without --time-limit. The same number gives the same bytes.")  # fmt: skip
@click.option("--time-limit", type=AMOUNT_OVER_ZERO, metavar="S", help="Look as long, by the clock, in seconds.")
@click.option("--seed", type=click.IntRange(min=0), default=1, show_default=True, metavar="N", help="Of random orders.")
@click.option("--units", metavar="UNIT", help="Unit of the drawings: mm, cm, m, in or ft.")
@click.argument("parts", metavar="PARTS…", nargs=-1, required=True)
def command(
    parts: tuple[str, ...],
    sheets: tuple[str, ...],
    remnants: tuple[str, ...],
    profile: str,
    trust: bool,
    output: str,
    gap: str | None,
    edge: str | None,
    dxf: bool,
    picture: str,
    rounds: int,
    time_limit: float | None,
    seed: int,
    units: str | None,
) -> int:
    """Lay PARTS, files with their quantities (bracket.dxf=12) or lists of parts, on sheets; remnants first."""
    from kerfwise.jobs.given import plant_of, reading
    from kerfwise.jobs.nesting.files import expect_folder, write_nests
    from kerfwise.jobs.nesting.order import order_of
    from kerfwise.jobs.nesting.run import lay_out
    from kerfwise.jobs.nesting.spacing import spacing_of
    from kerfwise.jobs.nesting.table import as_text
    from kerfwise.nesting.rounds import Effort

    from .nest_progress import NestProgress

    plant, out = plant_of(profile, trust), Path(output)
    expect_folder(out)
    gap_mm = None if gap is None else length_or_zero("--gap", gap)
    spacing = spacing_of(plant, gap_mm, None if edge is None else length_or_zero("--edge", edge))
    wanted = order_of(parts, sheets, remnants, reading(plant, units=units), tell_note)
    with NestProgress() as progress:
        nested = lay_out(wanted, spacing, Effort(rounds, time_limit, seed), progress)
    if nested.faults:
        raise InputError("the check refuses these nests; nothing was written", details=nested.faults)
    files = write_nests(out, nested, f".{picture}", dxf, profile=plant.name, seed=seed)
    click.echo(as_text(nested))
    click.echo(f"written: {len(files)} files in {shown(str(out))}")
    if progress.interrupted:
        return 130
    return 1 if any(nested.layout.missing) else 0
