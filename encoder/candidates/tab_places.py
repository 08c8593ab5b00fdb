"""The tabs of a nest, and which ways to cut a contour leave them where they have room."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
import shapely

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.encoder.cut import Tab
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.tabs import TabOptions, off_mm, unlit

from .approaches import Ways
from .entries import ANYWHERE, MIDDLE, Ranks, shorter_way_mm
from .joints import Outline
from .lead_shapes import Leads
from .profile_keys import IN_PROFILE
from .tab_room import Neighbours, Room, from_lead_mm, no_room, spread, wrong_places

SAME_MM = 0.05
_BESIDE_MM = 0.01
"""A corner in which the torch joins is in the way of a tab that ends there: round it the torch's ring is longer or
shorter than the contour, and the tab would come to lie in the corner."""
_NARROWER_MM = 0.02
"""By so much a lead-in may narrow a tab; the check allows more."""
_MORE = 100
"""Entries more that are tried where tabs are at the end."""


@dataclass(frozen=True, eq=False)
class Wanted:
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

    wanted: Mapping[int, Wanted] = field(default_factory=dict)
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

        Raises
        ------
        InputError
            With every contour that has no room for its tabs, and what to do.
        """
        if options is None:
            return TabPlaces()
        neighbours, asked = Neighbours.of(nest, kerf_mm), frozenset(contours)
        wanted: dict[int, Wanted] = {}
        wrong: dict[str, list[str]] = {}
        for k, part in enumerate(nest.parts):
            name = part.outer.id
            number = nest.index[name]
            if number in asked and options.reason(part) is not None:
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
        half_mm = off_mm(tabbed.tabs[0], self.kerf_mm) / 2
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
            half_mm = off_mm(tabbed.tabs[0], self.kerf_mm) / 2
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
            apart_mm = off_mm(self.wanted[number].tabs[0], self.kerf_mm)
            stop = shapely.points(ways.joints.join[rows] - apart_mm * ways.along[rows])
            gap_mm = shapely.distance(stop, shapely.linestrings(leads.take(rows).points()))
            good[rows] = gap_mm >= apart_mm - _NARROWER_MM
        return good

    def on(self, number: int, outline: Outline, join_mm: float, ccw: bool) -> Left | None:
        """What a way leaves of a contour; None if it has no tabs."""
        tabbed = self.wanted.get(number)
        if tabbed is None:
            return None
        path = outline.path
        join = path.point_at(join_mm)
        ring = path if path.is_ccw == ccw else outline.path_reversed
        tabs = tabbed.tabs
        if self.at_end:
            half_mm = off_mm(tabs[0], self.kerf_mm) / 2
            curve = outline.contour.curve
            at_ring = ring.point_at(ring.project(join)[0] - half_mm)
            tabs = (Tab(curve.point_at(curve.project(at_ring)[0]), tabs[0].width_mm),)
        gaps = unlit(ring, join, tabs, self.kerf_mm)
        stop = ring.point_at(ring.project(join)[0] + gaps[-1][0]) if self.at_end else None
        return Left(tabs, sum(high - low for low, high in gaps), stop)

    def _away(self, tabbed: Wanted, entries_mm: Floats, around_mm: float) -> Bools:
        """Which entries keep off the tabs of a contour."""
        away = np.full(len(entries_mm), True)
        for at_mm, tab in zip(tabbed.at_mm, tabbed.tabs, strict=True):
            least_mm = off_mm(tab, self.kerf_mm) / 2 + from_lead_mm(self.kerf_mm)
            away &= shorter_way_mm(entries_mm, at_mm, around_mm) >= least_mm
        return away


@dataclass(frozen=True, slots=True)
class Left:
    """What a way to cut a contour leaves: its tabs, their length along the torch's way, and where one at the end stops
    it."""

    tabs: tuple[Tab, ...]
    unlit_mm: float
    stop: tuple[float, float] | None


def _wanted(room: Room, drawn: Sequence[Tab], options: TabOptions, entry: Point | None) -> tuple[Wanted, list[str]]:
    """The tabs of a contour, `drawn` those whose places are given, and what is wrong with them."""
    if drawn:
        at_mm = [room.curve.project(tab.at)[0] for tab in drawn]
        wrong = wrong_places(room, drawn, options)
        if options.at_end:
            return Wanted(room, tuple(drawn), drawn_mm=at_mm[0]), wrong
        return _there(room, at_mm, [tab.width_mm for tab in drawn]), wrong
    if options.at_end:
        return Wanted(room, (Tab((0.0, 0.0), options.width_mm),)), []
    at_mm = spread(room, options, None if entry is None else room.curve.project(entry)[0])
    wrong = [no_room(len(at_mm), options)] if len(at_mm) < options.count else []
    return _there(room, at_mm, [options.width_mm] * len(at_mm)), wrong


def _there(room: Room, at_mm: Sequence[float], widths_mm: Sequence[float]) -> Wanted:
    """Tabs with these middles along the contour."""
    tabs = (Tab(room.curve.point_at(mm), width_mm) for mm, width_mm in zip(at_mm, widths_mm, strict=True))
    return Wanted(room, tuple(tabs), tuple(at_mm))
