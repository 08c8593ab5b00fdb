"""Each part by itself: its holes and marks must lie in it, apart from each other."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from kerfwise.encoder.nest import Contour, Note, Part

from .metal import metal_of
from .tolerances import TOUCH_MM


def hole_problems(parts: Sequence[Part]) -> tuple[list[str], list[Note]]:
    """Holes that reach out of their part or overlap each other, and notes on those that touch.

    Parameters
    ----------
    parts
        Parts whose rings are proper each.
    """
    holes = [h for p in parts for h in p.holes]
    if not holes:
        return [], []
    hosts = [p.outer for p in parts for _ in p.holes]
    inner = np.array([h.polygon for h in holes], dtype=object)
    outer = np.array([o.polygon for o in hosts], dtype=object)
    part = np.unique([h.part for h in holes], return_inverse=True)[1]
    i, j = shapely.STRtree(inner).query(inner, predicate="dwithin", distance=TOUCH_MM)
    siblings = (i < j) & (part[i] == part[j])
    i, j = i[siblings], j[siblings]

    near = shapely.distance(shapely.get_exterior_ring(inner), shapely.get_exterior_ring(outer)) < TOUCH_MM
    suspect = np.flatnonzero(near | ~shapely.covered_by(inner, outer))
    beyond = shapely.difference(inner[suspect], outer[suspect])
    common = shapely.intersection(inner[i], inner[j])

    problems: list[str] = []
    notes: list[Note] = []
    for k, area in zip(suspect.tolist(), beyond, strict=True):
        _sort_out(holes[k], hosts[k], area, "reaches out of", problems, notes)
    for a, b, area in zip(i.tolist(), j.tolist(), common, strict=True):
        _sort_out(holes[a], holes[b], area, "overlaps", problems, notes)
    return problems, notes


def _sort_out(
    one: Contour, other: Contour, area: shapely.Geometry, verb: str, problems: list[str], notes: list[Note]
) -> None:
    if thick(area):
        problems.append(f"{one.id} {verb} {other.id} {around(area)}: correct the part in CAD")
    else:
        notes.append(Note("warning", f"{one.id} touches {other.id}", (one.id, other.id)))


def mark_notes(parts: Sequence[Part]) -> list[Note]:
    """A note for each mark that runs off the metal of its part."""
    marked = [(p, m) for p in parts for m in p.marks]
    lines = np.array([m.line for _, m in marked], dtype=object)
    metal = shapely.buffer(metal_of([p for p, _ in marked]), TOUCH_MM, quad_segs=2)
    off = np.flatnonzero(~shapely.covered_by(lines, metal)).tolist()
    return [Note("warning", f"{marked[k][1].id} runs off its part", (marked[k][1].id,)) for k in off]


def thick(area: shapely.Geometry) -> bool:
    """True when an area is more than the sliver between curves that touch."""
    return not shapely.is_empty(shapely.buffer(area, -TOUCH_MM))


def around(area: shapely.Geometry) -> str:
    """A point in an area, for messages."""
    at = shapely.point_on_surface(area)
    return f"at ({at.x:.3f}, {at.y:.3f})"
