"""Offsets of many curves at a time, and what each stretch of an offset curve is offset from."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from kerfwise.arrays import Bools, Floats, Ints

from .curve import Curve, lines_of
from .measures import Circle, Line, LineOrCircle, crossings
from .segment import Point
from .segment_arrays import SegmentArrays

# The area a closed curve bounds when it is grown or shrunk, as a ring of chords: where offset curves must lie.

CHORD_MM = 0.001
"""How far the ring's own rounding may lie from the true offset."""
SLIVER_MM = 0.02
"""A separate piece nowhere wider than this is an artefact of tolerances and is left out."""


def offset_ring(outline: Floats, distance_mm: float, patient: bool = False) -> Floats:
    """Boundary of the area inside `outline` grown (distance > 0) or shrunk (distance < 0), or of its largest piece.

    Where the area grown closes around a pocket, the ring runs past its mouth; where shrunk it falls into pieces, the
    ring is that of the largest. What is lost of the outline then, `encoder.narrow` finds.
    Taken from the band of points within `distance_mm` of the outline rather than from the area, so that outlines
    that touch or cross themselves are as good as any other.

    Parameters
    ----------
    outline
        Array (n, 2), the outline without its first point repeated.
    distance_mm
        How far to go, mm, not 0.
    patient
        GEOS evens out shallow hollows of a line before it buffers it, by up to a few hundredths of the distance.
        Where that shows, the band is put together from the bands of the single chords instead, a hundred times slower.

    Returns
    -------
    Array (m, 2), running the same way round as the outline, first point not repeated.

    Raises ValueError if nothing is left.
    """
    reach_mm = abs(distance_mm)
    closed = np.concatenate([outline, outline[:1]])
    half_step_rad = math.acos(max(1 - CHORD_MM / reach_mm, 0.5))
    chords = np.stack([closed[:-1], closed[1:]], axis=1)
    lines = shapely.linestrings(chords) if patient else shapely.LineString(closed)
    band = shapely.union_all(shapely.buffer(lines, reach_mm, quad_segs=math.ceil(math.pi / 4 / half_step_rad)))
    if distance_mm > 0:
        ring = band.exterior
    else:
        inside = shapely.Polygon(closed)
        shapely.prepare(inside)
        gaps = [shapely.Polygon(ring) for ring in band.interiors]
        pieces = [gap for gap in gaps if shapely.contains_xy(inside, *gap.representative_point().coords[0])]
        pieces.sort(key=lambda piece: -piece.area)
        if not pieces or _is_sliver(pieces[0]):
            raise ValueError(f"shrunk by {reach_mm:g} mm nothing is left: nowhere is it {2 * reach_mm:g} mm wide")
        ring = pieces[0].exterior
    points: Floats = shapely.get_coordinates(ring)[:-1]
    return points if _is_ccw(points) == _is_ccw(outline) else points[::-1]


def _is_sliver(piece: shapely.Polygon) -> bool:
    return bool(shapely.buffer(piece, -SLIVER_MM / 2).is_empty)


def _is_ccw(points: Floats) -> bool:
    (x, y), (nx, ny) = (points - points[0]).T, (np.roll(points, -1, axis=0) - points[0]).T
    return bool(np.dot(x, ny) > np.dot(nx, y))


# Offsets of many curves at a time, where each stretch meets only those of its neighbours: no area is made for them.
#
# That is so of convex curves. Of others it is shown, where corners that bend towards the offset side are far enough
# apart: no point of the offset then lies nearer to the curve than it should.

FURTHER_MM = 0.01
"""What is shown is shown for an offset so much further, too, so that it does not hang on rounding."""
NEARER_MM = 2.5 * CHORD_MM
"""What the chords of an offset and of its curve may make of their distance."""
LEAST_MM = 0.05
"""Shorter stretches of an offset are left to areas."""
MOST_RAD = math.radians(120)
"""So are corners that bend further towards the offset side, and those between edges shorter than twice the offset."""
LEAST_RAD = math.radians(3)
"""And those that bend by less either way, where areas may make one stretch of two."""
MOST_SEGMENTS = 64
"""Every segment of an offset is held against every one of its curve: for longer curves areas are as quick."""


def offset_curves(curves: Sequence[Curve], distances_mm: Sequence[float]) -> list[Curve | None]:
    """As `offset_curve` of each, by a distance of its own; None where this way does not tell.

    The curves are closed and enclose an area.

    Examples
    --------
    >>> ell = Curve.of([(0, 0), (30, 0), (30, 10), (10, 10), (10, 30), (0, 30)])
    >>> offset_curves([ell], [-1.0])[0].as_rows()[2:5]
    [[29.0, 9.0], [10.0, 9.0, -0.41421356237309503], [9.0, 10.0]]
    >>> offset_curves([ell], [-6.0])
    [None]
    """
    if not curves:
        return []
    drawn = SegmentArrays.of(*curves)
    right_mm = np.array([mm if c.is_ccw else -mm for c, mm in zip(curves, distances_mm, strict=True)])
    beside = _Beside.made(drawn, right_mm)
    convex = beside.convex
    tried = np.flatnonzero(beside.whole & (convex | beside.roomy))
    by_row = dict(zip(tried.tolist(), beside.curves(tried), strict=True))
    concave = tried[~convex[tried]]
    shown = concave[_keeps_away([by_row[k] for k in concave.tolist()], curves, right_mm, concave, 0.0)]
    if len(shown):
        some = SegmentArrays.of(*(curves[k] for k in shown.tolist()))
        more_mm = right_mm[shown] + np.copysign(FURTHER_MM, right_mm[shown])
        further = _Beside.made(some, more_mm)
        every = np.flatnonzero(further.whole)
        rows = shown[every]
        shown = rows[_keeps_away(further.curves(every), curves, right_mm, rows, FURTHER_MM)]
    found: list[Curve | None] = [None] * len(curves)
    for k in tried[convex[tried]].tolist():
        if abs(by_row[k].signed_area_mm2) > SLIVER_MM * by_row[k].length_mm:  # of a point nothing is kept
            found[k] = by_row[k]
    for k in shown.tolist():
        found[k] = by_row[k]
    return found


def _keeps_away(
    offsets: Sequence[Curve], curves: Sequence[Curve], right_mm: Floats, numbers: Ints, further_mm: float
) -> Bools:
    """Which of the offsets made of the curves with these numbers come nowhere nearer to them than they should."""
    lines = lines_of(offsets, CHORD_MM)
    drawn = lines_of([curves[k] for k in numbers.tolist()], CHORD_MM)
    least_mm = np.abs(right_mm[numbers]) + further_mm - NEARER_MM
    return np.asarray(~shapely.dwithin(lines, drawn, least_mm), dtype=np.bool_)


@dataclass(frozen=True, eq=False, slots=True)
class _Beside:
    """The stretches beside the segments of curves, and those around the corners at their ends, where `rounded`.

    Others that are not smooth are `crossed`: the stretches on either side are trimmed to where they meet.
    `right_mm` (n,) is the offset to the right, `of` (n,) the curve of each segment. The stretch beside a segment goes
    from `begin` to `end` (n, 2) with the bulge `bulge` (n,), the one around a corner from there with `corner_bulge` to
    where the next begins. `whole` (curves,) says which curves have all stretches, none of which runs backwards.
    """

    drawn: SegmentArrays
    right_mm: Floats
    of: Ints
    rounded: Bools
    crossed: Bools
    begin: Floats
    end: Floats
    bulge: Floats
    corner_bulge: Floats
    whole: Bools

    @staticmethod
    def made(drawn: SegmentArrays, right_mm: Floats) -> _Beside:
        count = np.diff(drawn.first)
        of = np.repeat(np.arange(len(count)), count)
        after = drawn.following
        right = right_mm[of]
        bridged = np.array([bridged_rad(mm) for mm in right_mm.tolist()])[of]
        rounded = rounded_corners(drawn.turn_rad, right, bridged)
        radius_mm = offset_radii_mm(drawn, right)
        first = _moved(drawn.start, drawn.tangent_in, right)
        last = _moved(drawn.end, drawn.tangent_out, right)
        (tx, ty), (ux, uy) = drawn.tangent_out.T, drawn.tangent_in[after].T
        scale = 1 + tx * ux + ty * uy
        turned_back = scale < 1e-6
        scale = np.where(turned_back, 1.0, scale)
        x, y = drawn.end.T
        mitre = np.column_stack([x + right * (ty + uy) / scale, y - right * (tx + ux) / scale])
        sharp = ~rounded & (turned_back | ~(np.abs(drawn.turn_rad) < SMOOTH_RAD))
        broken = (drawn.bulge != 0) & (radius_mm < SLIVER_MM)
        broken |= sharp & turned_back
        meet = mitre.copy()
        straight = sharp & (drawn.bulge == 0) & (drawn.bulge[after] == 0)
        meet[straight], parallel = _crossings(first, drawn.tangent_in, np.flatnonzero(straight), after)
        broken[np.flatnonzero(straight)[parallel]] = True
        for k in np.flatnonzero(sharp & ~straight & ~broken).tolist():
            a, b = (offset_track(drawn, radius_mm, j, _point(first[j])) for j in (k, int(after[k])))
            near = _point(mitre[k])
            best = min(crossings(a, b), key=lambda p: math.dist(p, near), default=None)
            broken[k] |= best is None
            if best is not None:
                meet[k] = best
        end = np.where(rounded[:, None], last, meet)
        begin = np.empty_like(end)
        begin[after] = np.where(rounded[:, None], first[after], meet)
        ahead = (end[:, 0] - begin[:, 0]) * drawn.tangent_in[:, 0] + (end[:, 1] - begin[:, 1]) * drawn.tangent_in[:, 1]
        arcs = drawn.bulge != 0
        broken |= ~arcs & ~(ahead > -1e-9)
        bulge, corner_bulge = np.zeros(len(of)), np.zeros(len(of))
        longest = [4 * math.atan(abs(b)) for b in drawn.bulge[arcs].tolist()]
        turns = np.where(drawn.bulge[arcs] > 0, 1, -1)
        bulge[arcs] = _bulges(drawn.centre[arcs], turns, begin[arcs], end[arcs], longest)
        turns, around = np.where(right[rounded] > 0, 1, -1), begin[after[rounded]]
        corner_bulge[rounded] = _bulges(drawn.end[rounded], turns, end[rounded], around, [math.pi] * len(turns))
        broken |= np.isnan(bulge) | np.isnan(corner_bulge)
        whole = count > 1
        whole[of[broken]] = False
        return _Beside(drawn, right, of, rounded, sharp, begin, end, bulge, corner_bulge, whole)

    @property
    def convex(self) -> Bools:
        """Which curves bound a convex area."""
        first = self.drawn.first[:-1]
        bent_rad = 4 * np.arctan(self.drawn.bulge)
        total_rad = np.add.reduceat(self.drawn.turn_rad, first) + np.add.reduceat(bent_rad, first)
        way = np.copysign(1.0, total_rad)[self.of]
        convex: Bools = np.abs(np.abs(total_rad) - math.tau) < 1e-6
        convex[self.of[~((way * self.drawn.turn_rad > -1e-9) & (way * bent_rad > -1e-9))]] = False
        return convex

    @property
    def roomy(self) -> Bools:
        """Which curves have corners that are far enough apart, and not too sharp, for stretches of neighbours alone."""
        after, length_mm = self.drawn.following, np.hypot(*(self.drawn.end - self.drawn.start).T)
        short = length_mm < 2 * np.abs(self.right_mm)
        bent_rad = np.abs(self.drawn.turn_rad)
        tight = (bent_rad < LEAST_RAD) | (self.crossed & (short | short[after] | (bent_rad > MOST_RAD)))
        tight |= self.crossed & ((self.drawn.bulge != 0) | (self.drawn.bulge[after] != 0))
        tight |= np.hypot(*(self.end - self.begin).T) < LEAST_MM
        tight |= self.rounded & (np.hypot(*(self.begin[after] - self.end).T) < LEAST_MM)
        roomy = np.diff(self.drawn.first) <= MOST_SEGMENTS
        roomy[self.of[tight]] = False
        return roomy

    def curves(self, numbers: Ints) -> list[Curve]:
        """The offsets of the curves with these numbers, which are whole."""
        after = self.drawn.following
        beside, around = np.column_stack([self.begin, self.bulge]), np.column_stack([self.end, self.corner_bulge])
        rows = np.stack([beside, around], axis=1).reshape(-1, 3)
        kept = np.stack([_apart(self.begin, self.end), self.rounded & _apart(self.end, self.begin[after])], axis=1)
        at = np.concatenate([[0], np.cumsum(kept.ravel())])
        rows, first = rows[kept.ravel()], at[2 * self.drawn.first]
        ends = zip(first[numbers].tolist(), first[numbers + 1].tolist(), strict=True)
        return [Curve(rows[a:b]) for a, b in ends]


def _apart(a: Floats, b: Floats) -> Bools:
    return np.asarray(np.hypot(*(b - a).T) > 1e-9)


def _moved(at: Floats, tangent: Floats, right_mm: Floats) -> Floats:
    """Points moved to the right of unit tangents."""
    return np.column_stack([at[:, 0] + right_mm * tangent[:, 1], at[:, 1] - right_mm * tangent[:, 0]])


def _crossings(at: Floats, way: Floats, k: Ints, after: Ints) -> tuple[Floats, Bools]:
    """Where lines `k` meet those after them, and which are parallel."""
    (ax, ay), (bx, by) = way[k].T, way[after[k]].T
    cross = ax * by - ay * bx
    parallel = np.abs(cross) < 1e-9
    dx, dy = (at[after[k]] - at[k]).T
    t = (dx * by - dy * bx) / np.where(parallel, 1.0, cross)
    return np.column_stack([at[k, 0] + t * ax, at[k, 1] + t * ay]), parallel


def _bulges(centre: Floats, turns: NDArray[np.int64], start: Floats, end: Floats, longest_rad: list[float]) -> Floats:
    """Bulges of arcs about centres, each turning by no more than the longest; NaN for one that would run backwards."""
    rows = zip(turns.tolist(), (start - centre).tolist(), (end - centre).tolist(), longest_rad, strict=True)
    return np.array([arc_bulge(*row) for row in rows], dtype=np.float64)


def _point(row: Floats) -> Point:
    x, y = row.tolist()
    return x, y


# What each stretch of an offset curve is offset from: a line or arc of the drawn curve, or one of its corners.

MITRE_MM = 0.001
"""A corner whose pointed offset reaches less than this beyond its rounding arc is left pointed."""
SMOOTH_RAD = 1e-4
"""A corner that turns by less has an exact mitre."""


def bridged_rad(offset_mm: float) -> float:
    """By how much a corner may bend away from an offset that leaves it pointed."""
    return 2 * math.acos(abs(offset_mm) / (abs(offset_mm) + MITRE_MM))


def rounded_corners(turn_rad: Floats, right_mm: Floats | float, bridged: Floats | float) -> Bools:
    """Corners that bend away from the offset side by more than a mitre can bridge, `bridged` in radians."""
    # A cusp turns by half a turn either way, and is gone around on both sides.
    return np.asarray((turn_rad * np.sign(right_mm) > bridged) | (np.abs(turn_rad) > math.pi - 1e-6))


def offset_radii_mm(drawn: SegmentArrays, right_mm: Floats | float) -> Floats:
    """Radii (n,) of the offset arcs of segments, negative where an arc vanishes, 0 for lines."""
    return np.where(drawn.bulge != 0, drawn.radius_mm + right_mm * np.sign(drawn.bulge), 0.0)


def offset_track(drawn: SegmentArrays, radius_mm: Floats, k: int, begin: Point) -> LineOrCircle:
    """The line or circle that the offset of segment k lies on, whose untrimmed offset begins at `begin`."""
    if drawn.bulge[k] != 0:
        return Circle(_offset_point(drawn.centre[k]), float(radius_mm[k]), 1 if drawn.bulge[k] > 0 else -1)
    return Line(begin, _offset_point(drawn.tangent_in[k]))


def arc_bulge(turn: int, start: Point, end: Point, longest_rad: float) -> float:
    """Bulge of the arc between two points, seen from its centre; NaN if it would run backwards."""
    (sx, sy), (ex, ey) = start, end
    sweep = (turn * (math.atan2(ey, ex) - math.atan2(sy, sx))) % math.tau
    if sweep > longest_rad and math.tau - sweep < sweep - longest_rad:
        return 0.0 if math.tau - sweep < 1e-9 else math.nan
    return turn * math.tan(sweep / 4)


@dataclass(frozen=True, eq=False, slots=True)
class Sources:
    """The n segments of a closed curve and the n corners between them, ready to be offset.

    Segment k has the number 2 k, the corner at its end 2 k + 1. `right_mm` is the offset to the right of travel
    (negative: left); `radius_mm` (n,) are the radii of offset arcs, negative where an arc vanishes, 0 for lines.
    """

    drawn: SegmentArrays
    right_mm: float
    radius_mm: Floats

    @staticmethod
    def of(curve: Curve, distance_mm: float) -> Sources:
        """The sources of `curve` offset outwards by `distance_mm`."""
        right_mm = distance_mm if curve.is_ccw else -distance_mm
        drawn = SegmentArrays.of(curve)
        return Sources(drawn, right_mm, offset_radii_mm(drawn, right_mm))

    def __len__(self) -> int:
        return len(self.drawn)

    @property
    def rounded(self) -> Bools:
        """See `rounded_corners`."""
        return rounded_corners(self.drawn.turn_rad, self.right_mm, bridged_rad(self.right_mm))

    def track(self, source: int) -> LineOrCircle:
        """The line or circle that the offset of a source lies on."""
        k, is_corner = divmod(source, 2)
        if is_corner:
            return Circle(_offset_point(self.drawn.end[k]), abs(self.right_mm), 1 if self.right_mm > 0 else -1)
        return offset_track(self.drawn, self.radius_mm, k, self.offset_start(k))

    def longest_sweep_rad(self, source: int) -> float:
        """The most that the offset arc of a source can turn."""
        k, is_corner = divmod(source, 2)
        return math.pi if is_corner else 4 * math.atan(abs(float(self.drawn.bulge[k])))

    def offset_start(self, k: int) -> Point:
        """Where the untrimmed offset of segment k begins."""
        (x, y), (tx, ty) = self.drawn.start[k].tolist(), self.drawn.tangent_in[k].tolist()
        return x + self.right_mm * ty, y - self.right_mm * tx

    def offset_end(self, k: int) -> Point:
        """Where the untrimmed offset of segment k ends."""
        (x, y), (tx, ty) = self.drawn.end[k].tolist(), self.drawn.tangent_out[k].tolist()
        return x + self.right_mm * ty, y - self.right_mm * tx

    def mitre(self, k: int) -> Point | None:
        """Where the offset tangents at the corner after segment k meet; None where the curve turns back."""
        (tx, ty), (ux, uy) = self.drawn.tangent_out[k].tolist(), self.drawn.tangent_in[(k + 1) % len(self)].tolist()
        scale = 1 + tx * ux + ty * uy  # the mitre is (normal + next normal) / (1 + their product) from the corner
        if scale < 1e-6:
            return None
        x, y = self.drawn.end[k].tolist()
        return x + self.right_mm * (ty + uy) / scale, y - self.right_mm * (tx + ux) / scale

    def is_smooth(self, k: int) -> bool:
        """True when the corner after segment k turns so little that its mitre is exact."""
        return bool(abs(self.drawn.turn_rad[k]) < SMOOTH_RAD)


def _offset_point(row: Floats) -> Point:
    x, y = row.tolist()
    return x, y
