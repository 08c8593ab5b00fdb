"""Room for a text inside an area: as large as wanted where it fits, else as large as the area allows."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import shapely

from kerfwise.arrays import Floats

from .scene import CAP_HEIGHT, text_width

_AIR = 1.12  # the text's box with some air around it
_SLACK = 0.97  # of the largest radius: among nearly equal spots the nearest is taken
_CIRCLE = 0.05  # how far, in radii that are wanted, the widest circle may be off
_MARGIN = 1 + 1e-9
_TURNED_GAIN = 1.25  # a turned text is harder to read, so it must be this much larger


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


def find_room(
    area: shapely.Geometry,
    text: str,
    wanted_mm: float,
    near: shapely.Geometry | None = None,
    bold: bool = False,
    above_mm: float = 0.0,
) -> TextPlace | None:
    """The place for a text inside an area; None if the area is empty, or no text above a font size fits.

    Parameters
    ----------
    area
        Where the text must lie, polygons in mm.
    text, bold
        What is written.
    wanted_mm
        The font size where there is room enough; a smaller one is taken where there is not.
    near
        What the text should be close to; without it, the middle of the widest spot.
    above_mm
        Texts that are no larger than this are of no interest; one may be given all the same.

    Notes
    -----
    The box of the text lies in an ellipse of the same proportions. The area is stretched until that ellipse is a
    circle; where its centre can be is then the area shrunk by the radius, and the largest one is the maximum
    inscribed circle.

    Examples
    --------
    >>> place = find_room(shapely.box(0, 0, 100, 10), "12", 30.0)
    >>> place.turned, place.size_mm < 15
    (False, True)
    """
    area = _polygons(area)
    if area.is_empty:
        return None
    level, upright = (_Way(area, text, wanted_mm, near, bold, turned) for turned in (False, True))
    if level.most_mm <= above_mm and upright.most_mm <= above_mm:
        return None
    place = level.place()
    enough_mm = _TURNED_GAIN * place.size_mm
    if place.size_mm >= wanted_mm or _largest_turned_mm(area, text, bold) <= enough_mm or upright.most_mm <= enough_mm:
        return place
    turned = upright.place()
    return turned if turned.size_mm > enough_mm else place


def _largest_turned_mm(area: shapely.Geometry, text: str, bold: bool) -> float:
    """A font size that no turned text in an area is larger than: it would be too long, too wide, or fill more."""
    width, height = text_width(text, _AIR, bold), CAP_HEIGHT * _AIR
    x0, y0, x1, y1 = area.bounds
    return float(_MARGIN * min((x1 - x0) / height, (y1 - y0) / width, math.sqrt(area.area / (width * height))))


def _polygons(area: shapely.Geometry) -> shapely.Geometry:
    """The area without what has none: stray lines and points of a cut, or a whole part drawn flat."""
    pieces = shapely.get_parts(area)
    wide = shapely.area(pieces) > 0
    return area if wide.all() else shapely.union_all(pieces[wide])


@dataclass(frozen=True, eq=False)
class _Way:
    """A text that is to stand level, or turned, in an area, which is stretched until the text's ellipse is a circle."""

    area: shapely.Geometry
    text: str
    wanted_mm: float
    near: shapely.Geometry | None
    bold: bool
    turned: bool

    @cached_property
    def stretch(self) -> Floats:
        """By how much, along x and y."""
        ratio = text_width(self.text, 1.0, self.bold) / CAP_HEIGHT
        return np.array([ratio, 1.0] if self.turned else [1.0, ratio])

    @cached_property
    def radius_per_mm(self) -> float:
        """The radius of the circle of a font size, mm, for every mm of that."""
        return _AIR * text_width(self.text, 1.0, self.bold) / math.sqrt(2)

    @cached_property
    def stretched(self) -> shapely.Geometry:
        """The area, stretched."""
        return shapely.transform(self.area, lambda points: points * self.stretch)

    @cached_property
    def widest(self) -> shapely.Geometry:
        """About the widest circle in it: a line from its middle to its rim."""
        return shapely.maximum_inscribed_circle(self.stretched, tolerance=_CIRCLE * self.radius_per_mm * self.wanted_mm)

    @property
    def most_mm(self) -> float:
        """A font size that no text here is larger than: the text's box has a circle in it, stretched as it is."""
        at_most = float(self.widest.length) + _CIRCLE * self.radius_per_mm * self.wanted_mm
        return _MARGIN * math.sqrt(2) * at_most / self.radius_per_mm

    def place(self) -> TextPlace:
        """Where the text stands, as large as can be up to what is wanted."""
        wanted, near = self.radius_per_mm * self.wanted_mm, self.area.centroid if self.near is None else self.near
        target = shapely.transform(near, lambda points: points * self.stretch)
        roomy = self.widest.length > (1 - 2 * _CIRCLE) * wanted  # else nothing is left of the shrunk area
        if self.near is not None and roomy and (place := self._nearest(wanted, target)):
            return place
        radius = _SLACK * self.widest.length
        return _grown(self._nearest(radius, target) or self._at(self.widest, radius), self.area, self.wanted_mm)

    def _nearest(self, radius: float, target: shapely.Geometry) -> TextPlace | None:
        """The place nearest to the target in the area shrunk by a radius, if the text's box fits there."""
        centres = self.stretched.buffer(-radius, quad_segs=4)
        if centres.is_empty:
            return None
        place = self._at(shapely.shortest_line(centres, target), radius)
        # Shrinking by more than the size of its curves can leave specks that lie nowhere near the middle.
        return place if self.area.contains(place.box()) else None

    def _at(self, centre: shapely.Geometry, radius: float) -> TextPlace:
        x, y = (shapely.get_coordinates(centre)[0] / self.stretch).tolist()
        return TextPlace(self.text, x, y, min(radius / self.radius_per_mm, self.wanted_mm), self.bold, self.turned)


def _grown(place: TextPlace, area: shapely.Geometry, wanted_mm: float) -> TextPlace:
    """The same place with a larger font while the box fits: in a rectangle the ellipse wastes the corners."""
    while place.size_mm < wanted_mm:
        larger = replace(place, size_mm=min(1.1 * place.size_mm, wanted_mm))
        if not area.contains(larger.box(_AIR)):
            break
        place = larger
    return place
