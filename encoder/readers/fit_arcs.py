"""Arcs fitted through dense rows of points: flattened splines and outlines become a few arcs again."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from kerfwise.arrays import Floats
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Segment
from kerfwise.encoder.nest import Contour, Nest, Note, Part

from .drawing import checked_curve

FLATTEN_MM = 0.003
"""Chord error when a spline, an ellipse or a Bézier curve is turned into points."""

FIT_MM = 0.007
"""How far a fitted line or arc may lie off those points; with `FLATTEN_MM`, within 0.01 mm of the drawing."""


def fit_curve(points: Floats) -> Curve | None:
    """Lines and arcs through dense points in mm, closed where they end as they began; None for fewer than two."""
    if len(points) < 2:
        return None
    closed = bool(np.hypot(*(points[0] - points[-1])) < 1e-6)
    dense = checked_curve(np.column_stack([points, np.zeros(len(points))]), closed=False).vertices[:, :2]
    rows = fit_arcs(dense)
    return checked_curve(rows[:-1] if closed and len(rows) > 2 else rows, closed and len(rows) > 2)


def fit_arcs(points: Floats, tolerance_mm: float = FIT_MM) -> Floats:
    """The vertices of an open curve of lines and arcs that stays within `tolerance_mm` of a polyline.

    Parameters
    ----------
    points
        Array (n, 2), mm, neighbours distinct. The fitted curve's vertices are some of them, the first and the
        last included, so that curves which met still meet.
    tolerance_mm
        Largest distance between the fitted curve and the polyline's vertices and edge middles.

    Returns
    -------
    Array (m, 3) of x, y and bulge, the last bulge 0.

    Examples
    --------
    >>> a = np.linspace(0, math.pi / 2, 100)
    >>> fit_arcs(np.column_stack([10 * np.cos(a), 10 * np.sin(a)])).round(3).tolist()
    [[10.0, 0.0, 0.414], [0.0, 10.0, 0.0]]
    """
    rows, first = [], 0
    while first < len(points) - 1:
        last, bulge = _longest(points, first, tolerance_mm)
        rows.append((*points[first].tolist(), bulge))
        first = last
    rows.append((*points[-1].tolist(), 0.0))
    return np.array(rows)


def _longest(points: Floats, first: int, tolerance_mm: float) -> tuple[int, float]:
    """The last point, and the bulge, of the longest line or arc from `first`: doubled, then halved back."""
    good, bulge, reach = first + 1, 0.0, 2
    while first + reach < len(points):
        fitted = _bulge(points[first : first + reach + 1], tolerance_mm)
        if fitted is None:
            break
        good, bulge = first + reach, fitted
        reach *= 2
    bad = min(first + reach, len(points))
    while bad - good > 1:
        last = (good + bad) // 2
        fitted = _bulge(points[first : last + 1], tolerance_mm)
        if fitted is None:
            bad = last
        else:
            good, bulge = last, fitted
    return good, bulge


def _bulge(points: Floats, tolerance_mm: float) -> float | None:
    """The bulge of the one line or arc that fits all the points, or None."""
    start, end, middle = points[0], points[-1], points[len(points) // 2]
    chord = end - start
    length = math.hypot(*chord.tolist())
    if length < 1e-9:
        return None
    along = chord / length
    across = np.array([-along[1], along[0]])
    tested = np.concatenate([points, (points[1:] + points[:-1]) / 2]) - start
    s, h = tested @ along, tested @ across
    if s.min() < -tolerance_mm or s.max() > length + tolerance_mm:
        return None
    to_ends = np.hypot(np.minimum(np.abs(s), np.abs(s - length)), h)
    if np.abs(h).max() <= tolerance_mm / 2 and to_ends[(s < 0) | (s > length)].max(initial=0.0) <= tolerance_mm:
        return 0.0
    ms, mh = float((middle - start) @ along), float((middle - start) @ across)
    if abs(mh) <= tolerance_mm / 2:
        return None
    # The circle through both ends and the middle point: its centre is (length / 2, k) in chord coordinates.
    k = (ms * (ms - length) + mh * mh) / (2 * mh)
    radius = math.hypot(length / 2, k)
    if k * mh > 0:
        return None  # more than half round: the bend of a cusp, finer than the tolerance
    u, v, side = s - length / 2, h - k, math.copysign(1.0, mh)
    beyond = (side * (k * u - length / 2 * v) > 0) | (side * (k * u + length / 2 * v) < 0)  # past an end of the arc
    off = np.where(beyond, to_ends, np.abs(np.hypot(u, v) - radius))
    if off.max() > tolerance_mm or (h * mh < -tolerance_mm * abs(mh)).any():
        return None
    sagitta = k + math.copysign(radius, mh)
    return -2 * sagitta / length


# Arcs again where an outline was flattened into short lines: fewer blocks, and a machine that does not brake at each.
#
# Corners, lines and what is no arc stay as they are drawn. How far the arcs lie off the lines is measured on every
# one.

CORNER_DEG = 31.0
"""Where lines turn by more, they meet at a corner: a circle of twelve lines has none."""
LEAST_LINES = 3
"""So many lines make an arc at the least."""
_UNEVEN = 3.0
"""Lines of one arc are no longer than so many times the middle one of them: longer ones are straight sides."""


@dataclass(frozen=True, slots=True)
class Refit:
    """A curve with its arcs: how many, in the place of how many lines, and how far they lie off those at most, mm."""

    curve: Curve
    arcs: int = 0
    lines: int = 0
    off_mm: float = 0.0


def refitted(curve: Curve, tolerance_mm: float) -> Refit:
    """The curve with arcs where lines follow one within the tolerance; all its other vertices stay.

    Examples
    --------
    >>> turn = np.linspace(0, 2 * math.pi, 73)[:-1]
    >>> ring = Curve.of(np.column_stack([10 * np.cos(turn), 10 * np.sin(turn)]).tolist())
    >>> made = refitted(ring, 0.05)
    >>> made.arcs, made.lines, round(made.off_mm, 4), round(made.curve.length_mm, 2)
    (2, 72, 0.0095, 62.83)
    """
    rows = curve.vertices
    if len(rows) <= LEAST_LINES:
        return Refit(curve)
    if curve.closed:
        rows = np.roll(rows, -_first(rows), axis=0)
        rows = np.concatenate([rows, rows[:1]])
    ends = _breaks(rows)
    pieces: list[Floats] = []
    arcs = lines = 0
    off_mm = 0.0
    for first, last in pairwise(ends):
        piece, counted, replaced, off = _piece(rows[first : last + 1], tolerance_mm)
        pieces.append(piece[:-1])
        arcs, lines, off_mm = arcs + counted, lines + replaced, max(off_mm, off)
    if not arcs:
        return Refit(curve)
    whole = np.concatenate([*pieces, rows[-1:]])
    return Refit(Curve(whole[:-1] if curve.closed else whole, curve.closed), arcs, lines, off_mm)


def with_arcs(nest: Nest, tolerance_mm: float) -> Nest:
    """The nest with arcs in its contours, and a note that says how many and how near they are."""
    found: list[Refit] = []

    def of_contour(contour: Contour) -> Contour:
        refit = refitted(contour.curve, tolerance_mm)
        if not refit.arcs:
            return contour
        found.append(refit)
        return replace(contour, curve=refit.curve)

    parts = tuple(_with_each(part, of_contour) for part in nest.parts)
    return replace(nest, parts=parts, notes=(*nest.notes, _note(found, tolerance_mm)))


def _with_each(part: Part, change: Callable[[Contour], Contour]) -> Part:
    holes, marks = tuple(map(change, part.holes)), tuple(map(change, part.marks))
    return replace(part, outer=change(part.outer), holes=holes, marks=marks)


def _note(found: list[Refit], tolerance_mm: float) -> Note:
    allowed = f"{tolerance_mm:g} mm allowed"
    if not found:
        return Note("repaired", f"no flattened arcs were found to refit ({allowed})")
    arcs, lines = sum(one.arcs for one in found), sum(one.lines for one in found)
    off_mm = max(one.off_mm for one in found)
    contours = f"{len(found)} contour{'' if len(found) == 1 else 's'}"
    text = f"{lines} lines became {arcs} arcs in {contours}, at most {off_mm:.4f} mm off ({allowed})"
    return Note("repaired", text)


def _first(rows: Floats) -> int:
    """Where a closed curve is begun: where it turns most, or else where a line is longest beside the one before."""
    turns = _turns_deg(np.concatenate([rows[-1:], rows, rows[:1]]))
    bent = rows[:, 2] != 0
    if bent.any():
        return int(np.flatnonzero(bent)[0])
    if turns.max() > CORNER_DEG:
        return int(np.argmax(turns))
    lengths = np.hypot(*np.diff(np.concatenate([rows, rows[:1]])[:, :2], axis=0).T)
    return int(np.argmax(lengths / np.maximum(np.roll(lengths, 1), 1e-9)))


def _turns_deg(rows: Floats) -> Floats:
    """By how much lines turn at every vertex but the first and the last."""
    ways = np.diff(rows[:, :2], axis=0)
    angles = np.degrees(np.arctan2(ways[:, 1], ways[:, 0]))
    return np.asarray(np.abs((np.diff(angles) + 180) % 360 - 180))


def _breaks(rows: Floats) -> list[int]:
    """Both ends, every corner, both ends of every arc that is drawn as one, and of every side between short lines."""
    bent = np.flatnonzero(rows[:-1, 2] != 0)
    corners = np.flatnonzero(_turns_deg(rows) > CORNER_DEG) + 1
    lengths = np.hypot(*np.diff(rows[:, :2], axis=0).T)
    before, after = np.append(0.0, lengths[:-1]), np.append(lengths[1:], 0.0)
    before[corners[corners < len(lengths)]] = after[corners - 1] = 0.0  # what lies round a corner is another side
    sides = np.flatnonzero(lengths > _UNEVEN * np.maximum(before, after))
    alone = np.concatenate([bent, sides])
    return sorted({0, len(rows) - 1, *corners.tolist(), *alone.tolist(), *(alone + 1).tolist()})


def _piece(rows: Floats, tolerance_mm: float) -> tuple[Floats, int, int, float]:
    """Lines between two breaks, with arcs where there are some; how many arcs, for how many lines, and how far off."""
    if len(rows) <= LEAST_LINES or rows[0, 2] != 0 or _doubled(rows):
        return rows, 0, 0, 0.0
    fit = fit_arcs(rows[:, :2], tolerance_mm)
    at, count = 0, []
    arcs = lines = 0
    most_mm = 0.0
    for (x, y, bulge), nearest in zip(fit[:-1].tolist(), fit[1:, :2].tolist(), strict=True):
        to = at + 1 + int(np.flatnonzero((rows[at + 1 :, :2] == nearest).all(axis=1))[0])
        piece = rows[at : to + 1]
        off_mm = _off_mm(piece, bulge) if bulge and to - at >= LEAST_LINES and _even(piece) else math.inf
        if off_mm <= tolerance_mm:
            count.append(np.array([[x, y, bulge]]))
            arcs, lines, most_mm = arcs + 1, lines + to - at, max(most_mm, off_mm)
        else:
            count.append(piece[:-1])
        at = to
    return np.concatenate([*count, rows[-1:]]), arcs, lines, most_mm


def _doubled(rows: Floats) -> bool:
    """Whether a point comes twice: vertices could not be told apart by where they are."""
    return len(np.unique(rows[:, :2], axis=0)) < len(rows) - bool((rows[0, :2] == rows[-1, :2]).all())


def _even(rows: Floats) -> bool:
    lengths = np.hypot(*np.diff(rows[:, :2], axis=0).T)
    return bool(lengths.max() <= _UNEVEN * np.median(lengths))


def _off_mm(rows: Floats, bulge: float) -> float:
    """How far lines lie off the arc between their ends: at a vertex, or where a line comes nearest to the centre.

    Infinite where they do not go round the centre all in the arc's way: then a point of the arc has no line beside it.
    """
    points = rows[:, :2]
    arc = Segment((points[0, 0], points[0, 1]), (points[-1, 0], points[-1, 1]), bulge)
    from_centre = points - np.array(arc.centre)
    a, b = from_centre[:-1], from_centre[1:]
    turning = np.sign(bulge) * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    if (turning <= 0).any():
        return math.inf
    ways = b - a
    share = np.clip(-(a * ways).sum(axis=1) / (ways * ways).sum(axis=1), 0.0, 1.0)
    feet = a + share[:, None] * ways
    distances = np.hypot(*np.concatenate([from_centre, feet]).T)
    return float(np.abs(distances - arc.radius_mm).max())
