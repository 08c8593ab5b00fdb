"""The tabs of a nest: where they have room, and which ways to cut a contour leave them."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
import shapely

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.encoder.cut import Tab
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.geometry.segment_arrays import SegmentArrays
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.encoder.scrap import skeleton
from kerfwise.encoder.torch_path import TabOptions, unlit, unlit_length_mm

from .entries import ANYWHERE, IN_PROFILE, MIDDLE, Leads, Outline, Ranks, Ways, shorter_way_mm

SAME_MM = 0.05
_BESIDE_MM = 0.01
"""A corner in which the torch joins is in the way of a tab that ends there: round it the torch's ring is longer or
shorter than the contour, and the tab would come to lie in the corner."""
_NARROWER_MM = 0.02
"""By so much a lead-in may narrow a tab; the check allows more."""
_MORE = 100
"""Entries more that are tried where tabs are at the end."""


@dataclass(frozen=True, eq=False)
class ContourTabs:
    """The tabs of one contour: `at_mm` are their middles along it as drawn, none where the end of the cut decides.

    `drawn_mm` is the middle of the one at the end, where that is asked for.
    """

    room: Room
    tabs: tuple[Tab, ...]
    at_mm: tuple[float, ...] = ()
    drawn_mm: float | None = None


@dataclass(frozen=True, eq=False)
class TabPlaces:
    """The tabs of a nest, by the numbers of contours."""

    wanted: Mapping[int, ContourTabs] = field(default_factory=dict)
    at_end: bool = False
    kerf_mm: float = 0.0

    @staticmethod
    def of(
        nest: Nest,
        contours: Collection[int],
        options: TabOptions | None,
        kerf_mm: float,
        entries: Mapping[str, Point],
    ) -> TabPlaces:
        """Where tabs go on these contours; `entries` are those that an operator asks for.

        Raises InputError with every contour that has no room for its tabs, and what to do.
        """
        if options is None:
            return TabPlaces()
        neighbours, numbers = Neighbours.of(nest, kerf_mm), frozenset(contours)
        wanted: dict[int, ContourTabs] = {}
        wrong: dict[str, list[str]] = {}
        for k, part in enumerate(nest.parts):
            name = part.outer.id
            number = nest.index[name]
            if number in numbers and options.reason(part) is not None:
                room = Room.of(part.outer, k, neighbours, options.corner_mm, kerf_mm)
                wanted[number], texts = _wanted(room, options.drawn(part), options, entries.get(name))
                if texts:
                    wrong[name] = texts
        if wrong:
            parts = "a part has" if len(wrong) == 1 else f"{len(wrong)} parts have"
            raise InputError(
                f"{parts} no room for tabs ({IN_PROFILE['tabs']})",
                file=nest.file or None,
                details=tuple(f"{name}: {text}" for name, texts in wrong.items() for text in texts),
            )
        return TabPlaces(wanted, options.at_end, kerf_mm)

    def entries(self, outline: Outline, at_mm: Floats, ranks: Ranks) -> tuple[Floats, Ranks]:
        """The places of a contour that could be entries: those that leave its tabs alone, and more of them."""
        tabbed = self.wanted.get(outline.index)
        if tabbed is None:
            return at_mm, ranks
        around_mm = outline.around_mm
        if not self.at_end:
            away = self._away(tabbed, at_mm, around_mm)
            return at_mm[away], ranks[away]
        half_mm = unlit_length_mm(tabbed.tabs[0], self.kerf_mm) / 2
        if tabbed.drawn_mm is not None:
            both = np.array([tabbed.drawn_mm - half_mm, tabbed.drawn_mm + half_mm]) % around_mm
            return both, np.full(2, MIDDLE)
        more = around_mm * np.arange(_MORE) / _MORE
        every, rank = np.concatenate([at_mm, more]), np.concatenate([ranks, np.full(_MORE, ANYWHERE)])
        long_mm = 2 * half_mm + _BESIDE_MM
        fits = tabbed.room.fits(every - half_mm, long_mm) | tabbed.room.fits(every + half_mm, long_mm)
        return every[fits], rank[fits]

    def all_entries(
        self, outlines: Sequence[Outline], at_mm: Floats, ranks: Ranks, of: Ints
    ) -> tuple[Floats, Ranks, Ints]:
        """The same of several contours; `of`, ascending, numbers the outline of each place."""
        tabbed = [k for k, outline in enumerate(outlines) if outline.index in self.wanted]
        if not tabbed:
            return at_mm, ranks, of
        ends = np.searchsorted(of, np.arange(len(outlines) + 1)).tolist()
        pieces = [(at_mm[a:b], ranks[a:b]) for a, b in pairwise(ends)]
        for k in tabbed:
            pieces[k] = self.entries(outlines[k], *pieces[k])
        count = [len(at) for at, _ in pieces]
        whose = np.repeat(np.arange(len(outlines)), count)
        return np.concatenate([at for at, _ in pieces]), np.concatenate([rank for _, rank in pieces]), whose

    def lawful(self, ways: Ways, outlines: Mapping[int, Outline]) -> Bools:
        """Which ways to join contours leave the tabs of these where they have room."""
        good = np.full(len(ways), True)
        joints = ways.joints
        for number in sorted(set(joints.contour.tolist()) & self.wanted.keys()):
            tabbed, rows = self.wanted[number], np.flatnonzero(joints.contour == number)
            around_mm = outlines[number].around_mm
            if not self.at_end:
                good[rows] = self._away(tabbed, joints.entry_mm[rows], around_mm)
                continue
            half_mm = unlit_length_mm(tabbed.tabs[0], self.kerf_mm) / 2
            onwards = ways.ccw[rows] == outlines[number].contour.curve.is_ccw
            middles = joints.entry_mm[rows] + np.where(onwards, -half_mm, half_mm)
            if tabbed.drawn_mm is not None:
                good[rows] = shorter_way_mm(middles, tabbed.drawn_mm, around_mm) <= SAME_MM
            else:
                good[rows] = tabbed.room.fits(middles, 2 * half_mm + _BESIDE_MM)
        return good

    def beside(self, leads: Leads, ways: Ways) -> Bools:
        """Which lead-ins leave a tab at the end as wide as it is to be: one that leans over it burns its metal."""
        good = np.full(len(ways), True)
        if not self.at_end:
            return good
        for number in sorted(set(ways.joints.contour.tolist()) & self.wanted.keys()):
            rows = np.flatnonzero(ways.joints.contour == number)
            apart_mm = unlit_length_mm(self.wanted[number].tabs[0], self.kerf_mm)
            stop = shapely.points(ways.joints.join[rows] - apart_mm * ways.along[rows])
            gap_mm = shapely.distance(stop, shapely.linestrings(leads.take(rows).points()))
            good[rows] = gap_mm >= apart_mm - _NARROWER_MM
        return good

    def on(self, number: int, outline: Outline, join_mm: float, ccw: bool) -> CandidateTabs | None:
        """What a way leaves of a contour; None if it has no tabs."""
        tabbed = self.wanted.get(number)
        if tabbed is None:
            return None
        path = outline.path
        join = path.point_at(join_mm)
        ring = path if path.is_ccw == ccw else outline.path_reversed
        tabs = tabbed.tabs
        if self.at_end:
            half_mm = unlit_length_mm(tabs[0], self.kerf_mm) / 2
            curve = outline.contour.curve
            at_ring = ring.point_at(ring.project(join)[0] - half_mm)
            tabs = (Tab(curve.nearest(at_ring), tabs[0].width_mm),)
        gaps = unlit(ring, join, tabs, self.kerf_mm)
        stop = ring.point_at(ring.project(join)[0] + gaps[-1][0]) if self.at_end else None
        return CandidateTabs(tabs, sum(high - low for low, high in gaps), stop)

    def _away(self, tabbed: ContourTabs, entries_mm: Floats, around_mm: float) -> Bools:
        """Which entries keep off the tabs of a contour."""
        away = np.full(len(entries_mm), True)
        for at_mm, tab in zip(tabbed.at_mm, tabbed.tabs, strict=True):
            least_mm = unlit_length_mm(tab, self.kerf_mm) / 2 + lead_distance_mm(self.kerf_mm)
            away &= shorter_way_mm(entries_mm, at_mm, around_mm) >= least_mm
        return away


@dataclass(frozen=True, slots=True)
class CandidateTabs:
    """What a way to cut a contour leaves: its tabs, their length along the torch's way, and where one at the end stops
    it."""

    tabs: tuple[Tab, ...]
    unlit_mm: float
    stop: tuple[float, float] | None


def _wanted(
    room: Room, drawn: Sequence[Tab], options: TabOptions, entry: Point | None
) -> tuple[ContourTabs, list[str]]:
    """The tabs of a contour, `drawn` those whose places are given, and what is wrong with them."""
    if drawn:
        at_mm = [room.curve.project(tab.at)[0] for tab in drawn]
        wrong = wrong_tab_places(room, drawn, options)
        if options.at_end:
            return ContourTabs(room, tuple(drawn), drawn_mm=at_mm[0]), wrong
        return _there(room, at_mm, [tab.width_mm for tab in drawn]), wrong
    if options.at_end:
        return ContourTabs(room, (Tab((0.0, 0.0), options.width_mm),)), []
    at_mm = spread_tabs(room, options, None if entry is None else room.curve.project(entry)[0])
    wrong = [no_tab_room_message(len(at_mm), options)] if len(at_mm) < options.count else []
    return _there(room, at_mm, [options.width_mm] * len(at_mm)), wrong


def _there(room: Room, at_mm: Sequence[float], widths_mm: Sequence[float]) -> ContourTabs:
    """Tabs with these middles along the contour."""
    tabs = (Tab(room.curve.point_at(mm), width_mm) for mm, width_mm in zip(at_mm, widths_mm, strict=True))
    return ContourTabs(room, tuple(tabs), tuple(at_mm))


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


def lead_distance_mm(kerf_mm: float) -> float:
    """How far a tab keeps from the place where the torch joins."""
    return max(FROM_OTHERS_MM, 2 * kerf_mm)


def spread_tabs(room: Room, options: TabOptions, entry_mm: float | None) -> list[float]:
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
    least_mm = 2 * (tab_mm + lead_distance_mm(room.kerf_mm))
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


def no_tab_room_message(found: int, options: TabOptions) -> str:
    """What to do where a contour has room for fewer tabs than it needs."""
    have = "no room for a tab" if not found else f"room for {found} of {options.count} tabs"
    fewer = "lower width, corner or count" if found and options.count > 1 else "lower width or corner"
    return (
        f"{have}: each needs a straight of {options.width_mm + 2 * options.corner_mm:g} mm and a kerf, beside "
        f"metal that stays; {fewer} of {IN_PROFILE['tabs']}, draw its tabs in the nest, or "
        "lock it to have none (tab: off)"
    )


def wrong_tab_places(room: Room, drawn: Sequence[Tab], options: TabOptions) -> list[str]:
    """What is wrong with tabs whose places are given."""
    found = []
    if options.at_end and len(drawn) > 1:
        found.append(f"{len(drawn)} tabs are asked for: each but the last would cost a pierce on the part; leave one")
    middles: list[float] = []
    for tab in drawn:
        at_mm, away_mm = room.curve.project(tab.at)
        place = f"the tab at ({tab.at[0]:g}, {tab.at[1]:g})"
        one, tab_mm = np.array([at_mm]), unlit_length_mm(tab, room.kerf_mm)
        if away_mm > ON_CONTOUR_MM:
            found.append(f"{place} is {away_mm:.1f} mm from the contour: give a point on it")
        elif not room.straight(one, tab_mm)[0]:
            edge_mm = _edge_mm(room, at_mm)
            if edge_mm < tab_mm:
                text = f"is wider than its edge: {tab_mm:g} mm with the kerf, on an edge of {edge_mm:.1f} mm"
                found.append(f"{place} {text}; make it narrower, or move it")
            else:
                text = f"lies in a corner, or less than {options.corner_mm:g} mm from one"
                found.append(f"{place} {text}; move it along its edge, or lower corner of {IN_PROFILE['tabs']}")
        elif not room.held(one)[0]:
            text = f"has less than {room.clear_mm:g} mm of waste beside it: no metal would stay that holds it"
            found.append(f"{place} {text}; move it to another edge")
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
