"""How dense and how cheap nests become: strips, furniture, a day of a shop, and lists weighed for cutting.

Usage: python -m kerfwise.benchmarks.nesting [CHECKOUT] [--rounds 12] [--seconds 30] > nesting-figures.md

CHECKOUT is one of https://github.com/JeroenGar/sparrow, for the strips: its instances are not shipped.
"""

from __future__ import annotations

import argparse
import platform
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import kerfwise
from kerfwise.apps.bench.bench_child import peak_mb
from kerfwise.apps.nesting.find_nests import (
    ALONE,
    Watching,
    cheapest,
    comparable_layouts,
    spacing_of,
    varied_layouts,
    weigh,
)
from kerfwise.apps.nesting.placement.demand import Demand, Spacing, Stock
from kerfwise.apps.nesting.placement.layout import Layout
from kerfwise.apps.nesting.placement.rounds import METHODS, Effort, best_layout
from kerfwise.encoder.nest import Sheet
from kerfwise.encoder.scrap import largest_rectangle
from kerfwise.jobs.progress import Listener
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.plant_sections import Consumables, Prices
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.sections import Common as CommonCuts
from kerfwise.rules.profile.sections import Cuts, Scrap

from .nesting_lists import cutting_list, day_list, furniture, least_worth, usable_area_mm2
from .nesting_strips import paragraph, sound, strips

PROFILE, GAP_MM = "laser-st10kp-2mm", 6.0
PRICES = Prices(
    machine_hour=80.0,
    kwh=0.24,
    torch_kw=40.0,
    consumables=Consumables(set_price=15.0, pierces=500.0),
    sheet_kg=1.15,
    remnant_share=0.6,
)
LISTS, COMMON, WEIGHED, WORK = 5, 2, 4, 0.5
"""Lists weighed for cutting, how many of them with common cuts too, layouts of each, and work a sheet."""
LEAST_MM = 200.0


def main() -> None:
    """Print the page."""
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("checkout", nargs="?", type=Path)
    asked.add_argument("--rounds", type=int, default=12)
    asked.add_argument("--seconds", type=float, default=30.0)
    asked.add_argument("--only", choices=["strips", "furniture", "day", "cutting"])
    given = asked.parse_args()
    print(
        "# How dense nests become\n\n"
        f"Made by `python -m kerfwise.benchmarks.nesting CHECKOUT --rounds {given.rounds} --seconds {given.seconds:g}` "
        f"with kerfwise {kerfwise.__version__}, Python {platform.python_version()}. Seconds are of the processor. "
        "Each layout passed the check."
    )
    parts: dict[str, Callable[[], Iterator[str]]] = {
        "strips": lambda: strips(given.checkout, given.rounds, given.seconds) if given.checkout else iter(()),
        "furniture": lambda: _furniture(given.rounds),
        "day": lambda: _day(given.rounds),
        "cutting": lambda: _cutting(given.rounds),
    }
    for name, lines in parts.items():
        if given.only in (None, name):
            for line in lines():
                print(line, flush=True)


def _furniture(rounds: int) -> Iterator[str]:
    types = furniture()
    wanted = Demand(types, (Stock("2500x1250", Sheet.rectangle(2500, 1250)),))
    usable_mm2 = usable_area_mm2(2500, 1250, (5.0, 5.0), 0.35)
    copies = sum(kind.quantity for kind in types)
    yield "\n## Furniture\n"
    yield paragraph(
        f"{len(types)} parts, {copies} copies on boards of 2500 × 1250 mm, a kerf of 0.7 mm between them and 5 mm",
        "to the edge. Pavlov 1999 reports 0.80 to 0.85 of the sheet. The last board is as full as it happens to",
        "be; *usable* is the area that his formula leaves of a board, (D - 2 l + δ)(E - 2 l + δ).",
    )
    yield "| engine | rounds | use of each board | of all but the last | of what is usable | s |"
    yield "|---|---:|---|---:|---:|---:|"
    for method in METHODS:
        began = time.process_time()
        layout = sound(best_layout(wanted, Spacing(0.7, 5.0), Effort(rounds, method=method))).layout
        spent = time.process_time() - began
        metal = [sheet.metal_mm2(wanted) for sheet in layout.sheets]
        uses = [mm2 / sheet.stock.area_mm2 for mm2, sheet in zip(metal, layout.sheets, strict=True)]
        told = ", ".join(f"{use:.3f}" for use in uses)
        share = _mean([mm2 / usable_mm2 for mm2 in metal[:-1]])
        yield f"| {method} | {rounds} | {told} | {_mean(uses[:-1]):.3f} | {share:.3f} | {spent:.0f} |"


def _mean(values: Sequence[float]) -> float:
    return sum(values) / len(values) if values else 0.0


def _day(rounds: int) -> Iterator[str]:
    wanted, spacing = day_list(), Spacing(8.0, 10.0)
    count = sum(kind.quantity for kind in wanted.types)
    yield "\n## A day of a shop\n"
    yield paragraph(
        f"{len(wanted.types)} part types, {count} parts, three sizes of sheets, two remnants; 8 mm between parts,",
        f"{rounds} rounds. *No less than*: so much do whole sheets cost that hold the area of the parts and of",
        "half the gap around them. The second run is of another list of as many parts, with what the first left",
        f"in place of the remnants: the largest rectangle of each sheet, where it is {LEAST_MM:g} mm wide and",
        "high.",
    )
    yield "| run | laid | remnants | sheets bought | use of each | price | no less than | first round | s | MB |"
    yield "|---|---:|---:|---|---|---:|---:|---:|---:|---:|"
    first = _day_run("first", wanted, spacing, rounds)
    yield first[0]
    left = _left(first[1])
    again = day_list(seed=2)
    again = replace(again, stocks=(*(stock for stock in again.stocks if not stock.remnant), *left))
    yield _day_run("second", again, spacing, rounds)[0]


def _day_run(name: str, wanted: Demand, spacing: Spacing, rounds: int) -> tuple[str, Layout]:
    began, prices = time.process_time(), list[float]()

    def told(number: int, best: Layout) -> bool:
        prices.append(best.score[1])
        return True

    layout = sound(best_layout(wanted, spacing, Effort(rounds), told)).layout
    spent = time.process_time() - began
    count = sum(kind.quantity for kind in wanted.types)
    bought = [sheet.stock for sheet in layout.sheets if not sheet.stock.remnant]
    cells = (
        name,
        f"{count - sum(layout.missing)} of {count}",
        str(len(layout.sheets) - len(bought)),
        ", ".join(stock.name for stock in bought),
        ", ".join(f"{sheet.metal_mm2(wanted) / sheet.stock.area_mm2:.3f}" for sheet in layout.sheets),
        f"{sum(stock.price or 0.0 for stock in bought):.2f}",
        f"{least_worth(wanted, spacing):.2f}",
        f"{prices[0]:.2f}",
        f"{spent:.0f}",
        f"{peak_mb():.0f}",
    )
    return f"| {' | '.join(cells)} |", layout


def _left(layout: Layout) -> list[Stock]:
    """The largest rectangle of each sheet, as a remnant."""
    found = []
    for number, sheet in enumerate(layout.sheets, 1):
        x0, y0, x1, y1 = largest_rectangle(sheet.stock.sheet, layout.metal_of(sheet), layout.spacing.gap_mm)
        if min(x1 - x0, y1 - y0) >= LEAST_MM:
            found.append(Stock(f"left{number}", Sheet.rectangle(x1 - x0, y1 - y0), 1, remnant=True))
    return found


def _cutting(rounds: int) -> Iterator[str]:
    yield "\n## Cheap to cut\n"
    yield paragraph(
        f"Small lists under the profile `{PROFILE}` with prices, parts {GAP_MM:g} mm apart, and a remnant that is",
        f"saved on the right, worth {PRICES.remnant_share:.0%} of the sheet it is of; {WEIGHED} layouts of each",
        f"are weighed, {WORK:g} of work a sheet. Price a part, EUR. *Way* says what laid the layout that was",
        f"taken. The last {COMMON} lists are weighed with common cuts, too: then parts lie a kerf apart in blocks,",
        "and *each alone* is the cheapest of the layouts weighed that has no blocks.",
    )
    yield "| list | profile | parts | densest | taken | saved | each alone | way |"
    yield "|---|---|---:|---:|---:|---:|---:|---|"
    for seed in range(1, LISTS + 1):
        wanted = cutting_list(seed)
        plants = [_plant(common=False), _plant(common=True)] if seed > LISTS - COMMON else [_plant(common=False)]
        for plant in plants:
            yield _weighed_row(seed, wanted, plant, rounds)


def _plant(common: bool) -> Profile:
    scrap = Scrap(remnant="right")
    cuts = Cuts(common=CommonCuts(shortest_mm=20.0), scrap=scrap) if common else Cuts(scrap=scrap)
    return replace(load_profile(PROFILE), prices=PRICES, cuts=cuts)


def _weighed_row(seed: int, wanted: Demand, plant: Profile, rounds: int) -> str:
    spacing, watching = spacing_of(plant, GAP_MM), Watching()
    groups = list(varied_layouts(wanted, spacing, Effort(rounds), "own", watching, print))
    weighed = [
        weigh(sound(layout), plant, WORK, lambda name: Listener()) for layout in comparable_layouts(groups, WEIGHED)
    ]
    taken, count = cheapest(weighed), sum(kind.quantity for kind in wanted.types)
    asked = "common cuts" if spacing.common is not None else "plain"
    if taken.price is None:
        return f"| {seed} | {asked} | {count} | no plan: {weighed[0].why} | | | | |"
    first = weighed[0].price
    told = "no plan" if first is None else f"{first / count:.4f}"
    saved = "" if first is None else f"{1 - taken.price / first:.2%}"
    alone = [one.price for one in weighed if one.price is not None and one.nested.layout.by.endswith(ALONE)]
    single = f"{min(alone) / count:.4f}" if alone else ""
    way = "; ".join([taken.nested.layout.by, *taken.moved])
    return f"| {seed} | {asked} | {count} | {told} | {taken.price / count:.4f} | {saved} | {single} | {way} |"


if __name__ == "__main__":
    main()
