"""The path of the torch's centre around a contour: half the kerf into the waste, unlit over tabs, slower at corners."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from itertools import pairwise
from typing import Literal

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.offset import offset_curve, offset_together
from kerfwise.encoder.geometry.segment import Point, Segment

from .cut import Cut, Span, Tab
from .errors import InputError
from .nest import Contour, Nest, Part, cached_with_nest, with_parts


@lru_cache(maxsize=1 << 15)
def compensated(contour: Contour, kerf_mm: float) -> Curve:
    """The path of the torch's centre: half the kerf outside an outer contour, inside a hole, on marks and slits.

    Runs the same way round as the contour is drawn. Answers are kept, since candidates, plans and programs all ask.
    Raises InputError if the kerf leaves nothing of the contour to cut.

    Examples
    --------
    >>> hole = Contour("P.hole1", "P", "hole", Curve.of([(0, 0), (9, 0), (9, 9), (0, 9)]))
    >>> compensated(hole, 2.0).as_rows()
    [[1.0, 1.0], [8.0, 1.0], [8.0, 8.0], [1.0, 8.0]]
    """
    if not contour.encloses or kerf_mm == 0:
        return contour.curve
    try:
        return offset_curve(contour.curve, _outwards_mm(contour, kerf_mm))
    except ValueError as error:
        x, y = contour.curve.start
        raise InputError(
            f"{contour.id} at ({x:.1f}, {y:.1f}) cannot be cut with a kerf of {kerf_mm:g} mm: {error}; "
            "it needs another process, or another drawing"
        ) from None


def compensate_together(contours: Iterable[Contour], kerf_mm: float) -> None:
    """Look for the paths beside contours in one go, so that `compensated` finds most of them made."""
    rings = [c for c in contours if c.encloses]
    offset_together([c.curve for c in rings], [_outwards_mm(c, kerf_mm) for c in rings])


def _outwards_mm(contour: Contour, kerf_mm: float) -> float:
    return kerf_mm / 2 if contour.kind == "outer" else -kerf_mm / 2


# The torch's way along a contour: once round it, or along a stretch of it where others have cut the rest.


def torch_way(
    ring: Curve, join: Point, span: Span | None, tabs: Iterable[Tab], kerf_mm: float
) -> tuple[Curve, tuple[tuple[float, float], ...]]:
    """The torch's way from where it joins to where it leaves or goes off, and the stretches that it makes unlit.

    `ring` is the compensated contour the way the torch goes.

    Examples
    --------
    >>> square = Curve.of([(0, 0), (100, 0), (100, 100), (0, 100)])
    >>> torch_way(square, (0, 60), Span((0, 60), (50, 0)), (), 1.0)[0].as_rows()
    [[0.0, 60.0], [0.0, 0.0], [50.0, 0.0]]
    """
    if span is None:
        return round_with_tabs(ring, join, tabs, kerf_mm)
    begin_mm, end_mm = ring.project(join)[0], ring.project(span.end)[0]
    return ring.between(begin_mm, (end_mm - begin_mm) % ring.length_mm), ()


def way_along(contour: Contour, cut: Cut, kerf_mm: float) -> Iterator[Curve]:
    """The stretch of the torch's round that a cut with a span follows."""
    if cut.span is not None and contour.encloses:
        yield torch_way(compensated(contour, kerf_mm).towards(cut.direction), cut.span.begin, cut.span, (), kerf_mm)[0]


# Tabs: who needs them, and which stretches of the torch's way round they leave unlit.

TabChoice = Literal["tipping", "all", "nest"]
Axis = Literal["x", "y"]
LONGEST_MM = 50.0
"""No tab is wider, its kerf included: a torch that moves on unlit for more than that travels."""
END_MM = 0.01
"""A tab that ends this near to the end of the round is its last stretch."""


@dataclass(frozen=True, slots=True)
class TabOptions:
    """Which parts have tabs, how wide these are, and how far from corners; lengths in mm.

    Slats lie `pitch_mm` apart and run along `slats`. A tool that is lit again at no cost has `count` tabs a part,
    spread round it; `at_end` says that each lighting is a pierce: then there is one, where the cut ends. `there` are
    tabs at places that an operator asks for, by contour id, `none` the contours that are to have none.
    """

    choose: TabChoice
    width_mm: float
    count: int
    corner_mm: float
    pitch_mm: float
    slats: Axis
    at_end: bool
    there: Mapping[str, tuple[Point, ...]] = field(default_factory=dict)
    none: frozenset[str] = frozenset()

    @property
    def longest_mm(self) -> float:
        """How far a torch may move on unlit, and be over a tab."""
        return LONGEST_MM

    def drawn(self, part: Part) -> tuple[Tab, ...]:
        """The tabs of a part whose places are given: by an operator, else in the nest."""
        tabs = self.there.get(part.outer.id, ())
        return tuple(Tab(at, self.width_mm) for at in tabs) or tuple(
            Tab(tab.at, tab.width_mm or self.width_mm) for tab in part.tabs
        )

    def reason(self, part: Part) -> str | None:
        """Why a part is held by tabs; None if it has none."""
        if part.outer.id in self.none:
            return None
        if part.outer.id in self.there:
            return "the operator has locked it"
        if part.tabs:
            return "the nest draws it"
        if self.choose == "all":
            return "every part is"
        return tips(part.polygon, self.pitch_mm, self.slats) if self.choose == "tipping" else None


def tips(metal: shapely.Polygon, pitch_mm: float, slats: Axis) -> str | None:
    """How a part may tip on slats `pitch_mm` apart that run along an axis; None if it lies safely.

    Its centroid is less than a pitch from one end of it, across the slats: then the slats may lie so that none
    supports the short side.

    Examples
    --------
    >>> tips(shapely.box(0, 0, 100, 300), 60, "y")
    'its centroid is 50.0 mm from its left end, and slats lie 60 mm apart'
    >>> tips(shapely.box(0, 0, 120, 300), 60, "y") is None
    True
    """
    across, (low, high) = ("x", ("left", "right")) if slats == "y" else ("y", ("lower", "upper"))
    x0, y0, x1, y1 = metal.bounds
    first, last = (x0, x1) if across == "x" else (y0, y1)
    middle = float(metal.centroid.x if across == "x" else metal.centroid.y)
    near_mm, end = min((middle - first, low), (last - middle, high))
    if near_mm >= pitch_mm - 1e-6:
        return None
    return f"its centroid is {near_mm:.1f} mm from its {end} end, and slats lie {pitch_mm:g} mm apart"


def unlit_length_mm(tab: Tab, kerf_mm: float) -> float:
    """How far the torch moves unlit over a tab: half a kerf more than the metal that stays, at each end."""
    return tab.width_mm + kerf_mm


def unlit(ring: Curve, join: Point, tabs: Iterable[Tab], kerf_mm: float) -> tuple[tuple[float, float], ...]:
    """The stretches of the torch's way round that tabs leave unlit, sorted, mm from where it joins.

    `ring` is the compensated contour the way the torch goes. One that ends with the round is the last stretch.

    Examples
    --------
    >>> square = Curve.of([(0, 0), (100, 0), (100, 100), (0, 100)])
    >>> unlit(square, (0, 0), [Tab((50, 0), 1.0), Tab((0, 1), 1.0)], 1.0)
    ((49.0, 51.0), (398.0, 400.0))
    """
    tabs = tuple(tabs)
    if not tabs:
        return ()
    around_mm, joined_mm = ring.length_mm, ring.project(join)[0]
    found = []
    for tab in tabs:
        half_mm = unlit_length_mm(tab, kerf_mm) / 2
        middle_mm = (ring.project(tab.at)[0] - joined_mm) % around_mm
        low_mm, high_mm = max(middle_mm - half_mm, 0.0), middle_mm + half_mm
        found.append((low_mm, around_mm if high_mm > around_mm - END_MM else high_mm))
    return tuple(sorted(found))


def round_with_tabs(
    ring: Curve, join: Point, tabs: Iterable[Tab], kerf_mm: float
) -> tuple[Curve, tuple[tuple[float, float], ...]]:
    """The torch's way round from where it joins to where it goes off, and the stretches of it that it makes unlit.

    Before a tab at the end of the round the torch goes off.
    """
    gaps = unlit(ring, join, tabs, kerf_mm)
    opened = ring.opened_at(ring.project(join)[0])
    if gaps and gaps[-1][1] >= ring.length_mm - 1e-9:
        return opened.between(0.0, gaps[-1][0]), gaps[:-1]
    return opened, gaps


# Slower feeds at corners: which stretches of a path are cut at which share of its feed.
#
# One definition for the program, the clock and the heat: they all take the stretches from here. The check finds
# corners by itself, in the program that it reads.

Paced = tuple[Segment, float]
"""A line or arc, and the share of the feed that it is cut at."""

SPECK_MM = 0.02
"""Segments shorter than this, which rounding leaves, have no direction that means anything, and make no corners."""
CRUMB_MM = 0.05
"""No stretch begins or ends this near the end of a line or arc, but there."""


@dataclass(frozen=True, slots=True)
class CornerFeed:
    """Where a path turns by `angle_deg` or more, it is cut at a `share` of its feed, `reach_mm` before and behind.

    Examples
    --------
    >>> law = CornerFeed(0.5, 45.0, 2.0)
    >>> path = Curve.of([(0, 0), (10, 0), (10, 10)], closed=False)
    >>> [(round(segment.length_mm, 6), share) for segment, share in law.stretches(path)]
    [(8.0, 1.0), (2.0, 0.5), (2.0, 0.5), (8.0, 1.0)]
    """

    share: float
    angle_deg: float
    reach_mm: float

    def corners_mm(self, path: Curve) -> list[float]:
        """How far along the path each of its corners lies, mm; the ends of an open path are none."""
        known = [(s, at) for s, at in zip(path.segments, path.starts_mm.tolist(), strict=False)]
        sound = [(s, at) for s, at in known if s.length_mm > SPECK_MM]
        pairs = [*pairwise(sound), *([(sound[-1], sound[0])] if path.closed and len(sound) > 1 else [])]
        return [at for (before, _), (after, at) in pairs if _turn_deg(before, after) >= self.angle_deg - 1e-6]

    def stretches(self, path: Curve) -> tuple[Paced, ...]:
        """The path as lines and arcs, cut where the feed changes."""
        slow = list(self._slow(path))
        if not slow:
            return paced(path, None)
        found: list[Paced] = []
        for segment, begin in zip(path.segments, path.starts_mm.tolist(), strict=False):
            length = segment.length_mm
            inner = {x - begin for span in slow for x in span}
            cuts = [0.0, *sorted(x for x in inner if CRUMB_MM < x < length - CRUMB_MM), length]
            for a, b in pairwise(cuts):
                middle = begin + (a + b) / 2
                share = self.share if any(low <= middle <= high for low, high in slow) else 1.0
                whole = (a, b) == (0.0, length)
                found.append((segment if whole else segment.between(a / length, b / length), share))
        return tuple(found)

    def more_mm(self, path: Curve) -> float:
        """By how much longer a path is that takes as long at its full feed."""
        slow_mm = math.fsum(segment.length_mm for segment, share in self.stretches(path) if share < 1)
        return slow_mm * (1 / self.share - 1)

    def _slow(self, path: Curve) -> Iterator[tuple[float, float]]:
        """The stretches near corners as path lengths, in order, each apart from the next."""
        total = path.length_mm
        spans = [(at - self.reach_mm, at + self.reach_mm) for at in self.corners_mm(path)]
        if path.closed:
            spans += [(a + by, b + by) for a, b in spans for by in (-total, total)]
        last: tuple[float, float] | None = None
        for a, b in sorted((max(a, 0.0), min(b, total)) for a, b in spans if a < total and b > 0):
            if last is not None and a <= last[1] + CRUMB_MM:
                last = (last[0], max(b, last[1]))
                continue
            if last is not None:
                yield last
            last = (a, b)
        if last is not None:
            yield last


def paced(path: Curve, law: CornerFeed | None) -> tuple[Paced, ...]:
    """The lines and arcs of a path with their shares of its feed; all of it without a law."""
    return tuple((segment, 1.0) for segment in path.segments) if law is None else law.stretches(path)


def chords(path: Curve, pieces: Sequence[Paced], tolerance_mm: float) -> tuple[Floats, Floats | None]:
    """A path as points (k, 2), and how many times longer than at its full feed it takes for each step (k - 1,).

    `pieces` are all of the path. None where the feed does not change on the way.

    Examples
    --------
    >>> path = Curve.of([(0, 0), (10, 0), (10, 10)], closed=False)
    >>> points, slowness = chords(path, paced(path, CornerFeed(0.5, 45.0, 2.0)), 0.1)
    >>> points.tolist(), slowness.tolist()
    ([[0.0, 0.0], [8.0, 0.0], [10.0, 0.0], [10.0, 2.0], [10.0, 10.0]], [1.0, 2.0, 2.0, 1.0])
    """
    if len({share for _, share in pieces}) < 2:
        return path.flatten(tolerance_mm), None
    steps = [segment.flatten(tolerance_mm) for segment, _ in pieces]
    slowness = np.repeat([1 / share for _, share in pieces], [len(step) for step in steps])
    return np.concatenate([[pieces[0][0].start], *steps]), slowness


def _turn_deg(before: Segment, after: Segment) -> float:
    (ax, ay), (bx, by) = before.tangent_at(1.0), after.tangent_at(0.0)
    return math.degrees(abs(math.atan2(ax * by - ay * bx, ax * bx + ay * by)))


# The nest with what its corners cost in time, where a profile has them cut more slowly.


@cached_with_nest(most=4)
def with_corner_times(nest: Nest, law: CornerFeed, kerf_mm: float) -> Nest:
    """The nest whose contours know how much longer their corners take; it keeps the nest as drawn.

    Leads are not in it, nor is the corner that a contour may be entered at: no way of cutting it takes less.

    Examples
    --------
    >>> from kerfwise.rules.case import nest, part, rect
    >>> plate = nest(200, 100, part("A", rect(10, 10, 80, 60)))
    >>> with_corner_times(plate, CornerFeed(0.5, 45.0, 3.0), 0.0).contour("A.outer").corner_mm
    18.0
    """
    return with_parts(nest, tuple(_part(part, law, kerf_mm) for part in nest.parts))


def _part(part: Part, law: CornerFeed, kerf_mm: float) -> Part:
    outer = _contour(part.outer, law, kerf_mm)
    holes = tuple(_contour(hole, law, kerf_mm) for hole in part.holes)
    slits = tuple(_contour(slit, law, kerf_mm) for slit in part.slits)
    kept = zip((outer, *holes, *slits), (part.outer, *part.holes, *part.slits), strict=True)
    return part if all(new is old for new, old in kept) else replace(part, outer=outer, holes=holes, slits=slits)


def _contour(contour: Contour, law: CornerFeed, kerf_mm: float) -> Contour:
    try:
        path = compensated(contour, kerf_mm) if contour.encloses else contour.curve
    except InputError:  # the kerf leaves nothing of it: whoever plans the nest says so
        return contour
    entered_mm = 2 * law.reach_mm * (1 / law.share - 1) if path.closed else 0.0
    more_mm = law.more_mm(path) - entered_mm
    return replace(contour, corner_mm=more_mm) if more_mm > 0 else contour
