"""Contours of which something was not cut."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence

import numpy as np
import shapely

from kerfwise.tests.metal.burns import Burn
from kerfwise.tests.metal.drawing import Drawing, Meant
from kerfwise.tests.metal.findings import Finding
from kerfwise.tests.metal.program import Path
from kerfwise.tests.metal.tolerances import NUMERIC_MM, RING_MM

Tabs = Mapping[str, Sequence[tuple[float, float, float]]]
"""Contour id → x, y and width of each stretch that is to stay uncut: the metal that stays, mm."""


def uncut(
    drawing: Drawing,
    burns: Sequence[Burn],
    kerf_mm: float,
    tabs: Tabs,
    features_kerfs: float = 1.0,
) -> Iterator[Finding]:
    """Contours where metal stays that a torch could have burnt, but for tabs, and features too narrow for it.

    Features are lost where they are further than so many kerfs from every burn. Where they may be left to any depth,
    the torch could have burnt what it reaches from the side of a neck that it was on.
    """
    lines = np.array([b.line for b in burns], dtype=object)
    tree = shapely.STRtree(lines)
    own = {b.contour.id: k for k, b in enumerate(burns) if b.contour is not None}
    for contour in drawing.closed:
        near = sorted(tree.query(contour.line, predicate="dwithin", distance=kerf_mm + RING_MM).tolist())
        if contour.id in own:  # nearly always enough by itself
            near = [own[contour.id], *(k for k in near if k != own[contour.id])]
        cut = burns[own[contour.id]].cut if contour.id in own else 0
        spared = [
            shapely.Point(x, y).buffer((width + kerf_mm) / 2 + RING_MM) for x, y, width in tabs.get(contour.id, ())
        ]
        left = shapely.union_all(spared)
        yield from _of_one(contour, [lines[k] for k in near], kerf_mm, cut, left, features_kerfs)
    for line in drawing.scrap:
        near = sorted(tree.query(line.line, predicate="dwithin", distance=kerf_mm).tolist())
        left = _beyond(line.line, [lines[k] for k in near], RING_MM)
        if left.length > NUMERIC_MM:
            cut = burns[own[line.id]].cut if line.id in own else 0
            yield _finding("left-uncut", line, cut, left, "the scrap line is not cut for")


def _of_one(
    contour: Meant, near: list[shapely.Geometry], kerf_mm: float, cut: int, spared: shapely.Geometry, kerfs: float
) -> Iterator[Finding]:
    edge = contour.reachable(kerf_mm)
    if math.isinf(kerfs) and near:
        edge = min(shapely.get_parts(edge), key=near[0].distance)
    reachable = contour.line.intersection(edge.buffer(NUMERIC_MM))
    stays = _beyond(reachable, near, kerf_mm / 2 + RING_MM).difference(spared)
    if stays.length > NUMERIC_MM:
        yield _finding("left-uncut", contour, cut, stays, "metal stays on the contour for")
        return
    if math.isinf(kerfs):
        return
    lost = _beyond(contour.line, near, kerfs * kerf_mm + RING_MM).difference(spared)
    if lost.length > NUMERIC_MM:
        text = "a slot, notch or corner that the kerf cannot enter is lost, contour not reached for"
        yield _finding("feature-lost", contour, cut, lost, text)


def _beyond(line: shapely.Geometry, near: list[shapely.Geometry], within_mm: float) -> shapely.Geometry:
    """What of a line is further than that from every burn."""
    for burn in near:
        if line.is_empty:
            break
        line = line.difference(burn.buffer(within_mm, quad_segs=16))
    return line


def unmarked(drawing: Drawing, paths: Sequence[Path]) -> Iterator[Finding]:
    """Marks that the marking tool does not follow."""
    made = shapely.union_all(
        [shapely.linestrings(p.points).buffer(RING_MM) for p in paths if not p.burns and len(p.points) > 1]
    )
    for mark in drawing.marks:
        left = mark.line.difference(made)
        if left.length > NUMERIC_MM:
            yield _finding("mark-not-made", mark, 0, left, "the mark is not made for")


def wrong_spots(
    drawing: Drawing, spotted: Collection[str], left_out: Collection[str], limit_mm: float, paths: Sequence[Path]
) -> Iterator[Finding]:
    """Holes that are not cut though they are not small, and those that are to be marked at their middle and are not.

    That nothing burns in them is judged with the metal of their part.
    """
    marks = [shapely.linestrings(p.points) for p in paths if not p.burns and len(p.points) > 1]
    for hole in (c for c in drawing.contours if c.id in {*spotted, *left_out}):
        assert hole.area is not None
        across_mm = 2 * float(shapely.maximum_inscribed_circle(hole.area, tolerance=1e-3).length)
        if across_mm > limit_mm + RING_MM:
            yield _finding("hole-not-small", hole, 0, hole.line, f"not cut, and {across_mm:.2f} mm across, for")
        made = any(hole.area.contains(m) and m.distance(hole.area.centroid) < SPOT_MM for m in marks)
        if hole.id in spotted and not made:
            yield _finding("mark-not-made", hole, 0, hole.line, "no spot is made at the middle of the hole of")


SPOT_MM = 0.1
"""How far from the middle of a small hole its spot may pass."""


def _finding(kind: str, contour: Meant, cut: int, where: shapely.Geometry, text: str) -> Finding:
    x, y = (float(v) for v in shapely.get_coordinates(where)[0])
    return Finding(kind, cut, (contour.id,), (x, y), float(where.length), "mm", text)  # type: ignore[arg-type]
