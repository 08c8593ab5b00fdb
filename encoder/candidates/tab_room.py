"""Where on a contour tabs have room: on straights, away from corners, beside metal that stays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.encoder.cut import Tab
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment_arrays import SegmentArrays
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.encoder.scrap.whole import skeleton
from kerfwise.encoder.tabs import TabOptions, off_mm

from .entries import shorter_way_mm
from .profile_keys import IN_PROFILE

BENT_RAD = np.radians(40)
"""Where a contour turns by more, a tab and what is beside it do not lie on a straight."""
FROM_OTHERS_MM = 2.0
"""A tab keeps so far from another one."""
STAYS_MM = 1.0
"""Metal outside a tab, beyond its own kerf and that of a neighbour, at the least: else it would hold to nothing."""
HOLDS_MM2 = 100.0
"""A piece of metal that is smaller holds no part: it lies loose in a notch, or between parts."""
_BEYOND_MM = 0.1
ON_CONTOUR_MM = 0.5
"""A drawn tab that is further from its contour is not on it."""
_STEPS, _STEP_MM = 400, 1.0
_FAR = 0.75
"""Tabs this share of an even share apart are far enough that the longer straight counts."""


@dataclass(frozen=True, eq=False)
class Neighbours:
    """The lines that are cut, and the sheet's edges: `owner` are numbers of parts, -1 for an edge.

    What a scrap line cuts off a tab holds to nothing.
    """

    tree: shapely.STRtree
    owner: Ints
    holding: shapely.Geometry

    @staticmethod
    def of(nest: Nest, kerf_mm: float) -> Neighbours:
        """The neighbours of all parts, and the pieces of metal that are left when all are cut and that may hold one."""
        cut = [
            (contour.line, owner)
            for contour, owner in zip(nest.contours, nest.owners, strict=True)
            if contour.shapes_part or contour.kind == "scrap"
        ]
        edges = [(ring, -1) for ring in shapely.get_rings(nest.sheet.polygon)]
        lines, owner = zip(*cut, *edges, strict=True)
        left = skeleton(nest.sheet.polygon, shapely.make_valid([part.polygon for part in nest.parts]), kerf_mm)
        pieces = [piece for piece in shapely.get_parts(left) if piece.area > HOLDS_MM2]
        return Neighbours(shapely.STRtree(lines), np.array(owner, dtype=np.int64), shapely.MultiPolygon(pieces))

    def near(self, line: shapely.LineString, part: int, within_mm: float) -> shapely.Geometry:
        """What is so near to a line of a part, and not of the part itself."""
        found = np.sort(self.tree.query(line, "dwithin", distance=within_mm))
        return shapely.union_all(self.tree.geometries[found[self.owner[found] != part]])


@dataclass(frozen=True, eq=False)
class Room:
    """Where on one contour a tab has room: on a straight, away from corners, beside metal that stays."""

    curve: Curve
    bends_mm: Floats
    bends_rad: Floats
    arcs_mm: Floats
    arcs_rad: Floats
    near: shapely.Geometry
    holding: shapely.Geometry
    clear_mm: float
    corner_mm: float
    kerf_mm: float

    @staticmethod
    def of(contour: Contour, part: int, neighbours: Neighbours, corner_mm: float, kerf_mm: float) -> Room:
        """The room on a contour of the part of that number."""
        drawn = SegmentArrays.of(contour.curve)
        clear_mm = 2 * kerf_mm + STAYS_MM
        return Room(
            contour.curve,
            drawn.starts_mm[1:],
            np.abs(drawn.turn_rad),
            drawn.starts_mm,
            np.concatenate([[0.0], np.cumsum(4 * np.abs(np.arctan(drawn.bulge)))]),
            neighbours.near(contour.line, part, clear_mm),
            neighbours.holding,
            clear_mm,
            corner_mm,
            kerf_mm,
        )

    def straight(self, middles_mm: Floats, tab_mm: float) -> Bools:
        """Whether tabs with these middles lie on a straight, `corner_mm` from its ends."""
        half_mm, around_mm = tab_mm / 2 + self.corner_mm, self.curve.length_mm
        if 2 * half_mm >= around_mm:
            return np.full(len(middles_mm), False)
        low, high = middles_mm % around_mm - half_mm, middles_mm % around_mm + half_mm
        turn = np.zeros(len(middles_mm))
        for shift in (-around_mm, 0.0, around_mm):
            a, b = low + shift, high + shift
            turn += np.interp(b, self.arcs_mm, self.arcs_rad) - np.interp(a, self.arcs_mm, self.arcs_rad)
            within = (self.bends_mm > a[:, None] + 1e-6) & (self.bends_mm < b[:, None] - 1e-6)
            turn += (within * self.bends_rad).sum(axis=1)
        return np.asarray(turn <= BENT_RAD)

    def held(self, middles_mm: Floats) -> Bools:
        """Whether metal stays outside tabs with these middles, and enough of it to hold a part."""
        at = [self.curve.point_at(mm) for mm in middles_mm.tolist()]
        points = shapely.points(np.array(at, dtype=np.float64).reshape(-1, 2))
        held = shapely.distance(self.holding, points) <= self.kerf_mm + _BEYOND_MM
        if not self.near.is_empty:
            held &= shapely.distance(self.near, points) >= self.clear_mm
        return np.asarray(held)

    def fits(self, middles_mm: Floats, tab_mm: float) -> Bools:
        """Whether tabs with these middles have room."""
        good = self.straight(middles_mm, tab_mm)
        good[good] = self.held(middles_mm[good])
        return good


def from_lead_mm(kerf_mm: float) -> float:
    """How far a tab keeps from the place where the torch joins."""
    return max(FROM_OTHERS_MM, 2 * kerf_mm)


def spread(room: Room, options: TabOptions, entry_mm: float | None) -> list[float]:
    """Middles of `count` tabs, as many as have room: middles of straight edges first, each far from the others."""
    around_mm = room.curve.length_mm
    tab_mm = options.width_mm + room.kerf_mm
    starts = room.arcs_mm
    straight = np.diff(room.arcs_rad) == 0
    edges = (starts[:-1] + np.diff(starts) / 2)[straight]
    count = max(int(min(_STEPS, around_mm / _STEP_MM)), 16)
    every = np.concatenate([edges, around_mm * np.arange(count) / count])
    length_mm = np.concatenate([np.diff(starts)[straight], np.zeros(count)])
    fits = room.fits(every, tab_mm)
    every, length_mm = every[fits], length_mm[fits]
    least_mm = 2 * (tab_mm + from_lead_mm(room.kerf_mm))
    apart = np.full(len(every), np.inf)
    if entry_mm is not None:
        apart = shorter_way_mm(every, entry_mm, around_mm)
    chosen: list[float] = []
    while len(chosen) < options.count:
        able = apart >= least_mm
        if not able.any():
            break
        far = np.minimum(apart, _FAR * around_mm / options.count)
        score = np.round(far, 3) * around_mm * 10 + np.round(length_mm, 3)
        score = np.where(able, score + np.where(np.isfinite(apart), np.round(apart, 3), 0.0) / (10 * around_mm), -1.0)
        k = int(np.argmax(score))
        chosen.append(float(every[k]))
        apart = np.minimum(apart, shorter_way_mm(every, chosen[-1], around_mm))
    return sorted(chosen)


def no_room(found: int, options: TabOptions) -> str:
    """What to do where a contour has room for fewer tabs than it needs."""
    have = "no room for a tab" if not found else f"room for {found} of {options.count} tabs"
    fewer = f"lower width, corner{', or count' if found else ''}" if options.count > 1 else "lower width or corner"
    return (
        f"{have}: each needs a straight of {options.width_mm + 2 * options.corner_mm:g} mm and a kerf, beside "
        f"metal that stays; {fewer} of {IN_PROFILE['tabs']}, draw its tabs in the nest, or "
        "lock it to have none (tab: off)"
    )


def wrong_places(room: Room, drawn: Sequence[Tab], options: TabOptions) -> list[str]:
    """What is wrong with tabs whose places are given."""
    found = []
    if options.at_end and len(drawn) > 1:
        found.append(f"{len(drawn)} tabs are asked for: each but the last would cost a pierce on the part; leave one")
    middles: list[float] = []
    for tab in drawn:
        at_mm, away_mm = room.curve.project(tab.at)
        place = f"the tab at ({tab.at[0]:g}, {tab.at[1]:g})"
        one, tab_mm = np.array([at_mm]), off_mm(tab, room.kerf_mm)
        if away_mm > ON_CONTOUR_MM:
            found.append(f"{place} is {away_mm:.1f} mm from the contour: give a point on it")
        elif not room.straight(one, tab_mm)[0]:
            edge_mm = _edge_mm(room, at_mm)
            if edge_mm < tab_mm:
                told = f"is wider than its edge: {tab_mm:g} mm with the kerf, on an edge of {edge_mm:.1f} mm"
                found.append(f"{place} {told}; make it narrower, or move it")
            else:
                told = f"lies in a corner, or less than {options.corner_mm:g} mm from one"
                found.append(f"{place} {told}; move it along its edge, or lower corner of {IN_PROFILE['tabs']}")
        elif not room.held(one)[0]:
            told = f"has less than {room.clear_mm:g} mm of waste beside it: no metal would stay that holds it"
            found.append(f"{place} {told}; move it to another edge")
        elif any(
            shorter_way_mm(np.array([at_mm]), other, room.curve.length_mm)[0] < tab_mm + FROM_OTHERS_MM
            for other in middles
        ):
            found.append(f"{place} meets another one; move it")
        middles.append(at_mm)
    return found


def _edge_mm(room: Room, at_mm: float) -> float:
    """How long the segment is on which a place lies."""
    starts = room.arcs_mm
    k = int(np.clip(np.searchsorted(starts, at_mm, side="right") - 1, 0, len(starts) - 2))
    return float(starts[k + 1] - starts[k])
