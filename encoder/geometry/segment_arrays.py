"""All segments of a curve as arrays, for questions about many points of it at once."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
import shapely

from kerfwise.arrays import Floats, Ints

from .curve import Curve

COMPARED_AT_ONCE = 1 << 20
"""Pairs of a point and a segment that are compared each; where there are more, far segments are left out first."""
_POINTS_AT_ONCE = 64
_CHORD_MM = 0.01


@dataclass(frozen=True, eq=False)
class SegmentArrays:
    """The n segments of a curve that has some. Arrays (n, 2) unless said otherwise.

    `tangent_in` and `tangent_out` are the unit tangents at a segment's start and end; `bulge` (n,); `centre` and
    `radius_mm` (n,) those of arcs, meaningless for lines; `starts_mm` (n + 1,) path lengths as in `Curve`.
    """

    start: Floats
    end: Floats
    bulge: Floats
    tangent_in: Floats
    tangent_out: Floats
    centre: Floats
    radius_mm: Floats
    starts_mm: Floats
    curve: Curve

    @staticmethod
    def of(curve: Curve) -> SegmentArrays:
        """The segments of `curve`."""
        start = np.array([s.start for s in curve.segments])
        end = np.array([s.end for s in curve.segments])
        bulge = np.array([s.bulge for s in curve.segments])
        chord = end - start
        length = np.hypot(chord[:, 0], chord[:, 1])[:, None]
        # The tangent at an end of an arc is its chord turned by half the sweep, 2 atan(bulge).
        along, across = chord / length, _left(chord) / length
        cos, sin = ((1 - bulge**2) / (1 + bulge**2))[:, None], (2 * bulge / (1 + bulge**2))[:, None]
        b = np.where(bulge != 0, bulge, 1.0)
        centre = (start + end) / 2 + across * length * ((1 - b * b) / (4 * b))[:, None]
        radius_mm = length[:, 0] * (1 + b * b) / (4 * np.abs(b))
        tangent_in, tangent_out = along * cos - across * sin, along * cos + across * sin
        return SegmentArrays(start, end, bulge, tangent_in, tangent_out, centre, radius_mm, curve.starts_mm, curve)

    def __len__(self) -> int:
        return len(self.start)

    @cached_property
    def turn_rad(self) -> Floats:
        """Array (n,): the angle that a closed curve turns through at the end of each segment, positive to the left."""
        after = np.roll(self.tangent_in, -1, axis=0)
        return np.asarray(np.arctan2(_cross(self.tangent_out, after), (self.tangent_out * after).sum(axis=1)))

    def frames(self, at_mm: Floats) -> tuple[Floats, Floats, Floats]:
        """Points of a closed curve at path lengths (m,), and the unit tangents before and after them; arrays (m, 2).

        The tangents differ at corners only.

        Examples
        --------
        >>> square = SegmentArrays.of(Curve.of([(0, 0), (10, 0), (10, 10), (0, 10)]))
        >>> [a.tolist() for a in square.frames(np.array([10.0]))]
        [[[10.0, 0.0]], [[1.0, 0.0]], [[0.0, 1.0]]]
        """
        at_mm = at_mm % self.starts_mm[-1]
        k = np.clip(np.searchsorted(self.starts_mm, at_mm + 1e-9, side="right") - 1, 0, len(self) - 1)
        fraction = (at_mm - self.starts_mm[k]) / (self.starts_mm[k + 1] - self.starts_mm[k])
        f, bulge = np.clip(fraction, 0, 1)[:, None], self.bulge[k]
        points = self.start[k] + f * (self.end[k] - self.start[k])
        tangents = self.tangent_in[k]
        angle = (4 * np.arctan(bulge))[:, None] * f
        cos, sin = np.cos(angle), np.sin(angle)
        spoke = self.start[k] - self.centre[k]
        arc = bulge != 0
        points[arc] = (self.centre[k] + spoke * cos + _left(spoke) * sin)[arc]
        tangents[arc] = (tangents * cos + _left(tangents) * sin)[arc]
        at_start = at_mm - self.starts_mm[k] < 1e-9
        return points, np.where(at_start[:, None], self.tangent_out[k - 1], tangents), tangents

    def project(self, points: Floats) -> tuple[Floats, Floats]:
        """Path lengths of the nearest points of the curve to `points` (m, 2), and the distances to them, mm.

        Examples
        --------
        >>> circle = SegmentArrays.of(Curve.of([(-10, 0, 1), (10, 0, 1)]))
        >>> [a.round(3).tolist() for a in circle.project(np.array([[0.0, -12.0]]))]
        [[15.708], [2.0]]
        """
        if len(points) * len(self) <= COMPARED_AT_ONCE:
            return self._project(points, np.arange(len(self)))
        chords, of = self._chords
        found = shapely.points(points)
        _, far_mm = chords.query_nearest(found, return_distance=True, all_matches=False)
        row, chord = chords.query(found, predicate="dwithin", distance=far_mm + 2 * _CHORD_MM)
        ends = np.searchsorted(row, np.arange(0, len(points) + _POINTS_AT_ONCE, _POINTS_AT_ONCE))
        parts = [
            self._project(points[k * _POINTS_AT_ONCE :][:_POINTS_AT_ONCE], np.unique(of[chord[begin:end]]))
            for k, (begin, end) in enumerate(pairwise(ends.tolist()))
        ]
        return np.concatenate([at for at, _ in parts]), np.concatenate([mm for _, mm in parts])

    @cached_property
    def _chords(self) -> tuple[shapely.STRtree, Ints]:
        """The curve in chords, and the segment of each."""
        chords = [s.flatten(_CHORD_MM) for s in self.curve.segments]
        of = np.repeat(np.arange(len(chords)), [len(c) for c in chords])
        to = np.concatenate(chords)
        begins = np.concatenate([self.start[:1], to[:-1]])
        return shapely.STRtree(shapely.linestrings(np.stack([begins, to], axis=1))), of

    def _project(self, points: Floats, among: Ints) -> tuple[Floats, Floats]:
        """The same, where the segments that may be nearest are known: every point is compared with each of them."""
        start, end, centre, bulge = self.start[among], self.end[among], self.centre[among], self.bulge[among]
        along = end - start
        rel = points[:, None] - start
        fraction = np.clip((rel * along).sum(axis=2) / (along * along).sum(axis=1), 0, 1)
        arcs = np.flatnonzero(bulge)
        if len(arcs):
            spoke, ray = start[arcs] - centre[arcs], points[:, None] - centre[arcs]
            turn_rad = np.arctan2(_cross(spoke, ray), (spoke * ray).sum(axis=2))
            sweep_rad = 4 * np.arctan(bulge[arcs])
            on_arc = (np.sign(sweep_rad) * turn_rad) % (2 * np.pi) / np.abs(sweep_rad)
            to_end = ray - (end - centre)[arcs]
            nearer_start = ((ray - spoke) ** 2).sum(axis=2) <= (to_end**2).sum(axis=2)
            fraction[:, arcs] = np.where(on_arc <= 1, on_arc, np.where(nearer_start, 0.0, 1.0))
        feet = start + fraction[:, :, None] * along
        if len(arcs):
            angle = (sweep_rad * fraction[:, arcs])[:, :, None]
            feet[:, arcs] = centre[arcs] + spoke * np.cos(angle) + _left(spoke) * np.sin(angle)
        squares = ((feet - points[:, None]) ** 2).sum(axis=2)
        nearest = squares.argmin(axis=1)
        rows, k = np.arange(len(points)), among[nearest]
        length_mm = self.starts_mm[k + 1] - self.starts_mm[k]
        return self.starts_mm[k] + fraction[rows, nearest] * length_mm, np.sqrt(squares[rows, nearest])


def _left(v: Floats) -> Floats:
    """Vectors turned a quarter to the left."""
    return np.stack([-v[..., 1], v[..., 0]], axis=-1)


def _cross(a: Floats, b: Floats) -> Floats:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
