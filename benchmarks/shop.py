"""A shop's list: 300 parts of 25 kinds, DXF files and a CSV, nested, planned and papered in one command.

Usage: python benchmarks/shop.py [--rounds N] [--work W] [--kinds N] [--parts N]

It prints minutes, memory, the use of each sheet, how many whole sheets are needed at least, and, with spyrrow, how long
a strip of the sheet's height is that sparrow packs all parts into.
"""

from __future__ import annotations

import argparse
import json
import math
import random
import tempfile
import time
from pathlib import Path

from ezdxf.addons.r12writer import r12writer

from kerfwise.apps.bench.bench_child import peak_mb
from kerfwise.apps.nesting.find_nests import spacing_of
from kerfwise.apps.nesting.request import order_of
from kerfwise.benchmarks.nesting_lists import least_worth
from kerfwise.cli import program
from kerfwise.jobs.inputs import DrawingSaid, plant_of, reading

Point = tuple[float, float]
SHEET = (3000.0, 1500.0)


def outline(chance: random.Random) -> list[Point]:
    """One of four shapes: plate, L, trapezium, disc."""
    width, height = chance.uniform(60, 400), chance.uniform(50, 250)
    match chance.randrange(4):
        case 0:
            return [(0, 0), (width, 0), (width, height), (0, height)]
        case 1:
            arm = 0.35 * min(width, height)
            return [(0, 0), (width, 0), (width, arm), (arm, arm), (arm, height), (0, height)]
        case 2:
            return [(0, 0), (width, 0), (0.75 * width, height), (0.25 * width, height)]
        case _:
            radius = 0.5 * height
            turns = [2 * math.pi * k / 36 for k in range(36)]
            return [(radius + radius * math.cos(t), radius + radius * math.sin(t)) for t in turns]


def draw_list(folder: Path, kinds: int, parts: int, seed: int = 1) -> Path:
    """Drawings of all kinds, some with holes, and a list that wants so many of them; the same each time.

    The circle of an L lies beside its outline: the drawing then holds two parts, and each is laid as often.
    """
    chance = random.Random(seed)
    rows = ["Zeichnung;Stück;Werkstoff;Dicke;Auftrag"]
    for k in range(kinds):
        points = outline(chance)
        middle = sum(x for x, _ in points) / len(points), sum(y for _, y in points) / len(points)
        with r12writer(str(folder / f"part{k:02}.dxf")) as dxf:
            dxf.add_polyline_2d(points, layer="CUT", closed=True)
            if k % 2:
                dxf.add_circle(middle, 8, layer="CUT")
        count = parts // kinds + (k < parts % kinds)
        rows.append(f"part{k:02};{count};S235;6;{4700 + k // 5}")
    (folder / "list.csv").write_text("\n".join(rows) + "\n", encoding="utf-8", newline="\n")
    return folder / "list.csv"


def strip_mm(listed: Path) -> float | None:
    """The length of a strip of the sheet's height in which sparrow lays all parts; None without spyrrow."""
    try:
        import spyrrow
    except ImportError:
        return None
    plant = plant_of()
    wanted = order_of([str(listed)], ["3000x1500"], [], reading(plant, DrawingSaid("mm"))).wanted
    spacing = spacing_of(plant)
    items = [
        spyrrow.Item(kind.name, list(kind.part.outer.polygon.simplify(0.2).exterior.coords), kind.quantity,
                     [0.0, 90.0, 180.0, 270.0])
        for kind in wanted.types
    ]  # fmt: skip
    config = spyrrow.StripPackingConfig(
        early_termination=False, total_computation_time=60, seed=1, min_items_separation=spacing.gap_mm, num_workers=2
    )
    instance = spyrrow.StripPackingInstance("shop", SHEET[1] - 2 * spacing.edge_mm, items)
    return float(instance.solve(config).width)


def main() -> None:
    """Draw, make, and print."""
    parser = argparse.ArgumentParser(description="A shop's list, nested, planned and papered.")
    for name, kind, value in (("rounds", int, 3), ("work", float, 2.0), ("kinds", int, 25), ("parts", int, 300)):
        parser.add_argument(f"--{name}", type=kind, default=value)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        listed, out = draw_list(folder, given.kinds, given.parts), folder / "out"
        began_s, began_cpu_s = time.monotonic(), time.process_time()
        words = ["make", str(listed), "--units", "mm", "--sheet", "3000x1500", "--rounds", str(given.rounds)]
        words += ["--work", str(given.work), "--sheets", "--skip-bad", "-o", str(out)]
        code = program.main(words, standalone_mode=False)
        minutes = (time.monotonic() - began_s) / 60
        print(f"exit code {code}; {minutes:.1f} min ({(time.process_time() - began_cpu_s) / 60:.1f} of processor)")
        print(f"{peak_mb():.0f} MB at most; sheets.pdf {(out / 'sheets.pdf').stat().st_size / 1e6:.1f} MB")
        table = json.loads((out / "nests.json").read_text(encoding="utf-8"))
        print("use of each sheet:", ", ".join(f"{row['use']:.3f}" for row in table["sheets"]))
        plant = plant_of()
        wanted = order_of([str(listed)], ["3000x1500"], [], reading(plant, DrawingSaid("mm"))).wanted
        least = least_worth(wanted, spacing_of(plant)) / (SHEET[0] * SHEET[1])
        print(
            f"at least {least:.0f} whole sheets; metal of all parts {wanted.area_mm2 / SHEET[0] / SHEET[1]:.2f} sheets"
        )
        length_mm = strip_mm(listed)
        if length_mm is not None:
            share = wanted.area_mm2 / (length_mm * SHEET[1])
            print(f"sparrow's strip of {SHEET[1]:g} mm: {length_mm:.0f} mm long, use {share:.3f}, 60 s")


if __name__ == "__main__":
    main()
