"""Where the lines of a drawing come in a plan: of which cut each is a piece, and how far along that cut."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import total_ordering

import numpy as np
import shapely

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.encoder.readers.options import ReadOptions
from kerfwise.models.plan.plan import Plan

_NEAR_MM = 0.03
"""How far a drawn line may lie off the contour that it is a piece of, besides what loose ends are joined over."""
_SAMPLES = 9


@total_ordering
@dataclass(frozen=True, slots=True)
class DrawnPlace:
    """The cut that a line belongs to, from 1 on, and how far after the entry its middle comes, mm.

    0 for what the plan does not cut: the sheet's outline, left out layers, writing. `dropped` is a line of a contour
    that the drawing has and the plan leaves uncut.
    """

    position: int
    along_mm: float = 0.0
    dropped: str = ""

    def __lt__(self, other: DrawnPlace) -> bool:
        return (self.position, self.along_mm) < (other.position, other.along_mm)


class DrawnOrder:
    """The contours of a nest as it is drawn, in the order of a plan, to find the places of a drawing's lines."""

    def __init__(self, plan: Plan, nest: Nest, options: ReadOptions) -> None:
        drawn = nest.drawn or nest
        self._cuts = {planned.cut.contour: (k, planned.cut) for k, planned in enumerate(plan.cuts, 1)}
        self._kinds = {contour.id: contour.kind for contour in nest.contours}
        self._contours = drawn.contours
        self._tree = shapely.STRtree([contour.curve.line(_NEAR_MM / 4) for contour in drawn.contours])
        self._off_mm = options.join_tolerance_mm + (options.refit_arcs_mm or 0.0) + _NEAR_MM

    def place(self, curve: Curve) -> DrawnPlace:
        """The place of a drawn line; where contours of two parts share it, that of the one that is cut first."""
        places = [self._place_on(int(k), curve) for k in self._along(curve)]
        cut = [place for place in places if place.position]
        return min(cut or places, default=DrawnPlace(0))

    def _along(self, curve: Curve) -> Iterable[int]:
        """The contours that all of a curve runs along."""
        lengths = np.linspace(0.0, curve.length_mm, _SAMPLES)
        points = shapely.points([curve.point_at(s) for s in lengths.tolist()]) if curve.segments else np.array([])
        which, found = self._tree.query(points, predicate="dwithin", distance=self._off_mm)
        numbers, counts = np.unique(np.unique(np.column_stack([found, which]), axis=0)[:, 0], return_counts=True)
        return numbers[counts == len(points)].tolist() if len(points) else ()

    def _place_on(self, number: int, curve: Curve) -> DrawnPlace:
        contour = self._contours[number]
        if contour.id not in self._cuts or self._kinds.get(contour.id) != contour.kind:
            return DrawnPlace(0, dropped=contour.id)
        position, cut = self._cuts[contour.id]
        ring = contour.curve
        if ring.closed:
            ring = ring.towards(cut.direction)
        elif cut.direction == "cw":
            ring = ring.reversed()
        middle_mm = ring.project(curve.point_at(curve.length_mm / 2))[0]
        entry_mm = ring.project(cut.entry)[0] if ring.closed else 0.0
        return DrawnPlace(position, (middle_mm - entry_mm) % ring.length_mm if ring.closed else middle_mm)


def contours_in_order(plan: Plan, nest: Nest) -> Iterator[tuple[Contour, Curve]]:
    """Every contour that the plan cuts, with its curve from the entry on in the cut's direction."""
    for planned in plan.cuts:
        contour, cut = nest.contour(planned.cut.contour), planned.cut
        ring = contour.curve
        if ring.closed:
            opened = ring.towards(cut.direction).opened_at(ring.towards(cut.direction).project(cut.entry)[0])
            yield contour, Curve(opened.vertices[:-1], closed=True)
        else:
            yield contour, ring if cut.direction == "ccw" else ring.reversed()


@dataclass(frozen=True, slots=True)
class Reordered:
    """A drawing in cutting order: the content of its file, and what the user should know of it."""

    content: bytes
    notes: tuple[str, ...] = ()


def notes_of(dropped: Iterable[str]) -> tuple[str, ...]:
    """That contours are left out which the plan does not cut as they are drawn."""
    names = sorted(set(dropped))
    if not names:
        return ()
    shown = ", ".join(names[:3]) + (", …" if len(names) > 3 else "")
    return (f"the plan does not cut {shown} as drawn: the reordered drawing is without",)
