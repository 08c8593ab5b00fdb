"""Features of contours that a kerf cannot enter: slots, notches and necks that are narrower than it.

The torch's path is half a kerf from the contour where it can be; in a slot narrower than the kerf it cannot be. What is
*left* of a contour is further than half the kerf from the path. A round kerf leaves something of every inner corner:
of an angle a, half the kerf times (1 / sin(a / 2) - 1), and of a right angle so much may be left anywhere. That is no
fault at any angle, unless a plant limits it. 0.05 mm more is within tolerance. Whatever is left beyond that is a
feature lost: the torch cuts straight across its mouth, or a slit opens it, or the nest is refused.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import shapely
from numpy.typing import NDArray

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.encoder.geometry.curve import Curve, lines_of
from kerfwise.encoder.geometry.measures import distances_mm
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.geometry.segment_arrays import SegmentArrays
from kerfwise.encoder.geometry.tolerances import tolerance_mm

from .nest import Contour

Lines = NDArray[np.object_]

CHORD_MM = 0.002
MANY_CHORDS = 10_000
"""Paths of more chords are evened out before they are grown."""
NEAR_MM = 0.01
"""Where the path leaves a contour by so little, the walls of a feature begin."""
QUARTER = 32
"""Chords of a quarter of a round end: true to 0.03 % of the radius."""
FEW = 6
"""Chords of a quarter of a round end where few will do: they lie inside the round, so that nothing seems nearer."""
SLACK_MM = 0.005
"""More than what fine chords make of a distance."""
CORNER_RAD = math.radians(15)
"""Walls that open by less are those of a slot."""
LEAST_RAD = math.radians(1)
"""A single corner that opens by less is a crack."""
SHALLOW_KERFS = 2.0
"""A feature no deeper than so many kerfs is cut straight across where nobody says otherwise: bend reliefs are."""

Narrow = Literal["ask", "leave", "slit", "refuse"]
"""What is done with a slot narrower than the kerf: see `cut_across`."""


@dataclass(frozen=True, slots=True)
class LostFeatureSpan:
    """A feature that would be lost: where it begins, how wide it is there, how deep behind that, and what is left, mm.

    `corner_deg` is the angle of a corner, None for a slot, notch or neck.
    """

    place: Point
    width_mm: float
    depth_mm: float
    left_mm: float
    corner_deg: float | None = None

    def sentence(self) -> str:
        """What is lost, in words."""
        at = f"at ({self.place[0]:z.1f}, {self.place[1]:z.1f})"
        if self.corner_deg is not None:
            return f"the corner of {self.corner_deg:.0f}° {at}, which keeps {self.left_mm:.2f} mm"
        return f"the slot, notch or neck {at}, {self.width_mm:.2f} mm wide and {self.depth_mm:.1f} mm deep"


MOST_TOLD = 6


def cut_across(feature: LostFeatureSpan, narrow: Narrow, kerf_mm: float) -> bool:
    """Whether the torch may cut straight across the mouth of a feature, which is lost then.

    Examples
    --------
    >>> relief, slot = LostFeatureSpan((0, 0), 1.0, 1.0, 0.9), LostFeatureSpan((0, 0), 1.0, 20.0, 19.5)
    >>> [cut_across(relief, how, 1.5) for how in ("ask", "leave", "slit", "refuse")]
    [True, True, True, False]
    >>> [cut_across(slot, how, 1.5) for how in ("ask", "leave", "slit", "refuse")]
    [False, True, False, False]
    """
    if feature.corner_deg is not None or narrow == "refuse":
        return False
    return narrow == "leave" or feature.depth_mm <= SHALLOW_KERFS * kerf_mm + tolerance_mm(kerf_mm)


def lost_features_sentence(
    name: str, lost: Sequence[LostFeatureSpan], kerf_mm: float, what_to_do: str = "change the drawing"
) -> str:
    """The features that a contour would lose, in one sentence, the first few of them with their places.

    Examples
    --------
    >>> lost_features_sentence("P.outer", [LostFeatureSpan((30.0, 5.0), 1.0, 20.0, 19.5)], 1.5)[:61]
    'P.outer: a kerf of 1.5 mm does not enter the slot, notch or n'
    """
    text = "; ".join(one.sentence() for one in lost[:MOST_TOLD])
    more = f"; and {len(lost) - MOST_TOLD} more" if len(lost) > MOST_TOLD else ""
    return f"{name}: a kerf of {kerf_mm:g} mm does not enter {text}{more}; {what_to_do}"


def lost_walls(
    contours: Sequence[Contour],
    kerf_mm: float,
    paths: Mapping[str, Curve] | None = None,
    slits: Mapping[str, Sequence[Curve]] | None = None,
    corner_mm: float | None = None,
) -> dict[str, tuple[tuple[LostFeatureSpan, shapely.LineString], ...]]:
    """Contour id → the features that a kerf would lose, each with the stretch of the contour that is its wall.

    `slits` are paths that the torch follows besides, by the contour whose features they keep. `corner_mm` is the most
    that may be left of a corner; None for whatever a round kerf leaves.
    """
    cut = [c for c in contours if c.encloses]
    if kerf_mm <= 0 or not cut:
        return {}
    half_mm, more_mm = kerf_mm / 2, tolerance_mm(kerf_mm)
    known, more = paths or {}, slits or {}
    sure = _surely_kept(cut, known, half_mm, more_mm, corner_mm)
    cut = [c for c, whole in zip(cut, sure.tolist(), strict=True) if not whole]
    if not cut:
        return {}
    lines = np.array([c.curve.line(CHORD_MM) for c in cut], dtype=object)
    rings = np.array([known[c.id].line(CHORD_MM) if c.id in known else ring_of(c, half_mm) for c in cut], dtype=object)
    for k, contour in enumerate(cut):
        if contour.id in more and not rings[k].is_empty:
            rings[k] = shapely.union_all([rings[k], *(path.line(CHORD_MM) for path in more[contour.id])])
    rings = _coarsened(rings)
    allowed_mm = more_mm if corner_mm is None else min(more_mm, corner_mm)
    beyond = shapely.difference(lines, shapely.buffer(rings, half_mm + allowed_mm, quad_segs=QUARTER))
    found: dict[str, tuple[tuple[LostFeatureSpan, shapely.LineString], ...]] = {}
    for k in np.flatnonzero(~shapely.is_empty(beyond) & ~shapely.is_empty(rings)).tolist():
        contour, near = cut[k], shapely.buffer(rings[k], half_mm + NEAR_MM, quad_segs=QUARTER)
        right = contour.curve.is_ccw == (contour.kind == "outer")
        walls = _pieces(shapely.difference(lines[k], near))
        tree, pieces = shapely.STRtree(walls), _pieces(beyond[k])
        points, of = shapely.get_coordinates(pieces, return_index=True)
        far_mm = np.split(distances_mm(rings[k], points), np.flatnonzero(np.diff(of)) + 1)
        judged = (_lost(*one, tree, half_mm, more_mm, right, corner_mm) for one in zip(pieces, far_mm, strict=True))
        if lost := tuple(one for one in judged if one is not None):
            found[contour.id] = lost
    return found


def _surely_kept(
    contours: Sequence[Contour], paths: Mapping[str, Curve], half_mm: float, more_mm: float, corner_mm: float | None
) -> NDArray[np.bool_]:
    """Contours of which nowhere more is left than of a right angle, as it is quickly shown; False says nothing yet.

    The path of most contours runs beside them, stretch by stretch. Of others, where their chords lie nearer to those of
    the path than what is left of a right angle, by what both chords and the chords of the round ends may be off, so do
    they. Coarse chords tell that of curves, finer ones of right angles.
    """
    most_mm = half_mm * math.sqrt(2) + more_mm
    if corner_mm is not None:
        most_mm = min(most_mm, half_mm + corner_mm + more_mm)
    sure = np.zeros(len(contours), dtype=np.bool_)
    left = [k for k, c in enumerate(contours) if c.id in paths]
    drawn, cut = [contours[k].curve for k in left], [paths[contours[k].id] for k in left]
    sure[left] = paths_keep_distance(drawn, cut, half_mm, most_mm - SLACK_MM)
    for chord_mm in ((most_mm - half_mm) / 8, more_mm / 8):
        left = [k for k, c in enumerate(contours) if not sure[k] and c.id in paths]
        lines = lines_of([contours[k].curve for k in left], chord_mm)
        rings = lines_of([paths[contours[k].id] for k in left], chord_mm / 2)
        rings = shapely.simplify(rings, chord_mm / 2)  # paths of very many chords too
        near = shapely.buffer(rings, most_mm - 2 * chord_mm - SLACK_MM, quad_segs=FEW)
        sure[left] = shapely.covers(near, lines)
    return sure


def _coarsened(rings: Lines) -> Lines:
    """The rings, those of very many chords with fewer, as close: the time to grow one goes with their square."""
    fine = shapely.get_num_coordinates(rings) > MANY_CHORDS
    evened = rings.copy()
    evened[fine] = shapely.simplify(rings[fine], CHORD_MM)
    return evened


def ring_of(contour: Contour, half_mm: float) -> shapely.Geometry:
    """The ring around the largest piece of what a contour encloses, grown or shrunk; pockets are left out."""
    area = shapely.make_valid(contour.curve.polygon(CHORD_MM))
    pieces = shapely.get_parts(
        shapely.buffer(area, half_mm if contour.kind == "outer" else -half_mm, quad_segs=QUARTER)
    )
    pieces = [p for p in pieces if p.area > 0]
    return max(pieces, key=lambda p: float(p.area)).exterior if pieces else shapely.LineString()


def _pieces(left: shapely.Geometry) -> list[shapely.LineString]:
    """The stretches of a ring that are left, each whole where it runs over the ring's start."""
    lines = [line for line in shapely.get_parts(left) if line.length > 0]
    return list(shapely.get_parts(shapely.line_merge(shapely.multilinestrings(lines)))) if lines else []


def _lost(
    piece: shapely.LineString,
    far_mm: Floats,
    walls: shapely.STRtree,
    half_mm: float,
    more_mm: float,
    right: bool,
    corner_mm: float | None = None,
) -> tuple[LostFeatureSpan, shapely.LineString] | None:
    """The feature that a stretch belongs to, None if no more is left of it than of a corner, or than `corner_mm`.

    `far_mm` is how far each of its points is from the torch's path.
    """
    points = shapely.get_coordinates(piece)
    left_mm = float(far_mm.max()) - half_mm
    opening, sharpest = _angles(points, right)
    angles = ((opening, CORNER_RAD), (sharpest, LEAST_RAD))
    natural = [half_mm * (1 / math.sin(a / 2) - 1) for a, least in angles if a > least]
    by_nature_mm = max([half_mm * (math.sqrt(2) - 1), *natural])
    is_corner = left_mm <= by_nature_mm + more_mm
    if is_corner and (corner_mm is None or left_mm <= corner_mm + more_mm):
        return None
    nearest = walls.geometries[int(walls.query_nearest(piece).min())]  # of equals the first
    wall = shapely.get_coordinates(nearest)
    (ax, ay), (bx, by) = wall[0].tolist(), wall[-1].tolist()
    width_mm, depth_mm = _size(wall)
    if is_corner:
        x, y = points[int(np.argmax(far_mm))].tolist()
        return LostFeatureSpan((x, y), width_mm, depth_mm, left_mm, math.degrees(min(opening, sharpest))), nearest
    return LostFeatureSpan(((ax + bx) / 2, (ay + by) / 2), width_mm, depth_mm, left_mm), nearest


def _size(wall: Floats) -> tuple[float, float]:
    """How wide a feature is at its mouth, from either end of its wall to the wall across, and how deep behind that."""
    mouth = wall[-1] - wall[0]
    length_mm = float(np.hypot(*mouth))
    inwards = wall - wall[0]
    depths_mm = np.abs(mouth[0] * inwards[:, 1] - mouth[1] * inwards[:, 0]) / max(length_mm, 1e-9)
    deepest_mm = float(depths_mm.max())
    bottom = np.flatnonzero(depths_mm > deepest_mm - NEAR_MM)
    width_mm = length_mm
    if bottom[0] > 0 and bottom[-1] < len(wall) - 1:
        one, other = shapely.linestrings(wall[: bottom[0] + 1]), shapely.linestrings(wall[bottom[-1] :])
        ends = shapely.points(wall[[0, -1]])
        width_mm = min(float(shapely.distance(ends[0], other)), float(shapely.distance(ends[1], one)))
    return width_mm, deepest_mm


def _angles(points: Floats, right: bool) -> tuple[float, float]:
    """How far the walls at the two ends of a stretch open, and the angle of its sharpest corner, rad; π is straight.

    `right` says that the waste lies to the right of the stretch as it runs.
    """
    along = np.diff(points, axis=0)
    along = along[np.hypot(along[:, 0], along[:, 1]) > 1e-9]
    if len(along) < 2:
        return math.pi, math.pi
    heading = np.arctan2(along[:, 1], along[:, 0])
    turn = (np.diff(heading) + math.pi) % math.tau - math.pi
    closing = -turn if right else turn
    return math.pi - float(closing.sum()), math.pi - float(closing.max())


# Paths of the torch that run beside their contours, stretch by stretch: how far the contours lie from them.
#
# A path has a stretch beside each line and arc of its contour, and arcs of half a kerf around some corners. A line
# whose two ends lie near the ends of another line is as near to that all along; an arc lies as far from one about the
# same centre as their radii differ, and beyond the ends of that no farther than its own ends do.

EXACT_MM = 1e-6
"""Centres and radii that are the same differ by no more."""
ALIKE_RAD = 1.0
"""Arcs that turn through no more than this more or less go the same way round their centre."""


def paths_keep_distance(curves: Sequence[Curve], paths: Sequence[Curve], half_mm: float, most_mm: float) -> Bools:
    """Which closed curves surely lie nowhere farther than `most_mm` from their paths; False says nothing yet.

    `curves` and `paths`: one path for each curve, beginning beside the curve's first line or arc. `half_mm`: half the
    kerf: the radius of what goes round a corner. `most_mm`: what is asked.

    Examples
    --------
    >>> square = Curve.of([(0, 0), (9, 0), (9, 9), (0, 9)])
    >>> around = Curve.of([(-1, -1), (10, -1), (10, 10), (-1, 10)])
    >>> (
    ...     paths_keep_distance([square], [around], 1.0, 1.5).tolist(),
    ...     paths_keep_distance([square], [around], 1.0, 1.4).tolist(),
    ... )
    ([True], [False])
    """
    if not curves:
        return np.zeros(0, dtype=np.bool_)
    drawn, cut = SegmentArrays.of(*curves), SegmentArrays.of(*paths)
    around = (cut.bulge != 0) & (np.abs(cut.radius_mm - half_mm) < EXACT_MM)
    beside = np.append(0, np.cumsum(~around))[cut.first]
    count = np.diff(drawn.first)
    paired = (np.diff(beside) == count) & (count > 0)
    of = np.repeat(np.arange(len(curves)), count)
    rows = np.flatnonzero(paired[of])
    stretch = np.flatnonzero(~around)[beside[of[rows]] + rows - drawn.first[of[rows]]]
    far = np.zeros(len(of), dtype=np.bool_)
    far[rows] = ~_stays_near(drawn, rows, cut, stretch, most_mm)
    kept = paired & (np.bincount(of[far], minlength=len(curves)) == 0)
    return np.asarray(kept, dtype=np.bool_)


def _stays_near(drawn: SegmentArrays, rows: Ints, cut: SegmentArrays, stretch: Ints, most_mm: float) -> Bools:
    """Whether lines and arcs lie nowhere farther than so much from the stretches beside them."""
    ends = ((drawn.start[rows], cut.start[stretch]), (drawn.end[rows], cut.end[stretch]))
    centre, cut_centre = drawn.centre[rows], cut.centre[stretch]
    near = np.ones(len(rows), dtype=np.bool_)
    ahead = np.ones(len(rows), dtype=np.bool_)  # seen from the centre, less than a right angle from each other
    for one, other in ends:
        near &= np.hypot(*(one - other).T) <= most_mm
        ahead &= ((one - centre) * (other - cut_centre)).sum(axis=1) > 0
    bulge, cut_bulge = drawn.bulge[rows], cut.bulge[stretch]
    lines = (bulge == 0) & (cut_bulge == 0)
    off_mm = np.hypot(*(centre - cut_centre).T)
    wider_mm = np.abs(drawn.radius_mm[rows] - cut.radius_mm[stretch])
    alike = (bulge * cut_bulge > 0) & (4 * np.abs(np.arctan(bulge) - np.arctan(cut_bulge)) < ALIKE_RAD)
    arcs = alike & ahead & (off_mm < EXACT_MM) & (wider_mm + EXACT_MM <= most_mm)
    return np.asarray(near & (lines | arcs), dtype=np.bool_)
