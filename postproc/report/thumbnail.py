"""A nest as a picture of a thumb's size: the parts, and how the torch travels between them."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Nest
from kerfwise.models.plan.plan import Plan

from . import colours

WIDTH, HEIGHT = 240, 150
"""Page units that a thumbnail fits in."""
_MARGIN = 3.0
_STRAY = 0.25  # page units that a simplified line may stray from its curve


def thumbnail(nest: Nest, plan: Plan | None = None, alert: Collection[str] = ()) -> str:
    """The nest as a small SVG text without numbers or names: the same nest and plan give the same text.

    Idle travel is drawn where there is a plan, dark at the start and light at the end; contours whose ids are in
    `alert` are red.

    Examples
    --------
    >>> from kerfwise.encoder.by_hand import nest, part, rect
    >>> thumbnail(nest(100, 50, part("A", rect(10, 10, 30, 30)))).startswith('<svg xmlns="http://www.w3.org/2000/svg" ')
    True
    """
    frame = _Frame.of(nest)
    ordered = sorted(nest.parts, key=lambda part: -abs(part.outer.polygon.area))
    zones = {} if plan is None else {nest.contour(p.cut.contour).part: p.cut.zone for p in plan.cuts}
    shapes = [_path([frame.path(nest.sheet.outline), *map(frame.path, nest.sheet.holes)], fill=colours.SHEET,
                    stroke=colours.FAINT)]  # fmt: skip
    for part in ordered:
        fill = colours.zone_tint(zones[part.id] - 1) if zones.get(part.id) else colours.PART
        rings = [frame.path(part.outer.curve), *(frame.path(hole.curve) for hole in part.holes)]
        shapes.append(_path(rings, fill=fill, stroke=colours.OUTER))
    shapes += [_path([frame.path(c.curve)], stroke=colours.ALERT, width=1.6) for c in nest.contours if c.id in alert]
    if plan is not None:
        shapes += _travel(frame, plan)
    width, height = _number(frame.width), _number(frame.height)
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}">'
    return f"{head}{''.join(shapes)}</svg>"


@dataclass(frozen=True, slots=True)
class _Frame:
    """Where the millimetres of the sheet fall: its upper left corner, and page units a millimetre."""

    x0: float
    y1: float
    scale: float
    width: float
    height: float

    @staticmethod
    def of(nest: Nest) -> _Frame:
        x0, y0, x1, y1 = nest.sheet.bounds
        wide, high = max(x1 - x0, 1e-6), max(y1 - y0, 1e-6)
        scale = min((WIDTH - 2 * _MARGIN) / wide, (HEIGHT - 2 * _MARGIN) / high)
        return _Frame(x0, y1, scale, wide * scale + 2 * _MARGIN, high * scale + 2 * _MARGIN)

    def xy(self, points: Floats) -> Floats:
        return np.column_stack([points[:, 0] - self.x0, self.y1 - points[:, 1]]) * self.scale + _MARGIN

    def path(self, curve: Curve) -> str:
        points = self.xy(np.asarray(curve.flatten(_STRAY / self.scale), dtype=np.float64).reshape(-1, 2))
        if curve.closed and len(points) > 2:
            points = shapely.get_coordinates(shapely.LinearRing(points).simplify(_STRAY))[:-1]
        return f"M{_points(points)}{'Z' if curve.closed else ''}"


def _travel(frame: _Frame, plan: Plan) -> Iterator[str]:
    """Idle travel from each cut to the next, in as many colours as it goes through."""
    cuts = [planned.cut for planned in plan.cuts if planned.cut.torch == 1]
    for k, (cut, after) in enumerate(pairwise(cuts)):
        if not after.linked:
            line = frame.xy(np.array([cut.end, after.pierce]))
            yield _path([f"M{_points(line)}"], stroke=colours.time_colour(k / len(cuts)), width=0.9)


def _points(points: Floats) -> str:
    return " ".join(f"{_number(x)},{_number(y)}" for x, y in points.tolist())


def _number(value: float) -> str:
    text = f"{value:.1f}".removesuffix(".0")
    return "0" if text == "-0" else text


def _path(paths: Sequence[str], *, fill: str = "none", stroke: str, width: float = 0.5) -> str:
    data = "".join(paths)
    return f'<path d="{data}" fill="{fill}" fill-rule="evenodd" stroke="{stroke}" stroke-width="{width:g}"/>'
