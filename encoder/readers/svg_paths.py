"""SVG shapes as curves: circular arcs stay arcs, everything bent otherwise becomes arcs again."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import svgelements

from kerfwise.arrays import Floats
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point

from .arcs import FLATTEN_MM, fit_arcs
from .limits import LIMIT_MM, checked_curve

ROUND = 1e-6
"""An elliptical arc whose radii differ by less than this share is circular."""


def curves(shape: Any, to_mm: Any) -> list[Curve]:
    """The subpaths of a shape in mm, y up.

    Parameters
    ----------
    shape
        Any svgelements.Shape.
    to_mm
        The svgelements.Matrix from its coordinates to mm.
    """
    found = []
    for subpath in abs(svgelements.Path(shape) * to_mm).as_subpaths():
        rows: list[Floats] = []
        end, shut = None, False
        for segment in svgelements.Path(subpath):
            if isinstance(segment, svgelements.Move):
                continue
            shut = shut or isinstance(segment, svgelements.Close)
            if segment.start is not None and segment.end is not None and segment.start != segment.end:
                vertices = _vertices(segment)
                rows.append(vertices[:-1])
                end = vertices[-1:]
        if end is not None:
            vertices = np.concatenate([*rows, end])
            closed = shut or bool(np.hypot(*(vertices[0] - vertices[-1])[:2]) < 1e-6)
            found.append(checked_curve(vertices, closed))
    return found


def _vertices(segment: Any) -> Floats:
    """The vertices of one segment, the last with bulge 0."""
    match segment:
        case svgelements.Arc():
            return _arc(segment)
        case svgelements.CubicBezier() | svgelements.QuadraticBezier():
            return _bezier(segment)
    return np.array([(*segment.start, 0.0), (*segment.end, 0.0)])


def _arc(arc: Any) -> Floats:
    if abs(arc.rx - arc.ry) < ROUND * max(arc.rx, arc.ry):
        start, middle, end = _at(arc, 0), _at(arc, 0.5), _at(arc, 1)
        halves = [(start, _at(arc, 0.25), middle), (middle, _at(arc, 0.75), end)]
        whole = [(start, middle, end)]
        rows = [(*a, _bulge(a, m, b)) for a, m, b in (halves if abs(arc.sweep) > math.pi else whole)]
        return np.array([*rows, (*end, 0.0)])
    _refuse_far([arc.center.x, arc.center.y, arc.rx, arc.ry])
    step = 2 * math.sqrt(2 * FLATTEN_MM / max(arc.rx, arc.ry, FLATTEN_MM))
    return _sampled(arc, max(8, math.ceil(abs(arc.sweep) / step)))


def _bezier(curve: Any) -> Floats:
    """Points at equal steps of the parameter, as many as Wang's formula asks for.

    The chords of a Bézier curve of degree d, cut in n, stay within d (d - 1) L / (8 n²) of it, L the largest second
    difference of its control points (Wang 1984).
    """
    control = np.array([(p.x, p.y) for p in curve])
    _refuse_far(control.ravel().tolist())
    degree = len(control) - 1
    bend = float(np.hypot(*np.diff(control, 2, axis=0).T).max())
    return _sampled(curve, max(2, math.ceil(math.sqrt(degree * (degree - 1) * bend / (8 * FLATTEN_MM)))))


def _sampled(segment: Any, pieces: int) -> Floats:
    points = np.array(segment.npoint(np.arange(pieces + 1) / pieces))
    points[0], points[-1] = segment.start, segment.end  # exact, so that neighbours still meet
    keep = np.append(np.hypot(*np.diff(points, axis=0).T) > 1e-9, True)
    return fit_arcs(points[keep])


def _at(segment: Any, fraction: float) -> Point:
    ends = {0.0: segment.start, 1.0: segment.end}
    point = ends[fraction] if fraction in ends else segment.point(fraction)
    return float(point.x), float(point.y)


def _bulge(start: Point, middle: Point, end: Point) -> float:
    """The bulge of the arc through three points, the second half-way along."""
    across = (end[0] - start[0]) * (middle[1] - start[1]) - (end[1] - start[1]) * (middle[0] - start[0])
    return -2 * across / math.dist(start, end) ** 2


def _refuse_far(numbers: list[float]) -> None:
    """Flattening a curve of astronomic size would never end."""
    if not all(abs(x) <= LIMIT_MM for x in numbers):
        raise InputError(
            "a curve reaches more than a kilometre from the origin: if the units are wrong, "
            "pass --units (in Python: units=)"
        )
