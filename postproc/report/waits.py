"""The layer that shows where the torch waits for metal to cool, and for how long."""

from __future__ import annotations

import math
from collections.abc import Sequence

import shapely

from kerfwise.encoder.geometry.segment import Point
from kerfwise.models.plan.plan import PlannedCut

from . import colours
from .legend import duration
from .scene import CAP_HEIGHT, Dot, Item, SceneLayer, Style, TextLine, text_width
from .text_room import TextPlace
from .view import View

_LEAST_RADIUS = 3.0
_ROUND = tuple(k * math.pi / 4 for k in (0, 4, 2, 6, 1, 7, 3, 5))
"""Where a time may stand about its ring, the best first: right, left, above, below, then the corners."""
_FARTHER = (1.0, 2.0, 3.5)
"""How far from the ring, in heights of the text."""


def wait_layer(view: View, cuts: Sequence[PlannedCut], places: Sequence[TextPlace]) -> SceneLayer:
    """A ring about every pierce over which the torch waits, off, and how long.

    The times stand clear of each other and of the labels in `places`, where there is room.
    """
    taken = [_on_page(view, place) for place in places]
    rings: list[Item] = []
    times: list[Item] = []
    for k, planned in enumerate(cuts, 1):
        if planned.dwell_s <= 0:
            continue
        at, radius = view.point(planned.cut.pierce), max(2.4 * view.dot_radius, _LEAST_RADIUS)
        rings.append(Dot(*at, radius, Style(stroke=colours.WAIT, width=max(0.35 * radius, 1.2)), k))
        time, box = _beside(view, at, radius, f"wait {told(planned.dwell_s)}", taken, k)
        taken.append(box)
        times.append(time)
    return SceneLayer("waits", (*rings, *times))


def told(wait_s: float) -> str:
    """A wait for people, short ones to a tenth of a second.

    Examples
    --------
    >>> told(2.25), told(42.0), told(75.2)
    ('2.2 s', '42 s', '1 min 15 s')
    """
    return f"{round(wait_s, 1):g} s" if wait_s < 60 else duration(wait_s)


def _beside(
    view: View, at: Point, radius: float, text: str, taken: Sequence[shapely.Polygon], cut: int
) -> tuple[TextLine, shapely.Polygon]:
    """The text where it covers least of what is taken, and its box."""
    size = view.number_size
    page = shapely.box(0, 0, view.width, view.height)
    wide, high = text_width(text, size, bold=True), size * CAP_HEIGHT
    found: list[tuple[float, Point, shapely.Polygon]] = []
    for far in _FARTHER:
        for angle in _ROUND:
            along, up = math.cos(angle), math.sin(angle)
            x = at[0] + along * (radius + far * 0.5 * high + wide / 2)
            y = at[1] - up * (radius + far * 0.5 * high + high / 2)
            box = shapely.box(x - wide / 2, y - high / 2, x + wide / 2, y + high / 2)
            covered = sum(box.intersection(other).area for other in taken) + 10 * box.difference(page).area
            found.append((round(covered, 3), (x, y), box))
    _, (x, y), box = min(found, key=lambda spot: spot[0])
    return TextLine(x, y, text, size, colours.WAIT, bold=True, halo=colours.PAGE, cut=cut), box


def _on_page(view: View, place: TextPlace) -> shapely.Polygon:
    return shapely.Polygon(view.xy(shapely.get_coordinates(place.box())))
