"""Tilted burns for the check: what a jet burns at each depth, the ways that slopes want, and blocks of torches."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Segment
from kerfwise.encoder.nest import Contour
from kerfwise.postproc.check.reader.program import Burn, NcProgram
from kerfwise.rules.profile.values import ProfileValues

from .bevel_faces import Slope, half_width_mm, sides_of, slopes_of

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
