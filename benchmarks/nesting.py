"""How dense and how cheap nests become: strips, furniture, a day of a shop, and lists weighed for cutting.

Usage: python -m kerfwise.benchmarks.nesting [FOLDER] [--rounds 12] [--seconds 30] > nesting-figures.md

FOLDER holds packed nests of published instances (kerfwise-nest/1, parts named NAME-TYPE#COPY), which are not shipped.
"""

from __future__ import annotations

import argparse
import platform
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import shapely

import kerfwise
from kerfwise.encoder.nest import Nest, Sheet
from kerfwise.encoder.readers import read_nest
from kerfwise.jobs.bench.memory import peak_mb
from kerfwise.jobs.listening import Listener
from kerfwise.jobs.nesting.run import Nested, nests_from
from kerfwise.jobs.nesting.table import use_of_all
from kerfwise.jobs.nesting.weigh import alike, cheapest, weigh
from kerfwise.nesting import sparrow
from kerfwise.nesting.allot import Layout, allot
from kerfwise.nesting.bound import least_worth
from kerfwise.nesting.denser import denser
from kerfwise.nesting.fill import LEFT, by_size
from kerfwise.nesting.rounds import Effort, best_layout, layouts
from kerfwise.nesting.shapes import Shapes
from kerfwise.nesting.wanted import PartType, Spacing, Stock, Wanted
from kerfwise.rules.profile.prices_section import Prices
from kerfwise.rules.profile.profile import load_profile

from .nesting_lists import cutting_list, day_list, furniture

PRICES = Prices(machine_hour=80.0, kwh=0.24, torch_kw=40.0, sheet_kg=1.15)
LISTS, WEIGHED = 5, 3


def main() -> None:
    """Print the page."""
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("folder", nargs="?", type=Path)
    asked.add_argument("--rounds", type=int, default=12)
    asked.add_argument("--seconds", type=float, default=30.0)
    asked.add_argument("--only", choices=["strips", "furniture", "day", "cutting"])
    given = asked.parse_args()
    print(
        "# How dense nests become\n\n"
        f"Made by `python -m kerfwise.benchmarks.nesting FOLDER --rounds {given.rounds} --seconds {given.seconds:g}` "
        f"with kerfwise {kerfwise.__version__}, Python {platform.python_version()}. Seconds are of the processor. "
        "Each layout passed the check."
    )
    parts: dict[str, Callable[[], Iterator[str]]] = {
        "strips": lambda: _strips(given.folder, given.rounds, given.seconds),
        "furniture": lambda: _furniture(given.rounds),
        "day": lambda: _day(given.rounds),
        "cutting": lambda: _cutting(given.rounds),
    }
    for name, lines in parts.items():
        if given.only in (None, name):
            for line in lines():
                print(line, flush=True)


def _sound(layout: Layout) -> Nested:
    nested = nests_from(layout)
    if nested.faults:
        sys.exit("\n".join(nested.faults))
    return nested


def _strips(folder: Path | None, rounds: int, seconds: float) -> Iterator[str]:
    """Published instances, on the strip that the file has, longer."""
    if folder is None:
        return
    yield "\n## Strips\n"
    yield "Instances as sparrow packed them, outlines only, with the least distance that the packed file has. Density"
    yield "is that of the strip up to the last part. Bottom-left is one round: the largest first, as far left as it"
    yield "goes."
    yield f"Sparrow has {seconds:g} s by the clock after the rounds.\n"
    yield "| instance | parts | mm apart | packed file | bottom-left | s | rounds | s | sparrow here |"
    yield "|---|---|---|---|---|---|---|---|---|"
    for file in sorted(folder.glob("*.json")):
        yield _strip(read_nest(file), rounds, seconds)


def _strip(nest: Nest, rounds: int, seconds: float) -> str:
    wanted, spacing = _as_order(nest)
    shapes, began = Shapes(wanted.types, spacing.gap_mm), time.process_time()
    plain = _sound(allot(wanted, shapes, spacing, by_size(shapes, range(len(wanted.types))), LEFT)).layout
    plain_s, began = time.process_time() - began, time.process_time()
    own = _sound(best_layout(wanted, spacing, Effort(rounds))).layout
    own_s = time.process_time() - began
    packed = "–"
    if sparrow.installed():
        made = _sound(denser(own, shapes, seconds, 1, print)).layout
        packed = f"{_density(made):.3f}"
    _, _, x1, _ = shapely.total_bounds([part.outer.polygon for part in nest.parts]).tolist()
    there = wanted.area_mm2 / (x1 * nest.sheet.bounds[3])
    return (
        f"| {Path(nest.file).stem} | {len(nest.parts)} | {spacing.gap_mm:.1f} | {there:.3f} | {_density(plain):.3f} | "
        f"{plain_s:.0f} | {_density(own):.3f} | {own_s:.0f} | {packed} |"
    )


def _as_order(nest: Nest) -> tuple[Wanted, Spacing]:
    """The parts of a nest without their holes, by type, on one sheet as high and twice as long."""
    counts = Counter(part.id.split("#")[0] for part in nest.parts)
    first = {part.id.split("#")[0]: part for part in reversed(nest.parts)}
    bare = {name: replace(part, holes=(), marks=()) for name, part in first.items()}
    types = tuple(PartType(name, bare[name], counts[name], turns_deg=(0.0, 180.0)) for name in sorted(counts))
    areas = [part.outer.polygon for part in nest.parts]
    gap_mm = min(
        areas[i].distance(areas[j]) for i, j in shapely.STRtree(areas).query(areas, "dwithin", distance=30.0).T if i < j
    )
    _, _, width, height = nest.sheet.bounds
    stock = Stock("strip", Sheet.rectangle(2 * width, height), 1)
    return Wanted(types, (stock,)), Spacing(max(round(gap_mm - 0.01, 2), 0.0), 0.0)


def _density(layout: Layout) -> float:
    """Of the strip up to the last part; 0 where parts are missing."""
    if any(layout.missing):
        return 0.0
    [sheet] = layout.sheets
    reach = max(area.bounds[2] for area in layout.metal_of(sheet))
    return float(layout.wanted.area_mm2 / (reach * sheet.stock.sheet.bounds[3]))


def _furniture(rounds: int) -> Iterator[str]:
    types = furniture()
    wanted = Wanted(types, (Stock("2500x1250", Sheet.rectangle(2500, 1250)),))
    began = time.process_time()
    layout = _sound(best_layout(wanted, Spacing(0.7, 5.0), Effort(rounds))).layout
    spent = time.process_time() - began
    uses = [sheet.metal_mm2(wanted) / sheet.stock.area_mm2 for sheet in layout.sheets]
    yield "\n## Furniture\n"
    copies = sum(kind.quantity for kind in types)
    yield f"{len(types)} parts, {copies} copies on boards of 2500 × 1250 mm, a kerf of 0.7 mm"
    yield "between them and 5 mm to the edge. Pavlov 1999 reports 0.80 to 0.85 of the sheet.\n"
    yield f"Use of each board: {', '.join(f'{use:.3f}' for use in uses)}; of all but the last {_mean(uses[:-1]):.3f}."
    yield f"{spent:.0f} s for {rounds} rounds."


def _mean(values: Sequence[float]) -> float:
    return sum(values) / len(values) if values else 0.0


def _day(rounds: int) -> Iterator[str]:
    wanted, spacing = day_list(), Spacing(8.0, 10.0)
    began = time.process_time()
    nested = _sound(best_layout(wanted, spacing, Effort(rounds)))
    spent = time.process_time() - began
    count = sum(kind.quantity for kind in wanted.types)
    stock_mm2 = sum(sheet.stock.area_mm2 for sheet in nested.layout.sheets)
    bought = sum(sheet.stock.price or 0.0 for sheet in nested.layout.sheets)
    yield "\n## A day of a shop\n"
    yield f"{len(wanted.types)} part types, {count} parts, three sizes of sheets, two remnants; 8 mm between parts.\n"
    yield "| sheet | parts | use |"
    yield "|---|---|---|"
    for sheet in nested.layout.sheets:
        yield f"| {sheet.stock.name} | {len(sheet.placed)} | {sheet.metal_mm2(wanted) / sheet.stock.area_mm2:.3f} |"
    laid = count - sum(nested.layout.missing)
    yield f"\n{laid} of {count} parts are laid, on {stock_mm2 / 1e6:.2f} m² of which they are {use_of_all(nested):.3f}."
    yield f"The sheets that are bought cost {bought:.2f}; no layout costs less than {least_worth(wanted, spacing):.2f}:"
    yield "so much do whole sheets cost that hold the area of the parts and of half the gap around them."
    yield f"{spent:.0f} s for {rounds} rounds, {peak_mb():.0f} MB."


def _cutting(rounds: int) -> Iterator[str]:
    plant = replace(load_profile(), prices=PRICES)
    yield "\n## Cheap to cut\n"
    yield f"Small lists under the profile `{plant.name}` with prices; {WEIGHED} layouts of each are weighed, a unit of"
    yield "work a sheet. Price a part, EUR.\n"
    yield "| list | parts | densest | taken | saved |"
    yield "|---|---|---|---|---|"
    for seed in range(1, LISTS + 1):
        wanted = cutting_list(seed)
        ranked = alike([layouts(wanted, Spacing(7.5, 10.0), Effort(rounds))], WEIGHED)
        weighed = [weigh(_sound(layout), plant, 1.0, lambda name: Listener()) for layout in ranked]
        taken, count = cheapest(weighed), sum(kind.quantity for kind in wanted.types)
        if taken.price is None:
            yield f"| {seed} | {count} | no plan: {weighed[0].why} | | |"
            continue
        first = weighed[0].price
        told = "no plan" if first is None else f"{first / count:.4f}"
        saved = "" if first is None else f"{1 - taken.price / first:.2%}"
        yield f"| {seed} | {count} | {told} | {taken.price / count:.4f} | {saved} |"


if __name__ == "__main__":
    main()
