"""Room for a text inside an area: as large as wanted where it fits, else as large as the area allows."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import shapely

from .scene import CAP_HEIGHT, text_width

_AIR = 1.12  # the text's box with some air around it
_SLACK = 0.97  # of the largest radius: among nearly equal spots the nearest is taken
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
) -> TextPlace | None:
    """The place for a text inside an area; None if the area is empty.

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
    level = _room_one_way(area, text, wanted_mm, near, bold, turned=False)
    if level.size_mm >= wanted_mm:
        return level
    turned = _room_one_way(area, text, wanted_mm, near, bold, turned=True)
    return turned if turned.size_mm > _TURNED_GAIN * level.size_mm else level


def _polygons(area: shapely.Geometry) -> shapely.Geometry:
    """The area without what has none: stray lines and points of a cut, or a whole part drawn flat."""
    pieces = shapely.get_parts(area)
    wide = shapely.area(pieces) > 0
    return area if wide.all() else shapely.union_all(pieces[wide])


def _room_one_way(
    area: shapely.Geometry, text: str, wanted_mm: float, near: shapely.Geometry | None, bold: bool, turned: bool
) -> TextPlace:
    width, height = text_width(text, 1.0, bold), CAP_HEIGHT
    stretch = np.array([width / height, 1.0] if turned else [1.0, width / height])
    stretched = shapely.transform(area, lambda points: points * stretch)
    target = shapely.transform(area.centroid if near is None else near, lambda points: points * stretch)
    radius_per_mm = _AIR * width / math.sqrt(2)

    def at(centre: shapely.Geometry, radius: float) -> TextPlace:
        x, y = (shapely.get_coordinates(centre)[0] / stretch).tolist()
        return TextPlace(text, x, y, min(radius / radius_per_mm, wanted_mm), bold, turned)

    def nearest(radius: float) -> TextPlace | None:
        centres = stretched.buffer(-radius, quad_segs=4)
        if centres.is_empty:
            return None
        place = at(shapely.shortest_line(centres, target), radius)
        # Shrinking by more than the size of its curves can leave specks that lie nowhere near the middle.
        return place if area.contains(place.box()) else None

    if near is not None and (place := nearest(radius_per_mm * wanted_mm)):
        return place
    widest = shapely.maximum_inscribed_circle(stretched, tolerance=0.05 * radius_per_mm * wanted_mm)
    radius = _SLACK * widest.length
    return _grown(nearest(radius) or at(widest, radius), area, wanted_mm)


def _grown(place: TextPlace, area: shapely.Geometry, wanted_mm: float) -> TextPlace:
    """The same place with a larger font while the box fits: in a rectangle the ellipse wastes the corners."""
    while place.size_mm < wanted_mm:
        larger = replace(place, size_mm=min(1.1 * place.size_mm, wanted_mm))
        if not area.contains(larger.box(_AIR)):
            break
        place = larger
    return place
