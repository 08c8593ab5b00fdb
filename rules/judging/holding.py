"""What metal hangs together, what scrap lines cut loose, and what the cuts of others burn, by plain geometry."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass

import numpy as np
import shapely

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.geometry.tolerances import tolerance_mm
from kerfwise.encoder.nest import Contour, Nest, Part, cached_with_nest

from .facing import EDGE, SOLID, facing, spots_along_each
from .metal import host_holes, places

# Which parts hang together, and which on the frame of the sheet: the judging half of rule no-islands.

FRAME = -1
STEP_MM, LEAST_SPOTS = 2.0, 160

Graph = Mapping[int, Set[int]]


@cached_with_nest(most=2)
def holding(nest: Nest, web_mm: float, edge_band_mm: float, frame_share: float) -> tuple[Graph, frozenset[int]]:
    """Part number → parts in the same place that it faces or that face it; and the parts that hang on the frame.

    Kept with the nest: a plan and its program ask for the same.
    """
    at = places(nest, host_holes(nest))
    place = [at[part.id] for part in nest.parts]
    around = [(k, part.outer.line, part.outer.line.length) for k, part in enumerate(nest.parts)]
    every = spots_along_each([(k, line, 0.0, mm, max(LEAST_SPOTS, int(mm / STEP_MM))) for k, line, mm in around])
    faced = facing(nest, web_mm, edge_band_mm).faced(every)
    joined: dict[int, set[int]] = {k: set() for k in range(len(nest.parts))}
    framed: set[int] = set()
    pairs = np.unique((every.part * len(nest.parts) + faced)[faced >= 0])
    for k, other in (divmod(pair, len(nest.parts)) for pair in pairs.tolist()):
        if place[k] == place[other]:
            joined[k].add(other)
            joined[other].add(k)
        else:
            framed.add(k)
    steady = np.bincount(every.part[(faced == EDGE) | (faced == SOLID)], minlength=len(nest.parts))
    count = np.bincount(every.part, minlength=len(nest.parts))
    framed.update(np.flatnonzero(steady >= frame_share * count).tolist())
    return joined, frozenset(framed)


def clusters(joined: Graph) -> Iterator[list[int]]:
    """The sets that hang together, each sorted, by their smallest member.

    Examples
    --------
    >>> list(clusters({0: {2}, 1: set(), 2: {0}}))
    [[0, 2], [1]]
    """
    seen: set[int] = set()
    for start in sorted(joined):
        if start in seen:
            continue
        seen.add(start)
        reached = [start]
        for k in reached:
            new = sorted(joined[k] - seen)
            seen.update(new)
            reached += new
        yield sorted(reached)


def island_cuts(
    cluster: Sequence[int], joined: Graph, framed: Set[int], cut_at: Mapping[int, int]
) -> Iterator[tuple[int, list[int]]]:
    """Position of each cut that leaves parts of the cluster on an island, and these parts.

    The cluster is put together again from the last cut to the first: pieces that are apart before a part is put back,
    and together afterwards, are those that its cut sets apart. The one on the frame stays, where there is a frame,
    else the one that lasts longest; the others are islands. Parts without a position are never cut, and set none apart.
    """
    after_all = max(cut_at.values(), default=0) + 1
    order = sorted(cluster, key=lambda k: (-cut_at.get(k, after_all), k))
    piece: dict[int, int] = {}
    members: dict[int, list[int]] = {}
    if any(k in framed for k in cluster):
        piece[FRAME], members[FRAME] = FRAME, []
    for rank, k in enumerate(order):
        near = {piece[x] for x in joined[k] if x in piece} | ({FRAME} if k in framed else set())
        stays, *islands = sorted(near) or [rank]
        if k in cut_at:
            yield from ((cut_at[k], sorted(members[island])) for island in islands)
        one = members.setdefault(stays, [])
        for new in ([k], *(members.pop(island) for island in islands)):
            one += new
            piece.update(dict.fromkeys(new, stays))


# Scrap lines that are cut in loose metal, by plain geometry: the judging half of rule scrap-last.
#
# Line after line is taken out of the skeleton, in the order of the cuts, and what is left falls into pieces.

AS_LARGE = 0.999
"""Pieces of so much of the largest one count as large as it."""
FINE_MM = 0.01
"""A web may be narrower than a kerf by so much, and still carries."""
NEAR_MM = 0.02
"""Chords and kerfs may lie so far apart where they meet."""
END_MM = 1.0
"""A line that ends on another may go on so far beyond it."""


def loose_scrap_cuts(nest: Nest, cuts: CutSequence, kerf_mm: float) -> Iterator[tuple[str, int]]:
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
        if not is_in_frame(line.line, metal, inside, kerf_mm):
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


def is_in_frame(line: shapely.Geometry, metal: shapely.Geometry, inside: shapely.Point, kerf_mm: float) -> bool:
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


# Which parts lose metal to the cuts of others, by plain geometry: the judging half of rule shared-metal.

CHORD_MM = 0.002
"""Contours are judged by chords that lie this close to them."""
COARSE_MM = 0.05
"""What coarse chords of two contours may make of a distance, and more."""
SLACK_MM = 0.004
"""What the chords of two contours may make of a distance."""


@dataclass(frozen=True, slots=True)
class Burnt:
    """Two contours of different parts, one of which burns the other's part: the gap between them, mm, and where."""

    contours: tuple[str, str]
    gap_mm: float
    place: Point


def burnt_parts(nest: Nest, cut: Collection[str], kerf_mm: float) -> list[Burnt]:
    """Pairs of contours of which one or both are `cut`, the kerf in the waste of one reaching into the other part.

    Each pair once, in the order of the nest.
    """
    reach_mm = kerf_mm - tolerance_mm(kerf_mm) - SLACK_MM
    cutting = [c for c in nest.contours if c.id in cut and c.encloses]
    if reach_mm <= 0 or not cutting or len(nest.parts) < 2:
        return []
    cutting, beside = _nearly(nest, cutting, reach_mm + COARSE_MM)
    if not cutting:
        return []
    metal = np.array([metal_of(part) for part in beside], dtype=object)
    inside = shapely.point_on_surface(metal)
    areas = np.array([_area(c) for c in cutting], dtype=object)
    lines = np.array([c.curve.line(CHORD_MM) for c in cutting], dtype=object)
    rows, parts = shapely.STRtree(metal).query(lines, predicate="dwithin", distance=reach_mm)
    found: dict[tuple[str, str], Burnt] = {}
    for k, p in sorted(zip(rows.tolist(), parts.tolist(), strict=True)):
        contour, part = cutting[k], beside[p]
        if part.id == contour.part:
            continue
        if shapely.intersects(areas[k], inside[p]) != (contour.kind == "hole"):
            continue  # the part lies on the side that the kerf does not burn
        gap_mm = float(shapely.distance(lines[k], metal[p]))
        other = min(
            (c for c in (part.outer, *part.holes)),
            key=lambda c: round(float(shapely.distance(lines[k], c.curve.line(CHORD_MM))), 6),
        )
        one, two = sorted((contour.id, other.id), key=nest.index.__getitem__)
        middle = shapely.shortest_line(lines[k], metal[p]).centroid
        known = found.get((one, two))
        if known is None or gap_mm < known.gap_mm:
            found[one, two] = Burnt((one, two), gap_mm, (middle.x, middle.y))
    return sorted(found.values(), key=lambda b: tuple(nest.index[name] for name in b.contours))


def _nearly(nest: Nest, cutting: Sequence[Contour], reach_mm: float) -> tuple[list[Contour], list[Part]]:
    """The contours, and the parts of other contours, that are within reach in coarse chords; all where these cross."""
    metal = np.array([part.polygon for part in nest.parts], dtype=object)
    if not shapely.is_valid(metal).all():
        return list(cutting), list(nest.parts)
    lines = np.array([contour.line for contour in cutting], dtype=object)
    rows, parts = shapely.STRtree(metal).query(lines, predicate="dwithin", distance=reach_mm)
    number = {part.id: k for k, part in enumerate(nest.parts)}
    others = parts != np.array([number[contour.part] for contour in cutting])[rows]
    near, beside = np.unique(rows[others]).tolist(), np.unique(parts[others]).tolist()
    return [cutting[k] for k in near], [nest.parts[k] for k in beside]


def metal_of(part: Part) -> shapely.Geometry:
    """The metal of a part, whether shapely calls its rings valid or not."""
    holes = [_area(hole) for hole in part.holes]
    whole = _area(part.outer)
    return shapely.difference(whole, shapely.union_all(holes)) if holes else whole


def _area(contour: Contour) -> shapely.Geometry:
    area = contour.curve.polygon(CHORD_MM)
    return area if shapely.is_valid(area) else shapely.make_valid(area)
