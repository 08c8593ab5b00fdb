"""kerfwise pareto: idle travel against overheats, each point a plan."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from kerfwise.encoder.errors import InputError, RulesConflict

from .given import Given, given_options, note_placing, read_given
from .numbers import AMOUNT, AMOUNT_OVER_ZERO

if TYPE_CHECKING:
    from kerfwise.jobs.trade_off import Trade
    from kerfwise.models.engines.solution import SolveOptions

PRICES_MM = (0.0, 10.0, 30.0, 100.0, 300.0)


@click.command()
@given_options
@click.option("--price", "prices", type=AMOUNT, multiple=True, default=PRICES_MM, show_default=True,
              help="Cost of an overheat in mm of idle travel; may be given more than once.")  # fmt: skip
@click.option("--work", type=AMOUNT_OVER_ZERO, default=10.0, show_default=True, help="Deterministic limit of a plan.")
@click.option("--seed", type=click.IntRange(min=0), default=1, show_default=True, help="Seed of the search.")
@click.option("-o", "--output", metavar="FRONT.png", help="A plot. If no output is named: NEST.pareto.png and --plans.")
@click.option("--plans", metavar="DIR", help="A folder for the plan and program of every point: NEST.pareto.")
@click.option("--json", "as_json", is_flag=True, help="The table as data.")
def command(
    prices: tuple[float, ...],
    work: float,
    seed: int,
    output: str | None,
    plans: str | None,
    as_json: bool,
    **options: Any,
) -> int:
    """Plan NEST at several prices of an overheat, simulate every plan, and say which of them are worth a choice."""
    if output and Path(output).suffix.lower() != ".png":
        raise InputError(f"cannot plot as {Path(output).suffix or output!r}: give a name ending in .png")
    if output is plans is None:
        stem = Path(options["nest"]).stem
        output, plans = f"{stem}.pareto.png", f"{stem}.pareto"
    from kerfwise.jobs.front_plot import front_png
    from kerfwise.jobs.trade_off import front
    from kerfwise.models.engines.solution import SolveOptions
    from kerfwise.models.physics.timing.choose import feeds_of
    from kerfwise.postproc.files import expect_folders, expect_place, make_folder, write_files

    if output:
        expect_folders([Path(output)])
    if plans:
        expect_place(Path(plans))
    given = read_given(**options)
    note_placing(given)
    profile = given.profile
    limits = SolveOptions(seed=seed, work=work, home_mm=profile.home_on(given.nest), feeds=feeds_of(profile))
    trades, code = _plans(given, sorted(set(prices)), limits)
    best = front(trades)
    files: dict[Path, str | bytes] = {}
    if plans:
        make_folder(Path(plans))
        for trade in trades:
            if trade.lawful:
                files[_file(plans, trade, "plan.json")] = trade.plan.to_json()
                files[_file(plans, trade, "nc")] = trade.made.program
    if output:
        files[Path(output)] = front_png(trades, profile.heat.limit_c, Path(options["nest"]).name)
    write_files(files)
    rows = [_row(trade, trade in best) for trade in trades]
    if as_json:
        click.echo(json.dumps(rows))
        return code
    click.echo(_table(rows, profile.heat.limit_c))
    click.echo(f"written: {', '.join(([output] if output else []) + ([f'{plans}/price-*'] if plans else []))}")
    return code


def _plans(given: Given, prices_mm: Sequence[float], limits: SolveOptions) -> tuple[list[Trade], int]:
    """A plan for each price, and the exit code. After Ctrl-C, or where a price leaves no plan, those found so far."""
    from kerfwise.jobs.ask import facts_of
    from kerfwise.jobs.trade_off import TradeOff

    from .progress import listening

    offered = TradeOff(facts_of(given.nest, given.profile), given.profile, limits)
    trades: list[Trade] = []
    try:
        for price_mm in prices_mm:
            if price_mm:
                offered.fit()  # Ctrl-C meanwhile ends the command at once: there is no better plan in it to keep
            with listening() as progress:
                trades.append(offered.at(price_mm, progress))
            if progress.interrupted:
                return trades, 130
    except RulesConflict as error:
        if not trades:
            raise
        click.echo(f"kerfwise: {error}", err=True)
        return trades, 1
    except KeyboardInterrupt:
        if not trades:
            raise
        return trades, 130
    return trades, 0 if all(trade.lawful for trade in trades) else 1


def _file(plans: str, trade: Trade, suffix: str) -> Path:
    return Path(plans) / f"price-{trade.price_mm:.12g}.{suffix}"


def _row(trade: Trade, on_front: bool) -> dict[str, Any]:
    return {
        "price_mm": trade.price_mm,
        "overheats": trade.overheats,
        "peak_c": round(trade.peak_c, 1),
        "idle_mm": round(trade.idle_mm, 1),
        "time_s": round(trade.plan.totals.time_s, 1),
        "lawful": trade.lawful,
        "front": on_front,
    }


def _table(rows: list[dict[str, Any]], limit_c: float) -> str:
    lines = [f"{'price, mm':>10} {f'over {limit_c:g} °C':>14} {'peak, °C':>9} {'idle, m':>9} {'time, s':>9}"]
    for row in rows:
        mark = "" if row["front"] else "   no better than another"
        mark = mark if row["lawful"] else "   the check refuses it: not written"
        lines.append(
            f"{row['price_mm']:10g} {row['overheats']:14d} {row['peak_c']:9.1f} {row['idle_mm'] / 1000:9.3f} "
            f"{row['time_s']:9.1f}{mark}"
        )
    return "\n".join(lines)
