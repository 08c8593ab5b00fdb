"""Holes too small to be cut, and those that are cut more slowly: the nest as it is cut, made of the nest as drawn.

The diameter of a hole is that of the largest circle inside it: of a round hole its own, of a slot its width. A hole
under the limit is not cut through: a short mark at its middle says where to drill it (`spot`), or it is left out
(`skip`). In a hole that is cut the feed falls in a line from the cut feed at `full_feed_mm` to `feed_share` of it at
`least_mm`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal

import numpy as np
import shapely

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.measures import largest_circle, middle_of, wider_than

from .nest import Contour, Nest, Part, cached_with_nest, with_parts

Under = Literal["ask", "refuse", "spot", "skip"]

EXACT_MM = 0.0125
"""A hole is under a limit where it is smaller by more than this, which drawings and arithmetic leave."""

SPOT_SHARE = 0.8
"""A spot reaches no further from the middle of its hole than this share of the way to its edge."""

_OFF_MIDDLE = 0.25
"""A spot shows where a hole is only if the hole's middle lies in it, so many diameters or more from its edge."""


@dataclass(frozen=True, slots=True)
class HoleLimits:
    """What is done with holes by their diameter, mm; the default leaves all as they are.

    Holes under `least_mm` are not cut but treated as `under` says. With spot and skip so are those under `room_mm`, in
    which no pierce keeps its clearance. `spot_mm` is how long the arms of a spot are from end to end.
    """

    least_mm: float = 0.0
    under: Under = "ask"
    room_mm: float = 0.0
    full_feed_mm: float = 0.0
    feed_share: float = 1.0
    spot_mm: float = 2.0

    @property
    def limit_mm(self) -> float:
        """Holes under this are not cut."""
        return max(self.least_mm, self.room_mm) if self.treated else self.least_mm

    @property
    def treated(self) -> bool:
        """Whether small holes are marked or left out."""
        return self.under in ("spot", "skip")

    def share_at(self, diameter_mm: float) -> float:
        """The share of the cut feed that a hole of this diameter is cut at.

        Examples
        --------
        >>> limits = HoleLimits(least_mm=6, full_feed_mm=30, feed_share=0.6)
        >>> limits.share_at(6), limits.share_at(18), limits.share_at(30)
        (0.6, 0.8, 1.0)
        """
        if diameter_mm >= self.full_feed_mm or self.feed_share == 1:
            return 1.0
        reach_mm = self.full_feed_mm - self.least_mm
        far = min(max((self.full_feed_mm - diameter_mm) / reach_mm, 0.0), 1.0) if reach_mm > 0 else 1.0
        return 1.0 - (1.0 - self.feed_share) * far


@lru_cache(maxsize=1 << 15)
def diameter_under(hole: Contour, mm: float) -> float | None:
    """The diameter of a hole, mm, where that is under a limit; else None."""
    if mm <= 0 or wider_than(hole.curve, mm):
        return None
    diameter_mm = largest_circle(hole.curve)[1]
    return diameter_mm if diameter_mm < mm - EXACT_MM else None


def with_small_holes(nest: Nest, limits: HoleLimits) -> Nest:
    """The nest as it is cut: small holes are marks or gone, and others know their share of the cut feed.

    The nest that comes out keeps the one that went in as `drawn`; where nothing changes it is that one. A hole that
    can be neither marked nor left out stays a hole (see `kept_hole_reason`).

    Examples
    --------
    >>> from kerfwise.rules.case import circle, nest, part, rect
    >>> plate = nest(200, 100, part("A", rect(10, 10, 80, 80), [circle(30, 50, 2), circle(60, 50, 9)]))
    >>> made = with_small_holes(plate, HoleLimits(least_mm=6, under="spot", full_feed_mm=30, feed_share=0.6))
    >>> [(c.id, c.kind, c.feed_share) for c in made.contours]
    [('A.hole1', 'mark', 1.0), ('A.hole2', 'hole', 0.8), ('A.outer', 'outer', 1.0)]
    >>> made.drawn is plate, made.spotted, made.left_out
    (True, ('A.hole1',), ())
    """
    return _as_cut(nest.drawn or nest, limits)


@cached_with_nest(most=8)
def _as_cut(nest: Nest, limits: HoleLimits) -> Nest:
    return with_parts(nest, tuple(_part(nest, part, limits) for part in nest.parts))


def _part(nest: Nest, part: Part, limits: HoleLimits) -> Part:
    holes: list[Contour] = []
    spots: list[Contour] = []
    for hole in part.holes:
        diameter_mm = diameter_under(hole, max(limits.limit_mm, limits.full_feed_mm))
        small = diameter_mm is not None and diameter_mm < limits.limit_mm - EXACT_MM
        if small and limits.treated and kept_hole_reason(nest, hole, limits) is None:
            if limits.under == "spot":
                spots.append(spot(hole, limits))
            continue
        share = 1.0 if diameter_mm is None else limits.share_at(diameter_mm)
        holes.append(hole if share == 1.0 else replace(hole, feed_share=share))
    if len(holes) == len(part.holes) and all(new is old for new, old in zip(holes, part.holes, strict=True)):
        return part
    return replace(part, holes=tuple(holes), marks=(*part.marks, *spots))


def kept_hole_reason(nest: Nest, hole: Contour, limits: HoleLimits) -> str | None:
    """Why a small hole can be neither marked nor left out, as the end of a sentence; None where it can."""
    within = (nest.parts[k].id for k in np.flatnonzero(shapely.intersects(hole.polygon, _outer_points(nest))))
    guest = next((part for part in within if part != hole.part), None)
    if guest is not None:
        return f"{guest} lies in it"
    if limits.under == "spot" and middle_of(hole.curve)[1] < _OFF_MIDDLE * largest_circle(hole.curve)[1]:
        return "its middle lies outside it, so that a spot would not show where it is"
    return None


@cached_with_nest(most=1)
def _outer_points(nest: Nest) -> np.ndarray[tuple[int], np.dtype[np.object_]]:
    """A point of the outline of every part."""
    return np.asarray(shapely.points([part.outer.curve.vertices[0, :2] for part in nest.parts]))


def spot(hole: Contour, limits: HoleLimits) -> Contour:
    """The mark at the middle of a hole, under the hole's own id: a cross, along x and then along y, in one stroke."""
    (x, y), edge_mm = middle_of(hole.curve)
    arm = min(limits.spot_mm / 2, SPOT_SHARE * edge_mm)
    stroke = [(x - arm, y), (x + arm, y), (x, y), (x, y + arm), (x, y - arm)]
    return Contour(hole.id, hole.part, "mark", Curve.of(stroke, closed=False), source=hole.source)


def uncut_hole_reasons(nest: Nest, limits: HoleLimits) -> dict[str, str]:
    """For every hole that a nest as it is cut has marked or left out: its size, the limit, and what is done."""
    drawn = nest.drawn or nest
    done = dict.fromkeys(nest.spotted, "marked at its middle") | dict.fromkeys(nest.left_out, "left out")
    found = {}
    for name, what in done.items():
        diameter_mm = largest_circle(drawn.contour(name).curve)[1]
        found[name] = f"{too_small(name, diameter_mm, limits)}: it is {what} (small_holes.under: {limits.under})"
    return found


def too_small(name: str, diameter_mm: float, limits: HoleLimits) -> str:
    """The size of a small hole and the limit that it is under, as the beginning of a sentence."""
    if diameter_mm < limits.least_mm - EXACT_MM:
        return f"{name} is {diameter_mm:.2f} mm across, less than small_holes.min_hole, {limits.least_mm:g} mm"
    return f"{name} is {diameter_mm:.2f} mm across, and a pierce needs {limits.room_mm:g} mm to keep its clearance"
