"""Nests held against what was asked for: overlaps, gaps, edges, copies, quantities and sheets, by geometry alone."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import shapely

from kerfwise.encoder.components import weak_components
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest, Part, Sheet
from kerfwise.encoder.readers.json_nest import read_json
from kerfwise.encoder.readers.options import ReadOptions
from kerfwise.encoder.validate import validated

from .asked import AskedCommon, AskedPart, AskedSheet, AskedSpacing
from .copies import wrong_copy

SLACK_MM = 0.01
"""Distances may be less by this: arcs are chords here."""
_OF = "of"


def nest_faults(
    written: Mapping[str, bytes],
    parts: Sequence[AskedPart],
    sheets: Sequence[AskedSheet],
    spacing: AskedSpacing,
) -> list[str]:
    """Every fault of a set of nests, a sentence each; none where all is as it was asked for.

    Parameters
    ----------
    written
        The content of each nest file (kerfwise-nest/1), by the name that is told.
    parts
        What was asked for. Each part of a nest says under `of` which of them it is.
    sheets
        What there is to cut from.
    spacing
        Least distances.
    """
    faults: list[str] = []
    nests: dict[str, Nest] = {}
    for name, data in written.items():
        try:
            nests[name] = validated(read_json(data, ReadOptions()))
        except InputError as error:
            faults.append(f"{name}: {error}")
    by_name = {part.name: part for part in parts}
    for name, nest in nests.items():
        faults += (f"{name}: {said}" for said in _of_nest(nest, by_name, spacing))
    faults += _quantities(nests, parts)
    faults += _stock(nests, sheets)
    return faults


def _of_nest(nest: Nest, asked: Mapping[str, AskedPart], spacing: AskedSpacing) -> Iterator[str]:
    for part in nest.parts:
        known = asked.get(str(part.attributes.get(_OF)))
        if known is None:
            yield f"{part.id} is of no part that was asked for"
        elif wrong := wrong_copy(part, known):
            yield f"{part.id} {wrong}"
    yield from _too_near(nest.parts, spacing)
    yield from _off_the_edge(nest, spacing.edge_mm)


def _too_near(parts: Sequence[Part], spacing: AskedSpacing) -> Iterator[str]:
    gap_mm, common = spacing.gap_mm, spacing.common
    metal = np.array([part.polygon for part in parts], dtype=object)
    one, other = shapely.STRtree(metal).query(metal, predicate="dwithin", distance=gap_mm)
    pairs = [(i, j) for i, j in zip(one.tolist(), other.tolist(), strict=True) if i < j]
    apart_mm = {(i, j): float(shapely.distance(metal[i], metal[j])) for i, j in pairs}
    groups = _groups(parts, apart_mm, common) if common else {}
    for (i, j), mm in apart_mm.items():
        shared = shapely.intersection(metal[i], metal[j])
        if not shapely.buffer(shared, -SLACK_MM).is_empty:  # thicker than what two chords may be off
            yield f"{parts[i].id} and {parts[j].id} overlap by {shared.area:.3f} mm²"
        elif mm < gap_mm - SLACK_MM and not (
            common
            and i in groups
            and groups.get(j) == groups[i]
            and mm >= common.apart_mm - common.tolerance_mm - SLACK_MM
            and not _one_in_the_other(parts[i], parts[j])
        ):
            yield f"{parts[i].id} and {parts[j].id} are {mm:.3f} mm apart, and {gap_mm:g} mm were asked for"


def _one_in_the_other(one: Part, other: Part) -> bool:
    """Whether one of two parts lies in a hole of the other, where no edge is cut once."""
    a, b = one.outer.polygon, other.outer.polygon
    return bool(a.covers(b) or b.covers(a))


def _groups(parts: Sequence[Part], apart_mm: Mapping[tuple[int, int], float], common: AskedCommon) -> dict[int, int]:
    """The number of each part's group: those that hang together by edges a kerf apart, one of them as long as asked."""
    within_mm = common.tolerance_mm + SLACK_MM
    edges = {
        (i, j): mm
        for (i, j), apart in apart_mm.items()
        if abs(apart - common.apart_mm) <= within_mm
        and not _one_in_the_other(parts[i], parts[j])
        and (mm := _shared_mm(parts[i], parts[j], common.apart_mm + within_mm)) > common.apart_mm
    }
    group = weak_components(len(parts), np.array(list(edges), dtype=np.int64).reshape(-1, 2))
    long = {int(group[i]) for (i, _), mm in edges.items() if mm >= common.shortest_mm - SLACK_MM}
    return {k: g for k, g in enumerate(group.tolist()) if g in long}


def _shared_mm(one: Part, other: Part, near_mm: float) -> float:
    """How long a straight edge of the one lies so near beside a straight edge of the other, at the most."""
    mine, its = (
        [shapely.LineString([s.start, s.end]) for s in part.outer.curve.segments if not s.is_arc]
        for part in (one, other)
    )
    if not mine or not its:
        return 0.0
    a, b = shapely.STRtree(its).query(mine, "dwithin", distance=near_mm)
    beside = shapely.intersection(np.array(mine)[a], shapely.buffer(np.array(its)[b], near_mm, cap_style="flat"))
    return float(shapely.length(beside).max(initial=0.0))


def _off_the_edge(nest: Nest, edge_mm: float) -> Iterator[str]:
    border, ground = nest.sheet.polygon.boundary, nest.sheet.polygon.buffer(SLACK_MM)
    for part in nest.parts:
        if not ground.covers(part.polygon):
            yield f"{part.id} is not on the sheet"
        elif (apart_mm := shapely.distance(part.polygon, border)) < edge_mm - SLACK_MM:
            yield f"{part.id} is {apart_mm:.3f} mm from the edge of the sheet, and {edge_mm:g} mm were asked for"


def _quantities(nests: Mapping[str, Nest], parts: Sequence[AskedPart]) -> Iterator[str]:
    laid = Counter(str(part.attributes.get(_OF)) for nest in nests.values() for part in nest.parts)
    for asked in parts:
        there = laid[asked.name]
        if there > asked.quantity:
            yield f"{there} of {asked.name} were laid, and {asked.quantity} are wanted"
        elif asked.count is not None and there != asked.count:
            yield f"{there} of {asked.name} were laid, and the table says {asked.count}"
    names = Counter(part.id for nest in nests.values() for part in nest.parts)
    yield from (f"{count} parts are called {name}" for name, count in names.items() if count > 1)


def _stock(nests: Mapping[str, Nest], sheets: Sequence[AskedSheet]) -> Iterator[str]:
    """Sheets of one shape are counted together, as nobody can tell them apart."""
    shapes: list[Sheet] = []
    there: list[float] = []
    for asked in sheets:
        count = float("inf") if asked.count is None else asked.count
        k = _which(asked.sheet, shapes)
        if k is None:
            shapes.append(asked.sheet)
            there.append(count)
        else:
            there[k] += count
    used: Counter[int] = Counter()
    for name, nest in nests.items():
        k = _which(nest.sheet, shapes)
        if k is None:
            yield f"{name}: its sheet is none of those that there are"
        else:
            used[k] += 1
    for k, count in used.items():
        if count > there[k]:
            x0, y0, x1, y1 = shapes[k].bounds
            yield f"{count} sheets of {x1 - x0:g} × {y1 - y0:g} mm are used, and there are {there[k]:g}"


def _which(sheet: Sheet, shapes: Sequence[Sheet]) -> int | None:
    for k, other in enumerate(shapes):
        if shapely.symmetric_difference(sheet.polygon, other.polygon).area < SLACK_MM * other.polygon.length:
            return k
    return None
