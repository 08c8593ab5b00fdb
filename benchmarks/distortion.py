"""How far `kerfwise distort` may be trusted: meshes made finer, published shrinkage beside ours, and what it costs.

Usage: python -m kerfwise.benchmarks.distortion [convergence] [literature] [zones] [strip] [speed]

convergence: the mean over the parts of each part's worst error, of three plans, on meshes of ever finer cells.
literature: the force with which the band beside a cut pulls when it is cold, beside published formulas that were fitted
to measurements. zones: how deep from the cut metal gets over 720 °C, beside measured widths of heat-affected zones.
strip: strips of 2.4 m in 20 mm plate, the nest whose parts the papers warn of. speed: CPU seconds and memory for 40
contours on 3000 × 1500 mm and 115 on 6000 × 1500 mm, at the default mesh.
"""

from __future__ import annotations

import json
import math
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import kerfwise
from kerfwise import solve
from kerfwise.apps.bench.bench_child import peak_mb
from kerfwise.apps.distortion.predict import distort_path
from kerfwise.apps.distortion.yielding import METALS, yielded
from kerfwise.benchmarks.distortion_rules import made_nest
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers import ReadOptions, read_nest
from kerfwise.encoder.readers.json_nest import read_json
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.jobs.inputs import Inputs
from kerfwise.jobs.simulation import path_of_plan
from kerfwise.models.physics.heat import TimedPath
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.plant_sections import MATERIALS
from kerfwise.rules.profile.profile import Profile

EXAMPLES = Path(kerfwise.__file__).parent / "examples" / "nests"


def skipping(name: str) -> Profile:
    """A shipped profile that leaves out holes that are too small for it."""
    profile = load_profile(name)
    return replace(profile, small_holes=replace(profile.small_holes, under="skip"))


def planned(nest: Nest, profile: Profile, work: float = 1.0) -> tuple[Inputs, TimedPath]:
    """The nest as it is cut, and the path of its plan."""
    given = Inputs(profile.as_cut(nest), profile)
    return given, path_of_plan(solve(nest, profile, work=work, job=False, relax=True).plan, given.nest, profile)


def strips(count: int = 4) -> Nest:
    """Strips of 2400 × 90 mm above each other on 2500 mm of plate, and squares at their end."""
    parts = [
        {"id": f"S{k + 1}", "outer": [[40, y], [2440, y], [2440, y + 90], [40, y + 90]]}
        for k, y in enumerate(range(40, 40 + 120 * count, 120))
    ]
    sheet = {"width": 2500, "height": 60 + 120 * count}
    text = json.dumps({"format": "kerfwise-nest/1", "units": "mm", "sheet": sheet, "parts": parts})
    return read_json(text.encode(), ReadOptions())


def convergence() -> Iterator[str]:
    """A row for each plan and cell width."""
    yield "| plan | cell, mm | cells | mean of parts, mm | worst part, mm | CPU s |"
    yield "|---|---:|---:|---:|---:|---:|"
    cases = (
        ("made nest 101, oxyfuel 20 mm", made_nest(101, "oxyfuel"), "oxyfuel-thick-plate", (40.0, 28.0, 20.0, 14.0)),
        ("e1x_6, plasma 6 mm", read_nest(EXAMPLES / "e1x_6.json"), "plasma-carbon-steel", (11.0, 7.8, 5.5, 3.9)),
        ("4 strips of 2.4 m, oxyfuel 20 mm", strips(), "oxyfuel-thick-plate", (36.0, 25.5, 18.0, 12.7)),
    )
    for name, nest, profile, widths in cases:
        given, path = planned(nest, skipping(profile))
        x0, y0, x1, y1 = given.nest.sheet.bounds
        for grid_mm in widths:
            begin_s = time.process_time()
            found = distort_path(given, path, grid_mm)
            cells = (x1 - x0) * (y1 - y0) / grid_mm**2
            took_s = time.process_time() - begin_s
            yield f"| {name} | {grid_mm:g} | {cells:.0f} | {found.mean_mm:.3f} | {found.max_mm:.3f} | {took_s:.1f} |"


def literature() -> Iterator[str]:
    """A row for each profile: our force of one side, and those of the formulas, kN."""
    yield "| cut | heat, J/mm | ours, kN | Okerblom, kN | tendon force, kN | flame-cut edge (ECCS), kN |"
    yield "|---|---:|---:|---:|---:|---:|"
    steel, heat = METALS["carbon-steel"], MATERIALS["carbon-steel"]
    for name in ("oxyfuel-thick-plate", "plasma-carbon-steel", "laser-st10kp-2mm"):
        profile = load_profile(name)
        thickness, feed = profile.material.thickness_mm, profile.machine.cut_feed_mm_s
        per_mm = profile.heat.absorbed_power_w / feed
        band = yielded("carbon-steel", thickness, profile.heat.absorbed_power_w, feed)
        okerblom = 0.335 * steel.modulus * steel.expansion / heat.capacity_j_mm3 * per_mm / 2
        eccs = 1100 * math.sqrt(thickness) / steel.yield_ * steel.yield_ * thickness
        shown = f"{eccs / 1000:.1f}" if name.startswith("oxyfuel") else "–"
        yield (
            f"| {name} | {per_mm:.0f} | {-band.at_last_n / 1000:.2f} | {okerblom / 1000:.2f} | "
            f"{0.2 * per_mm / 2:.2f} | {shown} |"
        )


TRANSFORMS_C = 720.0
"""Above this steel changes its structure: the edge of the heat-affected zone (Ac1 of structural steel, rounded)."""
MEASURED_MM = {"oxyfuel-thick-plate": "0.85 (oxyfuel cut)", "plasma-carbon-steel": "0.7 (plasma cut, 15 mm of S460M)"}
"""Martín-Meizoso et al. 2014, Frattura ed Integrità Strutturale 30:14-22; Aldazabal et al. 2018, Metals 8:447."""


def zones() -> Iterator[str]:
    """A row for each profile: how deep from the edge the line source of the model heats metal over `TRANSFORMS_C`."""
    yield "| cut | heat, J/mm² | over 720 °C, ours, mm | heat-affected zone, measured, mm |"
    yield "|---|---:|---:|---:|"
    for name in ("oxyfuel-thick-plate", "plasma-carbon-steel", "laser-st10kp-2mm"):
        profile = load_profile(name)
        per_mm2 = profile.heat.absorbed_power_w / profile.machine.cut_feed_mm_s / profile.material.thickness_mm
        excess_k = TRANSFORMS_C - profile.heat.ambient_c
        capacity = MATERIALS[profile.heat.material].capacity_j_mm3
        deep_mm = per_mm2 / capacity / math.sqrt(2 * math.pi * math.e) / excess_k
        yield f"| {name} | {per_mm2:.1f} | {deep_mm:.2f} | {MEASURED_MM.get(name, '–')} |"


def strip() -> Iterator[str]:
    """A row for each way to look at strips."""
    yield "| 4 strips of 2400 × 90 mm, oxyfuel 20 mm | mean of parts, mm | worst, mm |"
    yield "|---|---:|---:|"
    given, path = planned(strips(), skipping("oxyfuel-thick-plate"))
    for name, yields in (("elastic", False), ("yielding beside the cut", True)):
        found = distort_path(given, path, 25.5, yields)
        yield f"| {name} | {found.mean_mm:.2f} | {found.max_mm:.2f} |"


def speed() -> Iterator[str]:
    """A row for each size and cell width."""
    yield "| contours | sheet, mm | cell, mm | CPU s | memory, MB |"
    yield "|---:|---|---:|---:|---:|"
    for contours, size in ((40, (3000.0, 1500.0)), (115, (6000.0, 1500.0))):
        nest = read_json(json.dumps(make_sheet(7, contours, size, 30.0)).encode(), ReadOptions())
        given, path = planned(nest, skipping("oxyfuel-thick-plate"))
        grid_mm = math.sqrt(size[0] * size[1] / 7200)
        begin_s = time.process_time()
        distort_path(given, path, grid_mm)
        took_s = time.process_time() - begin_s
        count = len(given.nest.contours)
        yield f"| {count} | {size[0]:g} × {size[1]:g} | {grid_mm:.1f} | {took_s:.1f} | {peak_mb():.0f} |"


TABLES = {"convergence": convergence, "literature": literature, "zones": zones, "strip": strip, "speed": speed}


def main() -> None:
    """Print the tables that are named, or all."""
    if wrong := [name for name in sys.argv[1:] if name not in TABLES]:
        sys.exit(f"{wrong[0]}: expected {', '.join(TABLES)}")
    for name in sys.argv[1:] or TABLES:
        print(f"\n{name}\n")
        for row in TABLES[name]():
            print(row, flush=True)


if __name__ == "__main__":
    main()
