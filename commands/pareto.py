"""kerfwise pareto: idle travel against overheats, each point a plan."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ..encoder.errors import InputError
from .given import given_options, read_given

if TYPE_CHECKING:
    from ..postproc.trade_off import Trade

PRICES_MM = (0.0, 10.0, 30.0, 100.0, 300.0)


@click.command()
@given_options
@click.option("--price", "prices", type=click.FloatRange(min=0), multiple=True, default=PRICES_MM, show_default=True,
              help="Cost of an overheat in mm of idle travel; may be given more than once.")  # fmt: skip
@click.option("--work", type=click.FloatRange(min=0, min_open=True), default=10.0, show_default=True,
              help="Deterministic limit of each plan.")  # fmt: skip
@click.option("--seed", type=click.IntRange(min=0), default=1, show_default=True, help="Seed of the search.")
@click.option("-o", "--output", metavar="FRONT.png", help="A plot of the front.")
@click.option("--plans", metavar="DIR", help="Where to write the plan and the program of every point.")
@click.option("--json", "as_json", is_flag=True, help="The table as data.")
def command(
    prices: tuple[float, ...],
    work: float,
    seed: int,
    output: str | None,
    plans: str | None,
    as_json: bool,
    **given: Any,
) -> int:
    """Plan NEST at several prices of an overheat, simulate every plan, and say which of them are worth a choice."""
    if output and Path(output).suffix.lower() != ".png":
        raise InputError(f"cannot plot as {Path(output).suffix or output!r}: give a name ending in .png")
    from ..models.solution import SolveOptions
    from ..models.timing.choose import feeds_of
    from ..postproc.files import write_files
    from ..postproc.produce import facts_of
    from ..postproc.report.front_plot import front_png
    from ..postproc.trade_off import front, trade_offs

    asked = read_given(**given)
    profile = asked.profile
    limits = SolveOptions(seed=seed, work=work, home_mm=profile.machine.home, feeds=feeds_of(profile))
    trades = list(trade_offs(facts_of(asked.nest, profile), profile, sorted(set(prices)), limits))
    best = front(trades)
    files: dict[Path, str | bytes] = {}
    if plans:
        Path(plans).mkdir(parents=True, exist_ok=True)
        for trade in trades:
            stem = f"price-{trade.price_mm:g}"
            files[Path(plans) / f"{stem}.plan.json"] = trade.plan.to_json()
            files[Path(plans) / f"{stem}.nc"] = trade.made.program
    if output:
        files[Path(output)] = front_png(trades, profile.heat.limit_c)
    write_files(files)
    rows = [_row(trade, trade in best) for trade in trades]
    click.echo(json.dumps(rows) if as_json else _table(rows, profile.heat.limit_c))
    return 0 if all(trade.made.verdict.ok for trade in trades) else 1


def _row(trade: Trade, on_front: bool) -> dict[str, Any]:
    return {
        "price_mm": trade.price_mm,
        "overheats": trade.overheats,
        "peak_c": round(trade.peak_c, 1),
        "idle_mm": round(trade.idle_mm, 1),
        "time_s": round(trade.plan.totals.time_s, 1),
        "lawful": trade.made.verdict.ok,
        "front": on_front,
    }


def _table(rows: list[dict[str, Any]], limit_c: float) -> str:
    lines = [f"{'price, mm':>10} {f'over {limit_c:g} °C':>14} {'peak, °C':>9} {'idle, m':>9} {'time, s':>9}"]
    for row in rows:
        mark = "" if row["front"] else "   no better than another"
        mark += "" if row["lawful"] else "   the check refuses it"
        lines.append(
            f"{row['price_mm']:10g} {row['overheats']:14d} {row['peak_c']:9.1f} {row['idle_mm'] / 1000:9.3f} "
            f"{row['time_s']:9.1f}{mark}"
        )
    return "\n".join(lines)
