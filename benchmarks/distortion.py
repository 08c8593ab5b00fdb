"""How far `kerfwise distort` may be trusted: meshes made finer, published shrinkage beside ours, and what it costs.

Usage: python -m kerfwise.benchmarks.distortion [convergence] [literature] [camber] [zones] [strip] [speed]

convergence: the mean over the parts of each part's worst error, of three plans, on meshes of ever finer cells, each as
wide as stated and 4 % wider and narrower. literature: the force with which the band beside a cut pulls when it is cold,
beside published formulas that were fitted to measurements. camber: how far a strip cut off along one edge bends, beside
what beam theory makes of these forces. zones: how deep from the cut metal gets over 720 °C, beside measured widths of
heat-affected zones.
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

import numpy as np

import kerfwise
from kerfwise import solve
from kerfwise.apps.bench.bench_child import peak_mb
from kerfwise.apps.distortion.cutting import Cutting, cut_sheet
from kerfwise.apps.distortion.elasticity import METALS, Band, yielded
from kerfwise.apps.distortion.predict import distort_path
from kerfwise.benchmarks.distortion_rules import made_nest
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers import ReadOptions, read_nest
from kerfwise.encoder.readers.json_nest import read_json
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.jobs.heat_path import path_of_plan
from kerfwise.jobs.inputs import Inputs
from kerfwise.models.physics.heat import TimedPath
from kerfwise.models.physics.heat.timed_path import in_order, torch_on
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
            found = [distort_path(given, path, wide * grid_mm) for wide in (0.96, 1.0, 1.04)]
            took_s = (time.process_time() - begin_s) / len(found)
            cells = (x1 - x0) * (y1 - y0) / grid_mm**2
            mean, worst = (
                f"{np.mean(off):.3f} ({min(off):.3f} to {max(off):.3f})"
                for off in ([one.mean_mm for one in found], [one.max_mm for one in found])
            )
            yield f"| {name} | {grid_mm:g} | {cells:.0f} | {mean} | {worst} | {took_s:.1f} |"


PROFILES = ("oxyfuel-thick-plate", "plasma-carbon-steel", "laser-st10kp-2mm")
STEEL, HELD = METALS["carbon-steel"], MATERIALS["carbon-steel"]
STRIP_MM = (2400.0, 120.0)


def forces(profile: Profile) -> tuple[Band, float, dict[str, tuple[float, float]]]:
    """Our band of one side of a cut, the heat of the cut, J/mm, and for each formula its force, N, and depth, mm."""
    thickness, feed = profile.material.thickness_mm, profile.machine.cut_feed_mm_s
    per_mm = profile.heat.absorbed_power_w / feed
    band = yielded("carbon-steel", thickness, profile.heat.absorbed_power_w, feed)
    wide_mm = 1100 * math.sqrt(thickness) / STEEL.yield_
    found = {
        "Okerblom": (0.335 * STEEL.modulus * STEEL.expansion / HELD.capacity_j_mm3 * per_mm / 2, 0.0),
        "tendon": (200.0 * per_mm / 2, 0.0),
        "ECCS": (wide_mm * STEEL.yield_ * thickness, wide_mm / 2),
    }
    if profile.name != "oxyfuel-thick-plate":
        del found["ECCS"]  # of flames
    return band, per_mm, found


def literature() -> Iterator[str]:
    """A row for each profile: our force of one side, and those of the formulas, kN."""
    yield "| cut | heat, J/mm | ours, kN | Okerblom, kN | tendon force, kN | flame-cut edge (ECCS), kN |"
    yield "|---|---:|---:|---:|---:|---:|"
    for name in PROFILES:
        band, per_mm, found = forces(load_profile(name))
        shown = [f"{found[key][0] / 1000:.2f}" if key in found else "–" for key in ("Okerblom", "tendon", "ECCS")]
        yield f"| {name} | {per_mm:.0f} | {-band.at_last_n / 1000:.2f} | {' | '.join(shown)} |"


def camber() -> Iterator[str]:
    """A row for each profile: how far a strip cut off along one edge is bent when it is cold, mm over its length."""
    long_mm, wide_mm = STRIP_MM
    yield "| cut | ours, mm | ours as cut hot, mm | ours, beam theory, mm | Okerblom, mm | tendon, mm | ECCS, mm |"
    yield "|---|---:|---:|---:|---:|---:|---:|"
    for name in PROFILES:
        profile = load_profile(name)
        how = Cutting(20.0, profile.material.kerf_mm, profile.material.thickness_mm)
        part = {"id": "S", "outer": [[0, 0], [long_mm, 0], [long_mm, wide_mm], [0, wide_mm]]}
        sheet = {"width": long_mm, "height": 1000}
        text = json.dumps({"format": "kerfwise-nest/1", "units": "mm", "sheet": sheet, "parts": [part]})
        nest = read_json(text.encode(), ReadOptions())
        y = wide_mm + how.kerf_mm / 2
        way, end_s = np.array([[0.0, y], [long_mm, y]]), long_mm / profile.machine.cut_feed_mm_s
        path = in_order([torch_on(nest.contours[0].id, way, 0.0, end_s)], end_s)
        moved = cut_sheet(nest, path, profile.heat, how)
        bent = [np.polyfit(moved.xy[:, 0], off[:, 1], 2)[0] * long_mm**2 / 4 for off in (moved.cold, moved.off)]
        stiffness = STEEL.modulus * how.thickness_mm * wide_mm**3 / 12
        band, _, found = forces(profile)
        pulls = [(-band.at_last_n, band.depth_mm), *(found.get(key) for key in ("Okerblom", "tendon", "ECCS"))]
        bent += [p and p[0] * (wide_mm / 2 - p[1]) * long_mm**2 / 8 / stiffness for p in pulls]
        yield f"| {name} | {' | '.join('–' if mm is None else f'{mm:.2f}' for mm in bent)} |"


TRANSFORMS_C = 720.0
"""Above this steel changes its structure: the edge of the heat-affected zone (Ac1 of structural steel, rounded)."""
MEASURED_MM = {
    "oxyfuel-thick-plate": (0.85, "0.85 (oxyfuel cut)"),
    "plasma-carbon-steel": (0.7, "0.7 (plasma cut, 15 mm of S460M)"),
}
"""Martín-Meizoso et al. 2014, Frattura ed Integrità Strutturale 30:14-22; Aldazabal et al. 2018, Metals 8:447."""


def over_mm(per_mm2: float, excess_k: float, spread_mm: float = 0.0) -> float:
    """How deep a line source of J/mm² heats metal by so much at some time, its heat spread normally to begin with."""
    deep_mm = per_mm2 / HELD.capacity_j_mm3 / math.sqrt(2 * math.pi * math.e) / excess_k
    if deep_mm >= spread_mm:
        return deep_mm
    at_first_k = per_mm2 / HELD.capacity_j_mm3 / math.sqrt(2 * math.pi) / spread_mm
    return spread_mm * math.sqrt(2 * math.log(max(1.0, at_first_k / excess_k)))


def zones() -> Iterator[str]:
    """A row for each profile: how deep the line source of the model heats metal over `TRANSFORMS_C`."""
    yield "| cut | heat, J/mm² | over 720 °C, ours, mm | heat-affected zone, measured, mm | spread for it, mm |"
    yield "|---|---:|---:|---:|---:|"
    for name in PROFILES:
        profile = load_profile(name)
        excess_k = TRANSFORMS_C - profile.heat.ambient_c
        band, per_mm, found = forces(profile)
        heats = {name: per_mm / profile.material.thickness_mm}
        if "ECCS" in found:
            heats[f"{name}, heat by ECCS"] = heats[name] * found["ECCS"][0] / -band.at_last_n
        for shown, per_mm2 in heats.items():
            deep_mm = over_mm(per_mm2, excess_k)
            measured_mm, of = MEASURED_MM.get(name, (math.inf, "–"))
            spreads = np.arange(0.1, 20, 0.1)
            enough = [s for s in spreads if over_mm(per_mm2, excess_k, s) >= measured_mm]
            spread = f"{enough[-1]:.1f}" if enough and measured_mm < deep_mm else "–"
            yield f"| {shown} | {per_mm2:.1f} | {deep_mm:.2f} | {of} | {spread} |"


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


TABLES = {
    "convergence": convergence,
    "literature": literature,
    "camber": camber,
    "zones": zones,
    "strip": strip,
    "speed": speed,
}


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
