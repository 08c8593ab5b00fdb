"""The curve at a constant distance from a closed curve: the path of the torch's centre beside a contour."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely

from kerfwise.arrays import Floats

from .crossing import Line, LineOrCircle, crossings
from .curve import Curve
from .offset_beside import offsets_beside
from .offset_nearest import NOTHING, Nearest
from .offset_region import offset_ring
from .offset_sources import Sources, arc_bulge
from .segment import Point, Segment

LEAST_MM, LEAST_MM2 = 1e-9, 1e-9
"""What is shorter has no length, what encloses less no area."""
TOLERANCE_MM = 0.004
"""How far a point of the answer may be from the distance asked for before chords are taken instead."""
MANY_POINTS = 10_000
"""Where chords are taken, and they are more, they are made as few as the tolerance allows: each is a line to cut."""


def offset_curve(curve: Curve, distance_mm: float) -> Curve:
    """The closed curve that runs `distance_mm` outside `curve`, inside where negative; same way round.

    Where the offset falls into several curves it is the largest, and pockets that it closes around are left out.

    Lines stay lines and arcs stay concentric arcs. Corners that bend away from the offset side are rounded by an
    arc about the corner (those that turn by a few degrees only stay pointed, within 0.001 mm); the others are
    trimmed to where the neighbouring offsets meet. The result lies within 0.01 mm of the true offset.

    The area that the offset bounds is found first, in fine chords and robustly; each stretch of its boundary is
    then traced back to the line, arc or corner it is offset from, and those are joined exactly.

    Parameters
    ----------
    curve
        Closed; it may touch itself.
    distance_mm
        Outwards (towards a larger area) where positive, mm.

    Raises
    ------
    ValueError
        If the curve is open or has no area, or if nothing is left.

    Examples
    --------
    >>> square = Curve.of([(0, 0), (10, 0), (10, 10), (0, 10)])
    >>> offset_curve(square, -1).as_rows()
    [[1.0, 1.0], [9.0, 1.0], [9.0, 9.0], [1.0, 9.0]]
    >>> round(offset_curve(square, 1).length_mm - 40, 6) == round(2 * math.pi, 6)
    True
    """
    if not curve.closed:
        raise ValueError("only a closed curve has an offset; this one is open")
    if abs(curve.signed_area_mm2) < LEAST_MM2:
        raise ValueError("the curve encloses no area")
    if abs(distance_mm) < LEAST_MM:
        return curve
    offset_together([curve], [distance_mm])
    if (local := curve.beside[distance_mm]) is not None:
        return local
    sources = Sources.of(curve, distance_mm)
    nearest = Nearest.among(sources, curve)
    for patient in (False, True):
        ring = offset_ring(nearest.outline, distance_mm, patient)
        exact = _closed(_joined(sources, _stretches(nearest, ring), ring))
        if exact is not None and _agrees(exact, nearest, ring):
            return exact
    if len(ring) > MANY_POINTS:
        ring = shapely.get_coordinates(shapely.simplify(shapely.LinearRing(ring), TOLERANCE_MM / 2))[:-1]
    return Curve(np.column_stack([ring, np.zeros(len(ring))]))


def offset_together(curves: Sequence[Curve], distances_mm: Sequence[float]) -> None:
    """Look for the offsets of closed curves in one go, each by its distance, so that `offset_curve` finds them made."""
    pairs = [
        (curve, mm)
        for curve, mm in zip(curves, distances_mm, strict=True)
        if mm not in curve.beside and abs(mm) >= LEAST_MM and abs(curve.signed_area_mm2) >= LEAST_MM2
    ]
    found = offsets_beside([curve for curve, _ in pairs], [mm for _, mm in pairs])
    for (curve, mm), beside in zip(pairs, found, strict=True):
        curve.beside[mm] = beside


@dataclass(slots=True)
class _Stretch:
    """A run of the ring that is offset from one source; places count ring vertices."""

    source: int
    first: float = 0.0
    last: float = 0.0


def _stretches(nearest: Nearest, ring: Floats) -> list[_Stretch]:
    """The runs of the ring in order."""
    labels = nearest.label((ring + np.roll(ring, -1, axis=0)) / 2)
    runs: list[_Stretch] = []
    for edge, source in enumerate(labels.tolist()):
        if runs and runs[-1].source == source:
            runs[-1].last = edge + 0.5
        elif source != NOTHING:
            runs.append(_Stretch(source, edge + 0.5, edge + 0.5))
    if len(runs) > 1 and runs[0].source == runs[-1].source:
        runs[0].first = runs.pop().first - len(ring)
    begin = min(range(len(runs)), key=lambda i: runs[i].source, default=0)
    return runs[begin:] + runs[:begin]


def _joined(sources: Sources, runs: list[_Stretch], ring: Floats) -> list[Segment]:
    """The stretches as exact lines and arcs between the points where they meet; empty if they do not.

    Stretches that would run backwards are left out.
    """
    tracks = {run.source: sources.track(run.source) for run in runs}
    while len(runs) > 1:
        meets = [p for a, b in pairwise([*runs, runs[0]]) if (p := _meet(sources, tracks, a, b, ring)) is not None]
        if len(meets) < len(runs):
            break
        kept: list[_Stretch] = []
        pieces: list[Segment] = []
        for run, start, end in zip(runs, meets[-1:] + meets[:-1], meets, strict=True):
            bulge = _bulge(tracks[run.source], start, end, sources.longest_sweep_rad(run.source))
            if bulge is not None:
                kept.append(run)
                pieces.append(Segment(start, end, bulge))
        if len(kept) == len(runs):
            return pieces
        runs = kept
    return []


def _closed(pieces: list[Segment]) -> Curve | None:
    """The pieces as one closed curve, those without length left out; None if fewer than two are left."""
    rows = [(*piece.start, piece.bulge) for piece in pieces if piece.chord_mm > LEAST_MM]
    return Curve.of(rows) if len(rows) > 1 else None


def _meet(sources: Sources, tracks: dict[int, LineOrCircle], a: _Stretch, b: _Stretch, ring: Floats) -> Point | None:
    """Where stretch b follows on stretch a."""
    step = (b.source - a.source) % (2 * len(sources))
    k = a.source // 2
    if step == 1:
        return sources.offset_start((k + 1) % len(sources)) if a.source % 2 else sources.offset_end(k)
    mitre = sources.mitre(k) if step == 2 and a.source % 2 == 0 else None
    if mitre is not None and sources.is_smooth(k):
        return mitre
    near = _ring_point(ring, a.last, b.first, mitre)
    found = crossings(tracks[a.source], tracks[b.source])
    best = min(found, key=lambda p: math.dist(p, near), default=None)
    if best is not None and math.dist(best, near) < abs(sources.right_mm) / 4:
        return best
    return near


def _ring_point(ring: Floats, after: float, before: float, mitre: Point | None) -> Point:
    """The ring vertex half-way between two places; where no vertex lies between, the mitre, else the nearest vertex."""
    if before < after:
        before += len(ring)
    low, high, middle = math.ceil(after), math.floor(before), (after + before) / 2
    if low > high and mitre is not None:
        return mitre
    vertex = round(middle) if low > high else min(max(round(middle), low), high)
    x, y = ring[vertex % len(ring)].tolist()
    return x, y


def _bulge(track: LineOrCircle, start: Point, end: Point, longest_rad: float) -> float | None:
    """Bulge of the piece of a track from `start` to `end`; None if it would run backwards."""
    if isinstance(track, Line):
        ahead = (end[0] - start[0]) * track.direction[0] + (end[1] - start[1]) * track.direction[1]
        return 0.0 if ahead > -1e-9 else None
    cx, cy = track.centre
    bulge = arc_bulge(track.turn, (start[0] - cx, start[1] - cy), (end[0] - cx, end[1] - cy), longest_rad)
    return None if math.isnan(bulge) else bulge


def _agrees(curve: Curve, nearest: Nearest, ring: Floats) -> bool:
    """Whether every point of the curve is as far from the source as it should be, and it encloses the ring's area."""
    points = np.array([s.point_at(fraction) for s in curve.segments for fraction in (0.0, 0.25, 0.5, 0.75)])
    error = np.abs(nearest.distances_mm(points) - abs(nearest.sources.right_mm))
    x, y = (ring - ring[0]).T
    area_mm2 = (np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2
    return bool(error.max() < TOLERANCE_MM and abs(curve.signed_area_mm2 - area_mm2) < TOLERANCE_MM * curve.length_mm)
