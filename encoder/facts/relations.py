"""How parts lie to each other and to the sheet: inside, in a concavity, ahead, long, near the heat or the offcut."""

from __future__ import annotations

import numpy as np
import shapely

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.encoder.cut import Side
from kerfwise.encoder.geometry.concavity import concavity_pairs, well_inside
from kerfwise.encoder.geometry.segment import Box

from .facts import SIDES, Because, FactOptions
from .outlines import AWAY, AXIS, OPPOSITE, ROUNDING_MM, SAME_SHARE, Outlines, narrow_sides

# Which contour lies inside which (Pristupov 2016, fig. 1; Verkhoturov et al.).
#
# Holes and marks lie in the outer contour of their part, as the nest says, and a slit in the contour that its slot is
# of. A part lies in the smallest hole of another part that its outer contour fits in. Marks and slits contain
# nothing. Scrap lines lie in no contour, and contain nothing.


def parents_of(outlines: Outlines) -> Ints:
    """Array (n,): the contour that immediately contains each contour, -1 for a part straight on the sheet.

    One point inside each outer contour is looked up among the holes, near-linear in the number of contours. Parts
    may touch the hole they lie in: a point well inside decides, and the smaller area is the one inside.
    """
    parent = np.where(outlines.is_outer | outlines.is_scrap, -1, outlines.around)
    outers, holes = outlines.outers, np.flatnonzero(~outlines.is_outer & outlines.encloses)
    inside = shapely.STRtree(shapely.point_on_surface(outlines.polygon[outers]))
    which_hole, which_outer = inside.query(outlines.polygon[holes], predicate="intersects")
    hole, outer = holes[which_hole], outers[which_outer]
    # The hole's own outer contour is asked too: areas then grow from parent to parent, and nothing goes in circles.
    room_mm2 = np.minimum(outlines.area_mm2[hole], outlines.area_mm2[outlines.own_outer[hole]])
    fits = room_mm2 > outlines.area_mm2[outer]
    hole, outer = hole[fits], outer[fits]
    by_area = np.argsort(-outlines.area_mm2[hole], kind="stable")
    parent[outer[by_area]] = hole[by_area]  # the last one written, the smallest hole, stays
    return parent


def closure_of(parent: Ints) -> Ints:
    """Array (k, 2) of all pairs (container, contained), direct or not, sorted.

    Examples
    --------
    >>> closure_of(np.array([1, 2, -1])).tolist()
    [[1, 0], [2, 0], [2, 1]]
    """
    contained, container = np.arange(len(parent)), parent
    levels = [np.empty((0, 2), dtype=np.int64)]
    while (nested := container >= 0).any():
        contained, container = contained[nested], container[nested]
        levels.append(np.column_stack([container, contained]))
        container = parent[container]
    pairs = np.concatenate(levels)
    return pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]


def outermost_of(parent: Ints) -> Ints:
    """Array (n,): the outer contour straight on the sheet that each contour lies in, itself for such a one.

    Examples
    --------
    >>> outermost_of(np.array([1, 2, -1])).tolist()
    [2, 2, 2]
    """
    top = np.where(parent < 0, np.arange(len(parent)), parent)
    while not np.array_equal(above := top[top], top):
        top = above
    return top


# Which part lies in the concavity of which.


def hull_pairs(outlines: Outlines, parent: Ints) -> Ints:
    """Array (k, 2) of all pairs (j, i), sorted, outer contours in the same place, j in the concavity of i."""
    outers = outlines.outers
    j, i = outers[concavity_pairs(outlines.line[outers], outlines.polygon[outers])].T
    same = parent[i] == parent[j]
    return np.column_stack([j[same], i[same]])


# Which part lies ahead of which on the same level (Pristupov 2016, fig. 3).
#
# Let d be the direction away from the start side. The shadow of contour i is every point from which a ray in
# direction d meets i: the space between the start side and i. Contour j lies ahead of i when the centroid of j is in
# the shadow of i and outside i; a ray that only grazes i meets it (a centroid inside i, of a trough that i lies in,
# is in no space between i and a side). Both are outer contours in the same place: straight on the sheet, or in the
# same hole.


def level_ahead(outlines: Outlines, parent: Ints, start_side: Side) -> Ints:
    """Array (k, 2) of all pairs (j, i) where j lies ahead of i, sorted.

    An STRtree finds the bounding rectangles that each ray passes. A contour is one closed curve, so a ray that
    begins in front of its rectangle and passes the rectangle meets the curve; only where the ray begins beside the
    curve (in a mouth, between two arms) is the curve itself asked.
    """
    outers = outlines.outers
    axis, away = AXIS[start_side], AWAY[start_side]
    along = away * outlines.centroid[outers, axis]
    across = outlines.centroid[outers, 1 - axis]
    faces = away * outlines.bounds_mm[outers][:, [axis, axis + 2]]
    near, far = faces.min(axis=1), faces.max(axis=1)
    low, high = outlines.bounds_mm[outers, 1 - axis], outlines.bounds_mm[outers, 3 - axis]

    boxes = shapely.STRtree(shapely.box(near, low, far, high))
    end = np.full(len(outers), far.max(initial=0.0))
    j, i = boxes.query(shapely.box(along, across - ROUNDING_MM, end, across + ROUNDING_MM))
    at = parent[outers]
    same_place = (at[j] == at[i]) & (j != i)
    j, i = j[same_place], i[same_place]

    meets = along[j] <= near[i]
    beside = np.flatnonzero(~meets)
    ray_from = outlines.centroid[outers[j[beside]]]
    ray_to = ray_from.copy()
    ray_to[:, axis] = away * far[i[beside]] + away
    rays = shapely.linestrings(np.stack([ray_from, ray_to], axis=1))
    meets[beside] = shapely.dwithin(rays, outlines.line[outers[i[beside]]], ROUNDING_MM)
    # a centroid inside the outline is in the mouth of a part, not between it and the start side
    met = np.flatnonzero(meets)
    around, middles = outers[i[met]], shapely.points(outlines.centroid[outers[j[met]]])
    meets[met] = ~well_inside(outlines.polygon[around], outlines.line[around], middles)
    j, i = outers[j[meets]], outers[i[meets]]
    return np.column_stack([j, i])[np.lexsort((i, j))]


# Which parts are long: the ones that heat bends most (Petunin 2009, section 2.2).


def long_parts(outlines: Outlines, long_ratio: float) -> Bools:
    """Array (n,): outer contours whose minimum rotated rectangle has one side at least `long_ratio` × the other."""
    outers = outlines.outers
    rectangles = shapely.oriented_envelope(outlines.line[outers])
    corners = shapely.get_coordinates(rectangles).reshape(-1, 5, 2)
    one, other = (np.hypot(*(corners[:, k + 1] - corners[:, k]).T) for k in (0, 1))
    is_long = np.zeros(outlines.n, dtype=bool)
    # Relative to the ratio, so that a part drawn exactly 4 : 1 counts at any angle.
    is_long[outers] = np.maximum(one, other) >= long_ratio * np.minimum(one, other) * (1 - SAME_SHARE)
    return is_long


# Where on the sheet the cutting heat goes (Petunin 2009, fig. 2, rule d).


def heat(outlines: Outlines, sheet_mm: Box) -> tuple[Floats, Ints]:
    """Cut length, mm, and number of small parts in the half of the sheet at each side, in the order of SIDES.

    Marks are left out: they do not cut through. So are scrap lines: they are cut when all parts are out. A part counts
    as small when its outer contour encloses no more than the median part does, and lies in the half that has its
    centroid. What lies on the line between two halves belongs half to each, a part to neither.
    """
    outers = outlines.outers
    area = outlines.area_mm2[outers]
    small = outers[area <= np.median(area) * (1 + SAME_SHARE)] if len(outers) else outers
    through = ~(outlines.is_mark | outlines.is_scrap)[outlines.chord_contour]
    start, end = outlines.chord_start[through], outlines.chord_end[through]
    length_mm = np.hypot(*(end - start).T)
    cut_mm, parts = [], []
    for side in SIDES:
        axis, away = AXIS[side], AWAY[side]
        middle = away * (sheet_mm[axis] + sheet_mm[axis + 2]) / 2
        cut_mm.append(float(length_mm @ _share_below(away * start[:, axis], away * end[:, axis], middle)))
        parts.append(int(np.count_nonzero(away * outlines.centroid[small, axis] < middle - ROUNDING_MM)))
    return np.array(cut_mm), np.array(parts, dtype=np.int64)


def _share_below(a: Floats, b: Floats, limit: float) -> Floats:
    """How much of each stretch from a to b lies below the limit; half of one that lies on it."""
    low, high = np.minimum(a, b), np.maximum(a, b)
    level = high - low <= ROUNDING_MM
    share = np.clip((limit - low) / np.where(level, 1.0, high - low), 0.0, 1.0)
    side = np.where(np.abs(limit - low) <= ROUNDING_MM, 0.0, np.sign(limit - low))
    return np.where(level, (side + 1) / 2, share)


# Distances to the sheet's sides and the empty strips along them (Petunin 2009, section 2.2).


def edge_gaps(outlines: Outlines, sheet_mm: Box) -> Floats:
    """Array (n, 4): how far each contour is from each side of the sheet's bounding rectangle, in the order of SIDES."""
    xmin, ymin, xmax, ymax = outlines.bounds_mm.T
    return np.column_stack([xmin - sheet_mm[0], sheet_mm[2] - xmax, ymin - sheet_mm[1], sheet_mm[3] - ymax])


def extents(sheet_mm: Box) -> Floats:
    """Array (4,): how far the sheet reaches away from each side."""
    size = (sheet_mm[2] - sheet_mm[0], sheet_mm[3] - sheet_mm[1])
    return np.array([size[AXIS[side]] for side in SIDES])


def offcuts(edge_gap_mm: Floats, sheet_mm: Box, offcut_share: float) -> tuple[Floats, Bools]:
    """Depth of the empty strip along each side, and whether it is over `offcut_share` of the extent that way.

    Examples
    --------
    >>> depth, large = offcuts(np.array([[10.0, 300.0, 10.0, 10.0]]), (0, 0, 1000, 500), 0.15)
    >>> depth.tolist(), large.tolist()
    ([10.0, 300.0, 10.0, 10.0], [False, True, False, False])
    """
    extent = extents(sheet_mm)
    depth = np.minimum(edge_gap_mm.min(axis=0, initial=np.inf), extent)
    return depth, depth > (offcut_share + SAME_SHARE) * extent


# From which side of the sheet cutting starts (Petunin 2009, fig. 2).


def start_side(
    sheet_mm: Box,
    options: FactOptions,
    is_long: Bools,
    edge_gap_mm: Floats,
    offcut_large: Bools,
    heat_mm: Floats,
    heat_parts: Ints,
) -> tuple[Side, Because]:
    """The start side and what decided it; the first clause that tells the sides apart does.

    The profile may fix the side ("profile"). Else only the two narrow sides are eligible, and of these (b) the one
    with more long parts within `edge_band_mm` of it, so that they are cut before heat has gathered ("long-parts");
    (c) the one opposite a large offcut, which then stiffens the end ("offcut"); (d) the one with more cut length in
    its half, then more small parts ("heat"). If all are even, (a) the left or bottom one ("narrow-side"). Cut lengths
    that differ by less than a millionth are even.
    """
    if options.start_side != "auto":
        return options.start_side, "profile"
    one, other = narrow_sides(sheet_mm)
    a, b = SIDES.index(one), SIDES.index(other)

    near = (edge_gap_mm[is_long] <= options.edge_band_mm + ROUNDING_MM).sum(axis=0)
    if near[a] != near[b]:
        return (one if near[a] > near[b] else other), "long-parts"
    if offcut_large[a] != offcut_large[b]:
        return OPPOSITE[one if offcut_large[a] else other], "offcut"
    if abs(heat_mm[a] - heat_mm[b]) > SAME_SHARE * max(heat_mm[a], heat_mm[b]):
        return (one if heat_mm[a] > heat_mm[b] else other), "heat"
    if heat_parts[a] != heat_parts[b]:
        return (one if heat_parts[a] > heat_parts[b] else other), "heat"
    return one, "narrow-side"
