"""The curve at a constant distance from a closed curve: the path of the torch's centre beside a contour."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray

from kerfwise.arrays import Floats

from .curve import Curve
from .measures import Line, LineOrCircle, crossings
from .offset_batch import CHORD_MM, Sources, arc_bulge, offset_curves, offset_ring
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

    The area that the offset bounds is found first, in fine chords and robustly; each stretch of its boundary is then
    traced back to the line, arc or corner it is offset from, and those are joined exactly. `curve`: closed; it may
    touch itself. `distance_mm`: outwards (towards a larger area) where positive, mm. Raises ValueError if the curve is
    open or has no area, or if nothing is left.

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
    found = offset_curves([curve for curve, _ in pairs], [mm for _, mm in pairs])
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


# Which source each point of an offset curve belongs to.

NOTHING = -1


@dataclass(frozen=True, eq=False, slots=True)
class Nearest:
    """Finds the source that points are offset from."""

    sources: Sources
    outline: Floats
    """The drawn curve in chords, array (chords, 2): where each begins."""
    tree: shapely.STRtree
    """Of the chords."""
    segment: NDArray[np.int64]
    """The segment of each chord, and whether it is the first or the last one of it."""
    first: NDArray[np.bool_]
    last: NDArray[np.bool_]
    rounded: NDArray[np.bool_]

    @staticmethod
    def among(sources: Sources, curve: Curve) -> Nearest:
        """An index over the segments of `curve`, whose sources are given."""
        chords = [s.flatten(CHORD_MM) if s.is_arc else np.array([s.end]) for s in curve.segments]
        outline = np.concatenate([sources.drawn.start[:1], *chords])[:-1]
        segment = np.repeat(np.arange(len(chords)), [len(c) for c in chords])
        first = np.diff(segment, prepend=-1) > 0
        chord = np.stack([outline, np.roll(outline, -1, axis=0)], axis=1)
        tree = shapely.STRtree(shapely.linestrings(chord))
        return Nearest(sources, outline, tree, segment, first, np.roll(first, -1), sources.rounded)

    def distances_mm(self, points: Floats) -> Floats:
        """Distance of each point from the drawn curve, mm."""
        found = shapely.points(points)
        return np.asarray(shapely.distance(found, self.tree.geometries[self.tree.nearest(found)]))

    def label(self, points: Floats) -> NDArray[np.int64]:
        """The number of the source of each point; NOTHING at corners that the offset does not go around."""
        found = shapely.points(points)
        at, side, fraction = self._foot(points, self.tree.nearest(found))
        wrong = np.flatnonzero(side * self.sources.right_mm < 0)
        if len(wrong):
            # Both sides of a slit lie on the same spot: take the side that faces the point.
            row, near = self.tree.query_nearest(found[wrong])
            _, near_side, _ = self._foot(points[wrong[row]], near)
            facing = near_side * self.sources.right_mm > 0
            at[wrong[row[facing]]] = near[facing]
            at, side, fraction = self._foot(points, at)
        n = len(self.sources)
        k = self.segment[at]
        before, after = self.first[at] & (fraction <= 1e-9), self.last[at] & (fraction >= 1 - 1e-9)
        corner = np.where(before, (k - 1) % n, k)
        labels = np.where(before | after, 2 * corner + 1, 2 * k)
        gone = ((before | after) & ~self.rounded[corner]) | (
            ~(before | after) & (self.sources.drawn.bulge[k] != 0) & (self.sources.radius_mm[k] < 1e-6)
        )
        labels[gone] = NOTHING
        return labels

    def _foot(self, points: Floats, at: NDArray[np.int64]) -> tuple[NDArray[np.int64], Floats, Floats]:
        """Chord numbers, positive where the point lies right of its chord, and the fraction along it (unclamped)."""
        start = self.outline[at]
        along = self.outline[(at + 1) % len(self.outline)] - start
        rel = points - start
        fraction = (rel * along).sum(axis=1) / (along * along).sum(axis=1)
        return np.array(at), along[:, 1] * rel[:, 0] - along[:, 0] * rel[:, 1], fraction
