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
FINE_MM = 0.01
"""A web may be narrower than a kerf by so much, and still carries."""
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
    frame = frame_of(metal, shapely.union_all(list(burnt.values())), kerf_mm)
    if frame is None:
        return
    inside = shapely.point_on_surface(frame)
    for k, line in lines:
        if not in_frame(line.line, metal, inside, kerf_mm):
            yield line.id, k
        metal -= burnt[line.id]


def bounding(nest: Nest, kerf_mm: float) -> tuple[set[str], set[tuple[str, str]]]:
    """The scrap lines that bound the frame, or no piece, and the pairs that bound one, each both ways round."""
    framed: set[str] = set()
    beside_some: set[str] = set()
    pairs: set[tuple[str, str]] = set()
    if not nest.scrap:
        return framed, pairs
    metal, burnt = _without_parts(nest, kerf_mm), shapely.union_all(list(_burnt(nest, kerf_mm).values()))
    pieces, frame = _pieces(metal - burnt, kerf_mm), frame_of(metal, burnt, kerf_mm)
    for piece in pieces:
        near = piece.buffer(kerf_mm / 2 + NEAR_MM)
        own = [line for line in nest.scrap if near.intersection(line.line).length > _asked_mm(line.line, kerf_mm)]
        pairs |= {(a.id, b.id) for a in own for b in own if a is not b}
        beside_some |= {line.id for line in own}
        if frame is not None and piece.equals(frame):
            framed = {line.id for line in own}
    return framed | ({line.id for line in nest.scrap} - beside_some if pieces else set()), pairs


def _without_parts(nest: Nest, kerf_mm: float) -> shapely.Geometry:
    """The skeleton before any line is cut."""
    gone = shapely.union_all([part.outer.polygon.buffer(kerf_mm, quad_segs=4) for part in nest.parts])
    return wide_enough(shapely.make_valid(nest.sheet.polygon) - gone, kerf_mm)


def wide_enough(metal: shapely.Geometry, kerf_mm: float) -> shapely.Geometry:
    """What of metal can carry: not what is narrower than a kerf, which a line along it would burn away."""
    half_mm = max(kerf_mm / 2 - FINE_MM, 0.0)
    return metal.buffer(-half_mm, quad_segs=4).buffer(half_mm, quad_segs=4) & metal


def _burnt(nest: Nest, kerf_mm: float) -> dict[str, shapely.Geometry]:
    """What each line burns away."""
    return {line.id: line.line.buffer(kerf_mm / 2, quad_segs=4) for line in nest.scrap}


def frame_of(metal: shapely.Geometry, burnt: shapely.Geometry, kerf_mm: float) -> shapely.Polygon | None:
    """The frame when all lines have burnt what they burn of a skeleton; None where nothing is left."""
    uncut = _pieces(metal, kerf_mm)
    pieces = _pieces(largest_of(uncut) - burnt, kerf_mm) if uncut else []
    return largest_of(pieces) if pieces else None


def in_frame(line: shapely.Geometry, metal: shapely.Geometry, inside: shapely.Point, kerf_mm: float) -> bool:
    """Whether a line lies in the piece of metal around a point, or along it, or in none at all."""
    beside = [piece for piece in _pieces(metal, kerf_mm) if _along(line, piece, kerf_mm)]
    return not beside or any(piece.intersects(inside) for piece in beside)


def _along(line: shapely.Geometry, piece: shapely.Polygon, kerf_mm: float) -> bool:
    if shapely.distance(line, piece) > kerf_mm / 2:
        return False
    return bool(piece.buffer(kerf_mm / 2).intersection(line).length > _asked_mm(line, kerf_mm))


def _asked_mm(line: shapely.Geometry, kerf_mm: float) -> float:
    """How much of a line lies at a piece that it bounds, at the least: more than an end that merely touches it."""
    return float(min(END_MM + kerf_mm, line.length / 4))


def largest_of(pieces: Sequence[shapely.Polygon]) -> shapely.Polygon:
    """The largest piece; of those as large the lowest, then the leftmost."""
    most = max(piece.area for piece in pieces)
    large = [piece for piece in pieces if piece.area >= AS_LARGE * most]
    return min(large, key=lambda piece: (round(piece.bounds[1]), round(piece.bounds[0])))


def _pieces(metal: shapely.Geometry, kerf_mm: float) -> list[shapely.Polygon]:
    """What holds together; crumbs are none."""
    return [piece for piece in shapely.get_parts(metal) if piece.area > kerf_mm**2]
