"""What a bevel means for the check: its slopes, its face at every depth, and how wide a tilted jet cuts.

Found from the nest as drawn and the profile alone, by other means than the planning has.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.bevels.bevel import Bevel
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Contour, Nest, Part, cached_with_nest, with_parts
from kerfwise.rules.profile.values import ProfileValues

_SAMPLE_MM = 0.5
_SHARP_RAD = math.radians(30)


@dataclass(frozen=True, eq=False, slots=True)
class EdgeSide:
    """One edge in fine points, with the directions into the part there, and whether its ends are sharp corners.

    `turns_rad` are how far the contour turns at its two ends: more than nothing away from the part.
    """

    bevel: Bevel | None
    points: Floats
    inwards: Floats
    turns_rad: tuple[float, float]

    @property
    def line(self) -> shapely.LineString:
        """The edge."""
        return shapely.LineString(self.points)

    @property
    def sharp(self) -> tuple[bool, bool]:
        """Whether each end is a sharp corner that sticks out."""
        return self.turns_rad[0] >= _SHARP_RAD - 1e-9, self.turns_rad[1] >= _SHARP_RAD - 1e-9

    def beside(self, out_mm: float) -> Floats:
        """The points so far outside the part."""
        points: Floats = self.points - out_mm * self.inwards
        return points

    def taken(self, away_mm: float) -> shapely.Geometry:
        """What a slope takes off the part where its face lies so far behind the edge; on past sharp corners."""
        points, into = list(self.points), list(self.inwards)
        for end, turn, sharp in zip((0, -1), self.turns_rad, self.sharp, strict=True):
            if not sharp or turn >= math.pi / 2:
                continue
            along = into[end][::-1] * (1, -1)
            along = along if np.dot(along, self.points[end] - self.points[1 if end == 0 else -2]) > 0 else -along
            far = self.points[end] + along * away_mm / math.tan(turn)
            points.insert(0 if end == 0 else len(points), far)
            into.insert(0 if end == 0 else len(into), into[end])
        outer, normals = np.array(points), np.array(into)
        return shapely.make_valid(shapely.Polygon([*outer, *(outer + away_mm * normals)[::-1]]))

    def face(self, away_mm: float, rest_mm: float) -> Floats:
        """Points of its face, without those `rest_mm` beside ends that are no sharp corners."""
        at = shapely.line_locate_point(self.line, shapely.points(self.points))
        begin, end = (0.0 if sharp else rest_mm for sharp in self.sharp)
        kept = (at >= begin - 1e-9) & (at <= self.line.length - end + 1e-9)
        points: Floats = (self.points + away_mm * self.inwards)[kept]
        return points


def sides_of(contour: Contour) -> Iterator[EdgeSide]:
    """The edges of a contour, in its order."""
    segments = contour.curve.segments
    left = contour.curve.is_ccw == (contour.kind == "outer")  # where the part is
    turns = []
    for before, after in zip((segments[-1], *segments[:-1]), segments, strict=True):
        (ax, ay), (bx, by) = before.tangent_at(1.0), after.tangent_at(0.0)
        turns.append((1 if left else -1) * math.atan2(ax * by - ay * bx, ax * bx + ay * by))
    for k, (segment, bevel) in enumerate(zip(segments, contour.bevel_of_edge, strict=True)):
        share = np.linspace(0.0, 1.0, max(2, math.ceil(segment.length_mm / _SAMPLE_MM) + 1)).tolist()
        tangents = np.array([segment.tangent_at(f) for f in share])
        inwards = np.column_stack([-tangents[:, 1], tangents[:, 0]]) * (1 if left else -1)
        points = np.array([segment.point_at(f) for f in share])
        yield EdgeSide(bevel, points, inwards, (turns[k], turns[(k + 1) % len(turns)]))


_MITRE = 50.0


@dataclass(frozen=True, slots=True)
class Slope:
    """One slope of a bevel: the lean of the jet, positive where it leaves the part downwards, and its root's depth."""

    lean_deg: float
    root_mm: float


def slopes_of(bevel: Bevel | None, thickness_mm: float) -> tuple[list[Slope], bool]:
    """The slopes of a bevel from the top face down, and whether it has a square face besides."""
    if bevel is None:
        return [], True
    both = bevel.kind in ("X", "K")
    share = (0.5, 0.5) if both else (1.0, 0.0) if bevel.side != "bottom" else (0.0, 1.0)
    sloped_mm = thickness_mm - bevel.land_mm
    found = []
    if share[0]:
        found.append(Slope(bevel.angle_deg, share[0] * sloped_mm))
    if share[1]:
        found.append(Slope(-bevel.angle_deg, thickness_mm - share[1] * sloped_mm))
    return found, bevel.land_mm > 0


def cut_away_mm(bevel: Bevel | None, depth_mm: float, thickness_mm: float) -> float:
    """How far the face lies behind the contour as drawn, at a depth."""
    away = [0.0]
    for slope in slopes_of(bevel, thickness_mm)[0]:
        over_mm = slope.root_mm - depth_mm if slope.lean_deg > 0 else depth_mm - slope.root_mm
        away.append(over_mm * math.tan(math.radians(abs(slope.lean_deg))))
    return max(away)


def half_width_mm(lean_deg: float, profile: ProfileValues) -> float:
    """Half of what a jet at this angle burns away, measured level."""
    rows = dict([(0.0, profile.material.kerf_mm), *profile.cuts.bevel.kerfs])
    angles = sorted(rows)
    kerf_mm = float(np.interp(abs(lean_deg), angles, [rows[a] for a in angles]))
    return kerf_mm / (2 * math.cos(math.radians(lean_deg)))


def as_burnt(nest: Nest, profile: ProfileValues) -> Nest:
    """The nest with its bevelled contours where upright kerfs would have to run to cut them at their roots."""
    if profile.cuts.bevel.head is None or not any(c.bevel for c in nest.contours):
        return nest
    thickness_mm, kerf_mm = profile.material.thickness_mm, profile.material.kerf_mm
    wider = {
        c.id: 0.0 if square else round(half_width_mm(slopes[-1].lean_deg, profile) - kerf_mm / 2, 9)
        for c in nest.contours
        if c.bevel is not None
        for slopes, square in (slopes_of(c.bevel, thickness_mm),)
    }
    return _moved_out(nest, tuple(wider.items()))


@cached_with_nest(most=2)
def _moved_out(nest: Nest, wider: tuple[tuple[str, float], ...]) -> Nest:
    by = dict(wider)

    def made(contour: Contour) -> Contour:
        if not by.get(contour.id):
            return contour
        out = by[contour.id] if contour.kind == "outer" else -by[contour.id]
        area = shapely.buffer(shapely.make_valid(contour.curve.polygon(0.002)), out, quad_segs=32)
        largest = max(shapely.get_parts(area), key=shapely.area)
        points = shapely.get_coordinates(largest.exterior)[:-1]
        return replace(contour, curve=Curve(np.column_stack([points, np.zeros(len(points))])))

    parts = [replace(p, outer=made(p.outer), holes=tuple(map(made, p.holes))) for p in nest.parts]
    return with_parts(nest, tuple(parts))


def face_area(contour: Contour, away_mm: float, sharp: bool) -> shapely.Geometry:
    """What a contour goes round where its face lies so far behind it; inner corners `sharp`, or round."""
    area = shapely.make_valid(contour.polygon)
    if not away_mm:
        return area
    by = -away_mm if contour.kind == "outer" else away_mm
    if sharp:
        return shapely.buffer(area, by, join_style="mitre", mitre_limit=_MITRE)
    return shapely.buffer(area, by, quad_segs=32)


def section_of(part: Part, depth_mm: float, thickness_mm: float) -> shapely.Geometry:
    """The metal of a part at a depth."""
    metal = _inside(part.outer, depth_mm, thickness_mm)
    for hole in part.holes:
        metal = shapely.difference(metal, _inside(hole, depth_mm, thickness_mm))
    return metal


def _inside(contour: Contour, depth_mm: float, thickness_mm: float) -> shapely.Geometry:
    """What a contour goes round at a depth."""
    if not contour.edge_bevels:
        return face_area(contour, cut_away_mm(contour.bevel, depth_mm, thickness_mm), sharp=True)
    area = shapely.make_valid(contour.polygon)
    for side in sides_of(contour):
        if away_mm := cut_away_mm(side.bevel, depth_mm, thickness_mm):
            change = shapely.difference if contour.kind == "outer" else shapely.union
            area = change(area, side.taken(away_mm))
    return area
