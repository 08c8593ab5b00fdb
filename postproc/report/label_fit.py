"""Room for a text inside an area: as large as wanted where it fits, else as large as the area allows."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely
from numpy.typing import NDArray

from kerfwise.arrays import Bools, Floats, Ints

from .scene import CAP_HEIGHT, text_width

_AIR = 1.12  # the text's box with some air around it
_SLACK = 0.97  # of the largest radius: among nearly equal spots the nearest is taken
_CIRCLE = 0.05  # how far, in radii that are wanted, the widest circle may be off
_MARGIN = 1 + 1e-9
_TURNED_GAIN = 1.25  # a turned text is harder to read, so it must be this much larger


Shapes = NDArray[np.object_]


@dataclass(frozen=True, slots=True)
class TextPlace:
    """Where a text stands, mm: its middle, its font size, and whether it reads from the bottom to the top."""

    text: str
    x: float
    y: float
    size_mm: float
    bold: bool = False
    turned: bool = False

    def box(self, air: float = 1.0) -> shapely.Polygon:
        """The rectangle that the text fills, mm, `air` times as large."""
        size_mm = air * self.size_mm
        w, h = text_width(self.text, size_mm, self.bold) / 2, size_mm * CAP_HEIGHT / 2
        if self.turned:
            w, h = h, w
        return shapely.box(self.x - w, self.y - h, self.x + w, self.y + h)


@dataclass(frozen=True, eq=False, slots=True)
class Room:
    """A text that is to lie inside an area."""

    area: shapely.Geometry
    """Polygons, mm."""
    text: str
    wanted_mm: float
    """The font size where there is room enough; a smaller one is taken where there is not."""
    near: shapely.Geometry | None = None
    """What the text should be close to; without it, the middle of the widest spot."""
    bold: bool = False
    above_mm: float = 0.0
    """Texts that are no larger than this are of no interest; one may be given all the same."""


def find_rooms(rooms: Sequence[Room]) -> list[TextPlace | None]:
    """The place of each text by itself; None if its area is empty, or no text above a font size fits.

    The box of the text lies in an ellipse of the same proportions. The area is stretched until that ellipse is a
    circle; where its centre can be is then the area shrunk by the radius, and the largest one is the maximum
    inscribed circle.

    Examples
    --------
    >>> (place,) = find_rooms([Room(shapely.box(0, 0, 100, 10), "12", 30.0)])
    >>> place.turned, place.size_mm < 15
    (False, True)
    """
    areas = _polygons([room.area for room in rooms])
    rows = np.flatnonzero(~shapely.is_empty(areas))
    level = _Ways.of([rooms[k] for k in rows.tolist()], areas[rows], turned=False)
    above_mm = np.array([rooms[k].above_mm for k in rows.tolist()])
    small = np.flatnonzero(level.most_mm <= above_mm)
    hopeless = small[level.upright(small).most_mm <= above_mm[small]]
    tried = np.setdiff1d(np.arange(len(rows)), hopeless)
    places = level.take(tried).places()
    size_mm = np.array([place.size_mm for place in places])
    enough_mm = _TURNED_GAIN * size_mm
    turn = np.flatnonzero((size_mm < level.wanted_mm[tried]) & (level.largest_turned_mm(tried) > enough_mm))
    upright = level.upright(tried[turn])
    larger = np.flatnonzero(upright.most_mm > enough_mm[turn])
    for k, turned in zip(turn[larger].tolist(), upright.take(larger).places(), strict=True):
        if turned.size_mm > enough_mm[k]:
            places[k] = turned
    found: list[TextPlace | None] = [None] * len(rooms)
    for k, place in zip(rows[tried].tolist(), places, strict=True):
        found[k] = place
    return found


def _polygons(areas: Sequence[shapely.Geometry]) -> Shapes:
    """The areas without what has none: stray lines and points of a cut, or a whole part drawn flat."""
    whole = np.array(areas, dtype=object)
    pieces, of = shapely.get_parts(whole, return_index=True)
    wide = shapely.area(pieces) > 0
    for k in np.unique(of[~wide]).tolist():
        whole[k] = shapely.union_all(pieces[wide & (of == k)])
    return whole


@dataclass(frozen=True, eq=False)
class _Ways:
    """Texts that are to stand level, or all turned, in areas, which are stretched until a text's ellipse is a circle.

    `unit` is how wide each text is at a font size of 1; `near` has None where nothing is to be near.
    """

    areas: Shapes
    texts: tuple[str, ...]
    unit: Floats
    wanted_mm: Floats
    near: Shapes
    bold: Bools
    turned: bool

    @staticmethod
    def of(rooms: Sequence[Room], areas: Shapes, turned: bool) -> _Ways:
        """The texts of some rooms in areas that are not empty."""
        near = np.empty(len(rooms), dtype=object)
        near[:] = [room.near for room in rooms]
        return _Ways(
            areas,
            tuple(room.text for room in rooms),
            np.array([text_width(room.text, 1.0, room.bold) for room in rooms]),
            np.array([room.wanted_mm for room in rooms]),
            near,
            np.array([room.bold for room in rooms], dtype=np.bool_),
            turned,
        )

    def take(self, chosen: Ints) -> _Ways:
        """Some of them, in that order."""
        less = self._some(chosen, self.turned)
        less.__dict__.update(stretched=self.stretched[chosen], widest=self.widest[chosen])
        return less

    def upright(self, chosen: Ints) -> _Ways:
        """Some of them, turned."""
        return self._some(chosen, turned=True)

    def _some(self, chosen: Ints, turned: bool) -> _Ways:
        texts = tuple(self.texts[k] for k in chosen.tolist())
        unit, wanted_mm = self.unit[chosen], self.wanted_mm[chosen]
        return _Ways(self.areas[chosen], texts, unit, wanted_mm, self.near[chosen], self.bold[chosen], turned)

    @cached_property
    def stretch(self) -> Floats:
        """By how much along x and y, (n, 2)."""
        ratio, one = self.unit / CAP_HEIGHT, np.ones(len(self.unit))
        return np.column_stack([ratio, one] if self.turned else [one, ratio])

    @cached_property
    def radius_per_mm(self) -> Floats:
        """The radius of the circle of a font size, mm, for every mm of that."""
        return _AIR * self.unit / math.sqrt(2)

    @cached_property
    def stretched(self) -> Shapes:
        """The areas, stretched."""
        return _stretched(self.areas, self.stretch)

    @cached_property
    def widest(self) -> Shapes:
        """About the widest circle in each: a line from its middle to its rim."""
        circles: Shapes = shapely.maximum_inscribed_circle(
            self.stretched, tolerance=_CIRCLE * self.radius_per_mm * self.wanted_mm
        )
        return circles

    @property
    def most_mm(self) -> Floats:
        """A font size that no text here is larger than: the text's box has a circle in it, stretched as it is."""
        at_most = shapely.length(self.widest) + _CIRCLE * self.radius_per_mm * self.wanted_mm
        return np.asarray(_MARGIN * math.sqrt(2) * at_most / self.radius_per_mm, dtype=np.float64)

    def largest_turned_mm(self, chosen: Ints) -> Floats:
        """Font sizes that no turned text is larger than: it would be too long, too wide, or fill more than the area."""
        width, height = _AIR * self.unit[chosen], CAP_HEIGHT * _AIR
        x0, y0, x1, y1 = shapely.bounds(self.areas[chosen]).T
        filled = np.sqrt(shapely.area(self.areas[chosen]) / (width * height))
        return np.asarray(_MARGIN * np.minimum(np.minimum((x1 - x0) / height, (y1 - y0) / width), filled))

    def places(self) -> list[TextPlace]:
        """Where the texts stand, as large as can be up to what is wanted."""
        wanted, wide = self.radius_per_mm * self.wanted_mm, shapely.length(self.widest)
        placed = np.array([near is not None for near in self.near], dtype=np.bool_)
        target = np.where(placed, self.near, shapely.centroid(self.areas))
        target = _stretched(target, self.stretch)
        roomy = wide > (1 - 2 * _CIRCLE) * wanted  # else nothing is left of the shrunk area
        x, y, size_mm, fits = _nothing(len(self.texts))
        first = np.flatnonzero(placed & roomy)
        x[first], y[first], size_mm[first], fits[first] = self._nearest(first, wanted[first], target[first])
        rest = np.flatnonzero(~fits)
        radius = _SLACK * wide[rest]
        x[rest], y[rest], size_mm[rest], fits[rest] = self._nearest(rest, radius, target[rest])
        lost = ~fits[rest]
        x[rest[lost]], y[rest[lost]], size_mm[rest[lost]] = self._at(rest[lost], self.widest[rest[lost]], radius[lost])
        size_mm[rest] = self._grown(rest, x[rest], y[rest], size_mm[rest])
        rows = zip(self.texts, x.tolist(), y.tolist(), size_mm.tolist(), self.bold.tolist(), strict=True)
        return [TextPlace(text, at_x, at_y, mm, bold, self.turned) for text, at_x, at_y, mm, bold in rows]

    def _nearest(self, chosen: Ints, radius: Floats, target: Shapes) -> tuple[Floats, Floats, Floats, Bools]:
        """The places nearest to the targets in the areas shrunk by a radius, and whether the texts' boxes fit there."""
        x, y, size_mm, fits = _nothing(len(chosen))
        centres = shapely.buffer(self.stretched[chosen], -radius, quad_segs=4)
        left = np.flatnonzero(~shapely.is_empty(centres))
        lines = shapely.shortest_line(centres[left], target[left])
        x[left], y[left], size_mm[left] = self._at(chosen[left], lines, radius[left])
        # Shrinking by more than the size of its curves can leave specks that lie nowhere near the middle.
        fits[left] = self._contained(chosen[left], x[left], y[left], size_mm[left])
        return x, y, size_mm, fits

    def _at(self, chosen: Ints, centres: Shapes, radius: Floats) -> tuple[Floats, Floats, Floats]:
        """Place and font size of texts in circles around the first points of some lines."""
        points, of = shapely.get_coordinates(centres, return_index=True)
        first = np.searchsorted(of, np.arange(len(chosen)))
        x, y = (points[first] / self.stretch[chosen]).T
        return x, y, np.minimum(radius / self.radius_per_mm[chosen], self.wanted_mm[chosen])

    def _contained(self, chosen: Ints, x: Floats, y: Floats, size_mm: Floats) -> Bools:
        """Whether the boxes of texts of such sizes lie in their areas."""
        w, h = size_mm * self.unit[chosen] / 2, size_mm * CAP_HEIGHT / 2
        if self.turned:
            w, h = h, w
        return np.asarray(shapely.contains(self.areas[chosen], shapely.box(x - w, y - h, x + w, y + h)))

    def _grown(self, chosen: Ints, x: Floats, y: Floats, size_mm: Floats) -> Floats:
        """Larger fonts at the same places while the boxes fit: in a rectangle the ellipse wastes the corners."""
        size_mm, wanted_mm = size_mm.copy(), self.wanted_mm[chosen]
        left = np.flatnonzero(size_mm < wanted_mm)
        while len(left):
            larger = np.minimum(1.1 * size_mm[left], wanted_mm[left])
            fits = self._contained(chosen[left], x[left], y[left], _AIR * larger)
            left, larger = left[fits], larger[fits]
            size_mm[left] = larger
            left = left[larger < wanted_mm[left]]
        return size_mm


def _nothing(count: int) -> tuple[Floats, Floats, Floats, Bools]:
    """Places and sizes to be filled in, none of which fits as yet."""
    return np.zeros(count), np.zeros(count), np.zeros(count), np.zeros(count, dtype=np.bool_)


def _stretched(shapes: Shapes, stretch: Floats) -> Shapes:
    """Each of the shapes stretched along x and y."""
    by = np.repeat(stretch, shapely.get_num_coordinates(shapes), axis=0)
    stretched: Shapes = shapely.transform(shapes, lambda points: points * by)
    return stretched
