"""What a bevel and a tilted jet mean for the check: slopes, faces and widths at every depth, and blocks of torches."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.bevels.bevel import Bevel
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Segment
from kerfwise.encoder.nest import Contour, Nest, Part, cached_with_nest, with_parts
from kerfwise.postproc.check.reader.program import Burn, NcProgram
from kerfwise.rules.profile.values import ProfileValues

_TURN_RAD = math.radians(2)
ANGLE_DEG = 0.01
"""Leans that differ by less are one."""


@dataclass(frozen=True, eq=False)
class Jet:
    """A tilted burn in fine steps: the torch's point at the top face, and where the jet goes for each mm downwards.

    `leans_deg` are its angles there, `halves_mm` half the widths that it burns, level, and `steps` the numbers of the
    lines and arcs that begin there or go on.
    """

    burn: Burn
    at: Floats
    aside: Floats
    leans_deg: Floats
    turns_deg: Floats
    halves_mm: Floats
    steps: Ints

    @property
    def lean_deg(self) -> float:
        """Its angle; where that changes, the greatest."""
        return float(self.leans_deg[np.argmax(np.abs(self.leans_deg))])

    @property
    def steady(self) -> bool:
        """Whether it leans alike all the way."""
        return bool(np.ptp(self.leans_deg) < 1e-6)

    @property
    def half_mm(self) -> float:
        """Half of what it burns, level, where that is widest."""
        return float(self.halves_mm.max())

    def line(self, depth_mm: float, some: Any = slice(None)) -> shapely.LineString:
        """Its way at a depth, or a stretch of it."""
        return shapely.LineString((self.at + depth_mm * self.aside)[some])

    def burnt(self, depth_mm: float, some: slice = slice(None)) -> shapely.Geometry:
        """What it burns at a depth, or a stretch of it."""
        halves, points = self.halves_mm[some], (self.at + depth_mm * self.aside)[some]
        if np.ptp(halves) < 1e-9:
            return shapely.buffer(shapely.LineString(points), float(halves[0]))
        wide = np.maximum(halves[:-1], halves[1:])
        ends = [*(np.flatnonzero(np.abs(np.diff(wide)) > 1e-9) + 1).tolist(), len(wide)]
        areas, begin = [], 0
        for end in ends:
            areas.append(shapely.buffer(shapely.LineString(points[begin : end + 1]), float(wide[begin])))
            begin = end
        return shapely.union_all(areas)

    def paced(self, depth_mm: float) -> tuple[Floats, Floats]:
        """Points of its way at a depth, (m, 2), and how long each step between them takes for its length, (m - 1,).

        As long as the torch's point takes at the program's feed; where it turns on the spot, as long as this way.
        """
        points, feeds = self.at + depth_mm * self.aside, np.array(self.burn.step_feeds_mm_s)
        top_mm, chord_mm = (np.hypot(*np.diff(rows, axis=0).T) for rows in (self.at, points))
        slow_mm = np.where(top_mm > 0, top_mm, chord_mm) * feeds.max() / feeds[self.steps[:-1]]
        return points, np.divide(slow_mm, chord_mm, out=np.zeros_like(slow_mm), where=chord_mm > 0)

    def leaning(self, slope: Slope) -> shapely.Geometry:
        """Its way at the root of a slope, where it leans as that does."""
        on = np.abs(self.leans_deg - slope.lean_deg) <= ANGLE_DEG
        points = self.at + slope.root_mm * self.aside
        pieces = np.split(np.flatnonzero(on), np.flatnonzero(np.diff(np.flatnonzero(on)) > 1) + 1)
        return shapely.MultiLineString([points[piece] for piece in pieces if len(piece) > 1])


def jet_of(burn: Burn, profile: ProfileValues) -> Jet:
    at, aside, leans, turns, steps = [], [], [], [], []
    rows = burn.path.vertices.tolist()
    for k, ((x, y, bulge), after) in enumerate(zip(rows, [*rows[1:], rows[-1]], strict=True)):
        (tilt, turn), (tilt_to, turn_to) = burn.axes[k], burn.axes[min(k + 1, len(rows) - 1)]
        segment = Segment((x, y), (after[0], after[1]), bulge if k + 1 < len(rows) else 0.0)
        widest = max(abs(segment.sweep_rad), math.radians(abs(turn_to - turn)), math.radians(abs(tilt_to - tilt)))
        count = max(1, math.ceil(widest / _TURN_RAD))
        if segment.is_arc:
            count = max(count, segment.chords_within(0.005))
        for share in (j / count for j in range(count)):
            at.append(segment.point_at(share))
            lean, way = (math.radians(a + (b - a) * share) for a, b in ((tilt, tilt_to), (turn, turn_to)))
            aside.append((math.tan(lean) * math.cos(way), math.tan(lean) * math.sin(way)))
            leans.append(tilt + (tilt_to - tilt) * share)
            turns.append(turn + (turn_to - turn) * share)
            steps.append(k)
    half_of = {lean: half_width_mm(lean, profile) for lean in {*leans}}
    halves = np.array([half_of[lean] for lean in leans])
    return Jet(burn, np.array(at), np.array(aside), np.array(leans), np.array(turns), halves, np.array(steps))


@dataclass(frozen=True, eq=False, slots=True)
class Root:
    """The way of a jet's middle at the root of a slope; of `rest_mm` of it round rests may stand. None: no room."""

    slope: Slope
    line: shapely.Geometry | None
    rest_mm: float = 0.0


def roots_of(contour: Contour, profile: ProfileValues) -> Iterator[Root]:
    """The ways that the slopes of a contour want, pass by pass; those of single edges edge by edge."""
    if not contour.edge_bevels:
        for slope in slopes_of(contour.bevel, profile.material.thickness_mm)[0]:
            yield Root(slope, root_ring(contour, slope, profile))
    for side in sides_of(contour) if contour.edge_bevels else ():
        for slope in slopes_of(side.bevel, profile.material.thickness_mm)[0]:
            half_mm = half_width_mm(slope.lean_deg, profile)
            rest_mm = sum(8 * half_mm for sharp in side.sharp if not sharp)
            yield Root(slope, shapely.LineString(side.beside(half_mm)), rest_mm)


def root_ring(contour: Contour, slope: Slope, profile: ProfileValues) -> shapely.LinearRing | None:
    """The way of the jet's middle round a contour at the root of a slope."""
    out = half_width_mm(slope.lean_deg, profile) * (1 if contour.kind == "outer" else -1)
    area = shapely.buffer(shapely.make_valid(contour.curve.polygon(0.002)), out, quad_segs=32)
    pieces = [one for one in shapely.get_parts(area) if one.area > 0]
    return max(pieces, key=shapely.area).exterior if pieces else None


_NUMBER = r"-?\d+(?:\.\d+)?"
_SET = re.compile(rf"BLOCK TORCH (\d) [A-Z ]*?TILT ({_NUMBER}) LEFT ({_NUMBER}) OUT ({_NUMBER})")
Setting = tuple[float, float, float]
"""How a torch leans, how far it stands on the left of the upright one as one looks along C, and how far out."""
Found = tuple[tuple[str, ...], str]


def settings_of(program: NcProgram, found: list[Found]) -> dict[int, Setting]:
    """How each torch of the block is set by what the program says; two settings of one torch are told."""
    settings: dict[int, Setting] = {}
    for match in filter(None, map(_SET.fullmatch, program.comments)):
        torch, told = int(match[1]), (float(match[2]), float(match[3]), float(match[4]))
        if settings.setdefault(torch, told) != told:
            found.append(((), f"torch {torch} of the block is set by hand, and the program wants it in two ways"))
    return settings


def torch_burns(program: NcProgram, profile: ProfileValues, found: list[Found]) -> Iterator[tuple[Burn, Burn | None]]:
    """What each torch burns, as a burn of its own that leans; with that of the block where it burns with others.

    A burn of the upright torch alone, that does not turn, is a plain burn.
    """
    settings = settings_of(program, found)
    for burn in program.burns:
        if burn.tool != 0:
            yield burn, None
            continue
        plain = replace(burn, torches=(), axes=())
        if len({turn for _, turn in burn.axes}) < 2 and burn.torches == (2,):
            yield plain, None
            continue
        if not burn.torches:
            found.append(((), f"line {burn.line}: no torch of the block is selected"))
        jet = jet_of(burn, profile)
        turn = np.unwrap(np.radians(jet.turns_deg))
        out, left = np.column_stack([np.cos(turn), np.sin(turn)]), np.column_stack([-np.sin(turn), np.cos(turn)])
        for torch in burn.torches:
            if torch not in settings:
                found.append(((), f"line {burn.line}: nobody says how torch {torch} of the block is set"))
                continue
            tilt, left_mm, out_mm = settings[torch]
            at = jet.at + left_mm * left + out_mm * out
            keep = np.append(True, np.hypot(*np.diff(at, axis=0).T) > 1e-9)
            path = Curve(np.column_stack([at[keep], np.zeros(int(keep.sum()))]), closed=False)
            axes = tuple((tilt, math.degrees(angle)) for angle in turn[keep].tolist())
            feeds = (max(burn.feeds_mm_s),) * len(path.segments)
            yield replace(plain, path=path, axes=axes, step_feeds_mm_s=feeds, torch=torch), burn


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
