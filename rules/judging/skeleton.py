"""Scrap lines that are cut in loose metal, by plain geometry: the judging half of rule scrap-last.

Line after line is taken out of the skeleton, in the order of the cuts, and what is left falls into pieces.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import shapely

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.nest import Nest

AS_LARGE = 0.999
"""Pieces of so much of the largest one count as large as it."""
NEAR_MM = 0.02
"""Chords and kerfs may lie so far apart where they meet."""
END_MM = 1.0
"""A line that ends on another may go on so far beyond it."""


def cut_loose(nest: Nest, cuts: CutSequence, kerf_mm: float) -> Iterator[tuple[str, int]]:
    """The scrap lines that lie outside the frame when they are cut, and the positions of their cuts."""
    lines = [
        (k, nest.contour(cut.contour)) for k, cut in enumerate(cuts, 1) if nest.contour(cut.contour).kind == "scrap"
    ]
    if not lines:
        return
    metal, burnt = _without_parts(nest, kerf_mm), _burnt(nest, kerf_mm)
    inside = point_of_frame(metal - shapely.union_all(list(burnt.values())), kerf_mm)
    if inside is None:
        return
    for k, line in lines:
        if not in_frame(line.line, metal, inside, kerf_mm):
            yield line.id, k
        metal -= burnt[line.id]


def bounding(nest: Nest, kerf_mm: float) -> tuple[set[str], set[tuple[str, str]]]:
    """The scrap lines that bound the frame, and the pairs of lines that bound one piece, each both ways round."""
    framed: set[str] = set()
    pairs: set[tuple[str, str]] = set()
    if not nest.scrap:
        return framed, pairs
    left = _without_parts(nest, kerf_mm) - shapely.union_all(list(_burnt(nest, kerf_mm).values()))
    pieces = _pieces(left, kerf_mm)
    largest = _frame(pieces) if pieces else None
    for piece in pieces:
        near = piece.buffer(kerf_mm / 2 + NEAR_MM)
        own = [line for line in nest.scrap if near.intersection(line.line).length > _asked_mm(line.line, kerf_mm)]
        pairs |= {(a.id, b.id) for a in own for b in own if a is not b}
        if piece is largest:
            framed = {line.id for line in own}
    return framed, pairs


def _without_parts(nest: Nest, kerf_mm: float) -> shapely.Geometry:
    """The skeleton before any line is cut."""
    gone = shapely.union_all([part.outer.polygon.buffer(kerf_mm, quad_segs=4) for part in nest.parts])
    return shapely.make_valid(nest.sheet.polygon) - gone


def _burnt(nest: Nest, kerf_mm: float) -> dict[str, shapely.Geometry]:
    """What each line burns away."""
    return {line.id: line.line.buffer(kerf_mm / 2, quad_segs=4) for line in nest.scrap}


def point_of_frame(metal: shapely.Geometry, kerf_mm: float) -> shapely.Point | None:
    """A point of the frame of a skeleton that is all cut up; None where nothing is left."""
    pieces = _pieces(metal, kerf_mm)
    return shapely.point_on_surface(_frame(pieces)) if pieces else None


def in_frame(line: shapely.Geometry, metal: shapely.Geometry, inside: shapely.Point, kerf_mm: float) -> bool:
    """Whether a line lies in the piece of metal around a point, or along it."""
    held = next((piece for piece in _pieces(metal, kerf_mm) if piece.intersects(inside)), None)
    return held is not None and held.buffer(kerf_mm / 2).intersection(line).length > _asked_mm(line, kerf_mm)


def _asked_mm(line: shapely.Geometry, kerf_mm: float) -> float:
    """How much of a line lies at a piece that it bounds, at the least: more than an end that merely touches it."""
    return float(min(END_MM + kerf_mm, line.length / 4))


def _frame(pieces: Sequence[shapely.Polygon]) -> shapely.Polygon:
    """The largest piece; of those as large the lowest, then the leftmost."""
    most = max(piece.area for piece in pieces)
    large = [piece for piece in pieces if piece.area >= AS_LARGE * most]
    return min(large, key=lambda piece: (round(piece.bounds[1]), round(piece.bounds[0])))


def _pieces(metal: shapely.Geometry, kerf_mm: float) -> list[shapely.Polygon]:
    """What holds together; crumbs are none."""
    return [piece for piece in shapely.get_parts(metal) if piece.area > kerf_mm**2]
