"""Tabs: who needs them, and which stretches of the torch's way round they leave unlit."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Literal

import shapely

from .cut import Tab
from .geometry.curve import Curve
from .geometry.segment import Point
from .nest import Part

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
        asked = self.there.get(part.outer.id, ())
        return tuple(Tab(at, self.width_mm) for at in asked) or tuple(
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


def off_mm(tab: Tab, kerf_mm: float) -> float:
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
        half_mm = off_mm(tab, kerf_mm) / 2
        middle_mm = (ring.project(tab.at)[0] - joined_mm) % around_mm
        low_mm, high_mm = max(middle_mm - half_mm, 0.0), middle_mm + half_mm
        found.append((low_mm, around_mm if high_mm > around_mm - END_MM else high_mm))
    return tuple(sorted(found))


def once_round(
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
