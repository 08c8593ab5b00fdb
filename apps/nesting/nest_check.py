"""Nests held against what was asked for: overlaps, gaps, edges, copies, quantities and sheets, by geometry alone."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely import affinity

from kerfwise.encoder.display import join_names
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.graphs import weak_components
from kerfwise.encoder.nest import Contour, Nest, Part, Sheet
from kerfwise.encoder.readers.json_nest import read_json
from kerfwise.encoder.readers.options import ReadOptions
from kerfwise.encoder.validate import validated

SLACK_MM = 0.01
"""Distances may be less by this: arcs are chords here."""
_OF = "of"


def nest_faults(
    written: Mapping[str, bytes],
    parts: Sequence[RequestedPart],
    sheets: Sequence[RequestedSheet],
    spacing: RequestedSpacing,
) -> list[str]:
    """Every fault of a set of nests, a sentence each; none where all is as it was asked for.

    `written`: the content of each nest file (kerfwise-nest/1), by the name that is told. `parts`: what was asked for.
    Each part of a nest says under `of` which of them it is. `sheets`: what there is to cut from. `spacing`: least
    distances.
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
        faults += (f"{name}: {text}" for text in _of_nest(nest, by_name, spacing))
    faults += _quantities(nests, parts)
    faults += _stock(nests, sheets)
    return faults


def _of_nest(nest: Nest, requested: Mapping[str, RequestedPart], spacing: RequestedSpacing) -> Iterator[str]:
    for part in nest.parts:
        known = requested.get(str(part.attributes.get(_OF)))
        if known is None:
            yield f"{part.id} is of no part that was asked for"
        elif wrong := copy_problem(part, known):
            yield f"{part.id} {wrong}"
    yield from _too_near(nest.parts, spacing)
    yield from _edge_gap_faults(nest, spacing.edge_mm)


def _too_near(parts: Sequence[Part], spacing: RequestedSpacing) -> Iterator[str]:
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
            and not _is_nested(parts[i], parts[j])
        ):
            yield f"{parts[i].id} and {parts[j].id} are {mm:.3f} mm apart, and {gap_mm:g} mm were asked for"


def _is_nested(one: Part, other: Part) -> bool:
    """Whether one of two parts lies in a hole of the other, where no edge is cut once."""
    a, b = one.outer.polygon, other.outer.polygon
    return bool(a.covers(b) or b.covers(a))


def _groups(
    parts: Sequence[Part], apart_mm: Mapping[tuple[int, int], float], common: CommonEdgeLimits
) -> dict[int, int]:
    """The number of each part's group: those that hang together by edges a kerf apart, one of them as long as asked."""
    within_mm = common.tolerance_mm + SLACK_MM
    edges = {
        (i, j): mm
        for (i, j), apart in apart_mm.items()
        if abs(apart - common.apart_mm) <= within_mm
        and not _is_nested(parts[i], parts[j])
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


def _edge_gap_faults(nest: Nest, edge_mm: float) -> Iterator[str]:
    border, ground = nest.sheet.polygon.boundary, nest.sheet.polygon.buffer(SLACK_MM)
    for part in nest.parts:
        if not ground.covers(part.polygon):
            yield f"{part.id} is not on the sheet"
        elif (apart_mm := shapely.distance(part.polygon, border)) < edge_mm - SLACK_MM:
            yield f"{part.id} is {apart_mm:.3f} mm from the edge of the sheet, and {edge_mm:g} mm were asked for"


def _quantities(nests: Mapping[str, Nest], parts: Sequence[RequestedPart]) -> Iterator[str]:
    laid = Counter(str(part.attributes.get(_OF)) for nest in nests.values() for part in nest.parts)
    for requested in parts:
        there = laid[requested.name]
        if there > requested.quantity:
            yield f"{there} of {requested.name} were laid, and {requested.quantity} are wanted"
        elif requested.count is not None and there != requested.count:
            yield f"{there} of {requested.name} were laid, and the table says {requested.count}"
    names = Counter(part.id for nest in nests.values() for part in nest.parts)
    yield from (f"{count} parts are called {name}" for name, count in names.items() if count > 1)


def _stock(nests: Mapping[str, Nest], sheets: Sequence[RequestedSheet]) -> Iterator[str]:
    """Sheets of one shape are counted together, as nobody can tell them apart."""
    shapes: list[Sheet] = []
    there: list[float] = []
    for requested in sheets:
        count = float("inf") if requested.count is None else requested.count
        k = _which(requested.sheet, shapes)
        if k is None:
            shapes.append(requested.sheet)
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


# Whether a part in a nest is a copy of one that was drawn, and how it lies: by its shape alone.

SAME_MM = 0.02
"""Outlines no further apart than this are the same: each is chords within 0.01 mm."""


def copy_problem(part: Part, requested: RequestedPart) -> str | None:
    """Why a part is no copy of what was drawn, in a clause; None where it is one, turned and mirrored as is allowed."""
    counts = [(len(p.holes), len(p.marks)) for p in (part, requested.part)]
    if counts[0] != counts[1]:
        return f"has {counts[0][0]} holes and {counts[0][1]} marks, and the drawing {counts[1][0]} and {counts[1][1]}"
    if [tab.width_mm for tab in part.tabs] != [tab.width_mm for tab in requested.part.tabs]:
        return "has other tabs than the drawing"
    mirrored = bool(part.attributes.get("mirrored"))
    for one, other in zip(_contours(part), _contours(requested.part), strict=True):
        wanted = tuple(bevel and (bevel.turned_over if mirrored else bevel) for bevel in other.bevel_of_edge)
        if (one.bevelled or other.bevelled) and one.bevel_of_edge != wanted:
            found = join_names(sorted({str(bevel) for bevel in one.bevel_of_edge if bevel}), 4) or "none"
            return f"has another bevel than the drawing: {found} on {one.id}"
    if lost := _arcs_lost(part, requested.part):
        return lost
    turns = _any_turn(part, requested.part) if requested.turns_deg is None else requested.turns_deg
    if any(_matches(part, laid) for laid in _ways(requested, turns, (False, True) if requested.mirror else (False,))):
        return None
    if any(_matches(part, laid) for laid in _ways(requested, turns, (True,))):
        return "is mirrored, which is not allowed"
    if any(_matches(part, laid) for laid in _ways(requested, _any_turn(part, requested.part), (False, True))):
        return "is turned as it may not be"
    return "has another shape than the drawing"


def _ways(
    requested: RequestedPart, turns_deg: Sequence[float], flips: Sequence[bool]
) -> Iterator[list[shapely.Geometry]]:
    """The lines and tabs of the drawn part in each way that it may lie, the outline first."""
    drawn = _drawn(requested.part)
    for flip in flips:
        for turn in turns_deg:
            flipped = [affinity.scale(line, -1, 1, origin=(0, 0)) if flip else line for line in drawn]
            yield [affinity.rotate(line, turn, origin=(0, 0)) for line in flipped]


def _matches(part: Part, drawn: Sequence[shapely.Geometry]) -> bool:
    """Whether all contours and tabs coincide once the outlines are laid over each other."""
    lines = _drawn(part)
    x, y = _corner(lines[0])
    a, b = _corner(drawn[0])
    over = [affinity.translate(line, x - a, y - b) for line in drawn]
    return all(
        abs(one.length - other.length) <= SAME_MM * 10 and shapely.hausdorff_distance(one, other) <= SAME_MM
        for one, other in zip(lines, over, strict=True)
    )


def _drawn(part: Part) -> list[shapely.Geometry]:
    """The lines of the contours, the outline first, and the middles of the tabs."""
    return [*(contour.line for contour in _contours(part)), *(shapely.Point(tab.at) for tab in part.tabs)]


def _corner(line: shapely.LineString) -> tuple[float, float]:
    """Lower left corner of the box around a line."""
    x0, y0, _, _ = line.bounds
    return x0, y0


def _contours(part: Part) -> list[Contour]:
    return [part.outer, *part.holes, *part.marks]


def _arcs_lost(part: Part, drawn: Part) -> str | None:
    for mine, its in zip(_contours(part), _contours(drawn), strict=True):
        here, there = _arcs(mine.curve), _arcs(its.curve)
        if here != there:
            return f"has {here} arcs in {mine.kind}, and the drawing {there}"
    return None


def _arcs(curve: Curve) -> int:
    return sum(segment.is_arc for segment in curve.segments)


def _any_turn(part: Part, drawn: Part) -> list[float]:
    """The turns that lay the first side of the one along any side of the other that is as long."""
    one, other = (np.diff(np.asarray(p.outer.line.coords), axis=0) for p in (drawn, part))
    length = math.hypot(*one[0])
    alike = [side for side in other.tolist() if abs(math.hypot(*side) - length) < SAME_MM]
    begin = math.atan2(one[0][1], one[0][0])
    return sorted({round(math.degrees(math.atan2(dy, dx) - begin), 6) for dx, dy in alike})


# What a set of nests is held against: parts as they were drawn, sheets as they lie in the store, distances.


@dataclass(frozen=True, eq=False, slots=True)
class RequestedPart:
    """A part as it is drawn, how many may be cut at most, and how it may lie; `count` is how many were promised.

    `turns_deg` is None where any turn will do.
    """

    name: str
    part: Part
    quantity: int
    turns_deg: tuple[float, ...] | None
    mirror: bool = False
    count: int | None = None


@dataclass(frozen=True, eq=False, slots=True)
class RequestedSheet:
    """A sheet or remnant, and how many there are; None where there is no end of them."""

    name: str
    sheet: Sheet
    count: int | None = None


@dataclass(frozen=True, slots=True)
class CommonEdgeLimits:
    """Edges that are cut once: so far apart, within a tolerance, and so long at least, mm."""

    apart_mm: float
    shortest_mm: float
    tolerance_mm: float


@dataclass(frozen=True, slots=True)
class RequestedSpacing:
    """Least distances in mm: part to part, and part to the edge of the sheet; nearer are parts with a common edge."""

    gap_mm: float
    edge_mm: float
    common: CommonEdgeLimits | None = None
