"""The same line drawn twice would be cut twice: it is taken out once, and that is said."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Contour, Note, Part

from .tolerances import COINCIDE_MM

MOST_ALIKE = 1000
"""Lines with the same box that are compared: each with each, so that the work goes with the square."""


def coincident(curves: Sequence[Curve]) -> list[tuple[int, int]]:
    """Pairs i < j of curves that run along the same line, whichever way round and wherever they start.

    Raises
    ------
    InputError
        If so many have the same box that comparing them all would take long, with the place and how many they are.

    Examples
    --------
    >>> square = [(0, 0), (9, 0), (9, 9), (0, 9)]
    >>> coincident([Curve.of(square), Curve.of(square[::-1]), Curve.of(square).moved(1, 0)])
    [(0, 1)]
    """
    some = np.array([k for k, c in enumerate(curves) if c.segments], dtype=np.int64)
    lines = np.array([curves[k].line() for k in some.tolist()], dtype=object)
    # curves that coincide have the same bounding box, give or take the chords of their arcs
    boxes = shapely.bounds(lines)
    _expect_few(boxes)
    corners = shapely.points(boxes[:, :2])
    i, j = shapely.STRtree(corners).query(corners, predicate="dwithin", distance=2 * COINCIDE_MM)
    alike = (i < j) & (np.abs(boxes[i] - boxes[j]).max(axis=1) <= 2 * COINCIDE_MM)
    i, j = i[alike], j[alike]
    same = shapely.hausdorff_distance(lines[i], lines[j]) <= COINCIDE_MM
    return sorted(zip(some[i[same]].tolist(), some[j[same]].tolist(), strict=True))


def _expect_few(boxes: Floats) -> None:
    """Refuse boxes (n, 4) of which too many are the same, before memory is taken for all pairs of them."""
    if len(boxes) <= MOST_ALIKE:
        return
    _, first, counts = np.unique(np.round(boxes / COINCIDE_MM), axis=0, return_index=True, return_counts=True)
    worst = int(counts.argmax())
    if counts[worst] > MOST_ALIKE:
        x, y = boxes[first[worst], :2].tolist()
        raise InputError(
            f"{counts[worst]} lines lie on each other at ({x:.3f}, {y:.3f}), and at most {MOST_ALIKE} are compared: "
            "delete what is drawn more than once (in CAD often called OVERKILL or purge of duplicates)"
        )


def drop_duplicates(parts: Sequence[Part]) -> tuple[tuple[Part, ...], list[Note]]:
    """The parts without contours drawn twice, and a note for each one taken out.

    Taken out are a hole or mark that repeats another of its part, a part that repeats another with all its holes,
    and a hole that is the same line as the outside of a part lying in another hole: what is left of such a hole
    is that part's outer contour. Other coincidences are left to the checks: two different parts in one place
    overlap, and a part that fills a hole touches it.

    Every other contour keeps its id.
    """
    rings = [c for p in parts for c in (p.outer, *p.holes)]
    marks = [c for p in parts for c in p.marks]
    part_of = {p.id: p for p in parts}
    pairs = [(rings[i], rings[j]) for i, j in coincident([c.curve for c in rings])]
    pairs += [(marks[i], marks[j]) for i, j in coincident([c.curve for c in marks]) if marks[i].part == marks[j].part]
    same = {frozenset((a.id, b.id)) for a, b in pairs}
    dropped: dict[str, Note] = {}
    for first, second in pairs:
        keep, drop = (second, first) if (first.kind, second.kind) == ("hole", "outer") else (first, second)
        if keep.id in dropped or drop.id in dropped:
            continue
        if keep.kind == drop.kind == "outer":
            gone, kept = part_of[drop.part], part_of[keep.part]
            if all(any(frozenset((c.id, d.id)) in same for d in kept) for c in gone):
                text = f"part {gone.id} is the same as part {kept.id}, in the same place; it is cut once, as {kept.id}"
                dropped |= {c.id: Note("warning", text, (drop.id, keep.id)) for c in gone}
        elif (keep.part, keep.kind) == (drop.part, drop.kind) or _fills_what_is_left(keep, drop, part_of[drop.part]):
            text = f"{drop.id} is the same line as {keep.id}; it is cut once, as {keep.id}"
            dropped[drop.id] = Note("warning", text, (drop.id, keep.id), common=keep.part != drop.part)
    left = tuple(_without(p, dropped) for p in parts if p.outer.id not in dropped)
    return left, list(dict.fromkeys(dropped.values()))


def _fills_what_is_left(outer: Contour, hole: Contour, host: Part) -> bool:
    """True when a hole is the outline of another part, and that part lies in another hole of the same host."""
    if outer.kind != "outer" or hole.kind != "hole" or outer.part == hole.part:
        return False
    others = [h.polygon for h in host.holes if h.id != hole.id and h.polygon.is_valid]
    return any(p.covers(outer.line) for p in others)


def _without(part: Part, dropped: dict[str, Note]) -> Part:
    if not any(c.id in dropped for c in part):
        return part
    holes = tuple(h for h in part.holes if h.id not in dropped)
    return replace(part, holes=holes, marks=tuple(m for m in part.marks if m.id not in dropped))
