"""Published strips, as sparrow's repository has them: instances, its records, its own runs of twenty minutes."""

from __future__ import annotations

import gzip
import io
import json
import re
import sys
import tarfile
import textwrap
import time
import zipfile
from collections.abc import Iterator
from pathlib import Path

import shapely

from kerfwise.apps.nesting.nests import Nested, nests_from
from kerfwise.apps.nesting.placement import sparrow
from kerfwise.apps.nesting.placement.demand import Demand, PartType, Spacing, Stock
from kerfwise.apps.nesting.placement.fill import LEFT, largest_first
from kerfwise.apps.nesting.placement.layout import Layout, allot
from kerfwise.apps.nesting.placement.rounds import Effort, layouts
from kerfwise.apps.nesting.placement.shapes import Shapes
from kerfwise.apps.nesting.placement.sparrow import compact_layout
from kerfwise.encoder.nest import Sheet
from kerfwise.rules.case import part

HEIGHT_MM = 1000.0
"""Instances are scaled so that their strip is so high."""
TOUCHING = Spacing(0.0, 0.0)
NAMES = ("shirts", "swim", "trousers", "gardeyn4")


def strips(checkout: Path, rounds: int, seconds: float) -> Iterator[str]:
    """The section of the page: densities of the strip up to the last part."""
    yield "\n## Strips\n"
    yield paragraph(
        "Instances of the field (ESICUP), and one of those that sparrow's authors added, from a checkout of",
        "[sparrow](https://github.com/JeroenGar/sparrow) (MIT): outlines only, touching, turned as the instance",
        "allows. Density is that of the strip up to the last part. *Bottom-left* is one round: the largest first,",
        f"as far left as it goes. *Rounds* are {rounds} rounds of kerfwise, with the processor's seconds. *Sparrow",
        f"here* makes that denser for {seconds:g} s by the clock on two threads, on a machine that did other",
        "things too.",
    )
    yield paragraph(
        "*Published* are sparrow's own figures, read from its repository: the mean of its runs of 1200 s",
        "(`data/experiments/benchmark_runs`) and its record (`data/records`): Gardeyn, Vanden Berghe and Wauters",
        "2025, An open-source heuristic to reboot 2D nesting research, arXiv:2509.13329.",
    )
    yield "| instance | parts | bottom-left | s | rounds | s | sparrow here | published, mean | published, record |"
    yield "|---|---:|---:|---:|---:|---:|---:|---:|---:|"
    for name in NAMES:
        if (file := checkout / "data" / "input" / f"{name}.json").is_file():
            yield _row(name, json.loads(file.read_text(encoding="utf-8")), checkout, rounds, seconds)


def _row(name: str, data: dict, checkout: Path, rounds: int, seconds: float) -> str:  # type: ignore[type-arg]
    wanted, scale = instance(data)
    shapes, began = Shapes(wanted.types, 0.0), time.process_time()
    plain = allot(wanted, shapes, TOUCHING, largest_first(shapes, range(len(wanted.types))), LEFT)
    plain_s, began = time.process_time() - began, time.process_time()
    own = max(layouts(wanted, TOUCHING, Effort(rounds)), key=lambda layout: density(nests_from(layout)))
    own_s = time.process_time() - began
    packed = "–"
    if sparrow.installed():
        packed = f"{density(sound(compact_layout(own, shapes, seconds, 1, print))):.3f}"
    cells = (
        name, str(sum(kind.quantity for kind in wanted.types)), f"{density(sound(plain)):.3f}", f"{plain_s:.0f}",
        f"{density(sound(own)):.3f}", f"{own_s:.0f}", packed, _mean(name, checkout),
        _record(name, wanted.area_mm2 / scale**2, checkout),
    )  # fmt: skip
    return f"| {' | '.join(cells)} |"


def instance(data: dict) -> tuple[Demand, float]:  # type: ignore[type-arg]
    """An instance as an order on one strip that is long enough, and by how much it is scaled."""
    scale = HEIGHT_MM / data["strip_height"]
    types = []
    for item in data["items"]:
        rows = [(x * scale, y * scale) for x, y in item["shape"]["data"]]
        name = f"P{item['id']}"
        turns = tuple(float(turn) for turn in item["allowed_orientations"])
        types.append(
            PartType(name, part(name, rows[:-1] if rows[0] == rows[-1] else rows), item["demand"], turns_deg=turns)
        )
    area_mm2 = sum(kind.area_mm2 * kind.quantity for kind in types)
    strip = Sheet.rectangle(round(1.8 * area_mm2 / HEIGHT_MM), HEIGHT_MM)
    return Demand(tuple(types), (Stock("strip", strip, 1),)), scale


def density(nested: Nested) -> float:
    """Of the strip up to the last part; 0 where parts are missing."""
    layout: Layout = nested.layout
    if any(layout.missing):
        return 0.0
    [sheet] = layout.sheets
    _, _, reach, _ = shapely.total_bounds(layout.metal_of(sheet)).tolist()
    return float(layout.wanted.area_mm2 / (reach * HEIGHT_MM))


def _mean(name: str, checkout: Path) -> str:
    """The mean density of sparrow's own runs, from the log that its repository keeps."""
    file = checkout / "data" / "experiments" / "benchmark_runs" / f"{name}-results.zip"
    if not file.is_file():
        return "–"
    with zipfile.ZipFile(file) as packed:
        inner = packed.read(packed.namelist()[0])
    with tarfile.TarFile(fileobj=gzip.GzipFile(fileobj=io.BytesIO(inner))) as files:
        log = next(member for member in files if member.name.endswith(".log"))
        content = files.extractfile(log)
        text = "" if content is None else content.read().decode()
    found = re.search(r"USAGE STATS.*?avg: +([\d.]+)", text, re.DOTALL)
    return f"{float(found[1]) / 100:.3f}" if found else "–"


def _record(name: str, area: float, checkout: Path) -> str:
    """The density of sparrow's best layout, from the strip that its picture shows."""
    file = checkout / "data" / "records" / f"final_best_{name}.svg"
    found = (
        re.search(r'd="M0,0 L([\d.]+),0 L[\d.]+,([\d.]+)', file.read_text(encoding="utf-8")) if file.is_file() else None
    )
    return f"{area / (float(found[1]) * float(found[2])):.3f}" if found else "–"


def sound(layout: Layout) -> Nested:
    """The nests of a layout; a fault that the check finds ends the run."""
    nested = nests_from(layout)
    if nested.faults:
        sys.exit("\n".join(nested.faults))
    return nested


def paragraph(*sentences: str) -> str:
    """Sentences in lines of a page, and an empty line after them."""
    return textwrap.fill(" ".join(sentences), 118, break_long_words=False, break_on_hyphens=False) + "\n"
