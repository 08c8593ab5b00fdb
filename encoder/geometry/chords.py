"""Paths of lines and arcs as points: the arcs of several are cut into chords at once."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.ranges import laid_out

from .segment import Point, Segment

if TYPE_CHECKING:
    from .curve import Curve

SHORT_MM = 1e-8
"""Lines are surely not left out where they are longer."""


def flattened_together(curves: Sequence[Curve], tolerance_mm: float) -> Iterator[Floats]:
    """Array (m, 2) of points a curve, whose chords stay within `tolerance_mm`; a closed one does not repeat its first.

    They are views of one array, or of the vertices of curves that are nothing but lines; not to be changed.
    """
    straight = _surely_straight(curves)
    bent = _with_lines([curve for curve, known in zip(curves, straight, strict=True) if not known], tolerance_mm)
    return (curve.vertices[:, :2] if known else next(bent) for curve, known in zip(curves, straight, strict=True))


def _surely_straight(curves: Sequence[Curve]) -> list[bool]:
    """Whether curves have no arcs, and no lines so short that they are left out."""
    if not curves:
        return []
    sizes = np.array([len(curve.vertices) for curve in curves])
    x, y, bulge = np.concatenate([curve.vertices for curve in curves]).T
    of, last = np.repeat(np.arange(len(curves)), sizes), np.cumsum(sizes) - 1
    onward = np.arange(len(x)) + 1
    drawn = sizes > 0
    onward[last[drawn]] = (last - sizes + 1)[drawn]
    wrong = np.maximum(abs(x[onward] - x), abs(y[onward] - y)) <= SHORT_MM
    wrong[last[np.array([not curve.closed for curve in curves]) & drawn]] = False
    wrong |= bulge != 0
    straight = (sizes > 1) & (np.bincount(of[wrong], minlength=len(curves)) == 0)
    return straight.tolist()  # type: ignore[no-any-return]


def _with_lines(curves: Sequence[Curve], tolerance_mm: float) -> Iterator[Floats]:
    """See `flattened_together`; of curves that may have arcs."""
    segments: list[Segment] = []
    count: list[int] = []
    ends: list[Point] = []
    sizes = []
    for curve in curves:
        own, before = curve.segments, len(count)
        if own:
            segments += own[:1] + own
            count += [1, *(s.chords_within(tolerance_mm) for s in own)]
            ends += [own[0].start, *(s.end for s in own)]
        elif len(curve.vertices):
            x, y = curve.vertices[0, :2].tolist()
            segments.append(Segment((x, y), (x, y)))
            count.append(1)
            ends.append((x, y))
        sizes.append(sum(count[before:]))
    points = _with_arcs(segments, np.array(count), np.array(ends)) if count else np.empty((0, 2))
    begin = 0
    for curve, size in zip(curves, sizes, strict=True):
        yield points[begin : begin + size - (curve.closed and size > 1)]
        begin += size


def _with_arcs(segments: Sequence[Segment], count: Ints, ends: Floats) -> Floats:
    """The points of all chords: of every segment as many as are counted, the last its end.

    Where a curve begins, a segment with one chord stands for its first point.
    """
    last = np.cumsum(count) - 1
    points = np.empty((last[-1] + 1, 2))
    arcs = np.flatnonzero(count > 1)
    if len(arcs):
        rows = [(*s.centre, s.radius_mm, s.angle_rad, s.sweep_rad) for s in (segments[k] for k in arcs.tolist())]
        n = count[arcs]
        place = laid_out(np.zeros_like(n), n)
        x, y, r, begin, sweep = np.repeat(np.array(rows), n, axis=0).T
        angle = begin + sweep * (place + 1) / np.repeat(n, n)
        at = np.repeat(last[arcs - 1] + 1, n) + place
        points[at, 0] = x + r * np.cos(angle)
        points[at, 1] = y + r * np.sin(angle)
    points[last] = ends
    return points
