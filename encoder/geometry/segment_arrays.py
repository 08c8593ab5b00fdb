"""All segments of curves as arrays, for questions about many points of them at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
import shapely

from kerfwise.arrays import Floats, Ints, concat_ranges, unique

from .curve import Curve

COMPARED_AT_ONCE = 1 << 20
"""Pairs of a point and a segment that are compared each; where there are more, far segments are left out first."""
_TOGETHER = 1 << 17
"""Pairs of points and segments of several curves that are compared in one go."""
_POINTS_AT_ONCE = 64
_CHORD_MM = 0.01


@dataclass(frozen=True, eq=False)
class SegmentArrays:
    """The n segments of curves that have some, curve after curve. Arrays (n, 2) unless said otherwise.

    `tangent_in` and `tangent_out` are the unit tangents at a segment's start and end; `bulge` (n,); `centre` and
    `radius_mm` (n,) those of arcs, meaningless for lines. Those of curve k are `first[k]` … `first[k + 1] - 1`.
    `starts_mm` (n + curves,) are path lengths as in `Curve`, one more for each curve than it has segments.
    """

    start: Floats
    end: Floats
    bulge: Floats
    tangent_in: Floats
    tangent_out: Floats
    centre: Floats
    radius_mm: Floats
    starts_mm: Floats
    first: Ints
    curves: tuple[Curve, ...]

    @staticmethod
    def of(*curves: Curve) -> SegmentArrays:
        """The segments of some curves."""
        segments = [s for curve in curves for s in curve.segments]
        start = np.array([s.start for s in segments]).reshape(-1, 2)
        end = np.array([s.end for s in segments]).reshape(-1, 2)
        bulge = np.array([s.bulge for s in segments], dtype=np.float64)
        chord = end - start
        length = np.hypot(chord[:, 0], chord[:, 1])[:, None]
        # The tangent at an end of an arc is its chord turned by half the sweep, 2 atan(bulge).
        along, across = chord / length, _left(chord) / length
        cos, sin = ((1 - bulge**2) / (1 + bulge**2))[:, None], (2 * bulge / (1 + bulge**2))[:, None]
        b = np.where(bulge != 0, bulge, 1.0)
        centre = (start + end) / 2 + across * length * ((1 - b * b) / (4 * b))[:, None]
        radius_mm = length[:, 0] * (1 + b * b) / (4 * np.abs(b))
        tangent_in, tangent_out = along * cos - across * sin, along * cos + across * sin
        starts_mm = np.concatenate([np.zeros(0), *(curve.starts_mm for curve in curves)])
        first = np.cumsum([0, *(len(curve.segments) for curve in curves)])
        return SegmentArrays(start, end, bulge, tangent_in, tangent_out, centre, radius_mm, starts_mm, first, curves)

    @staticmethod
    def joined(several: Sequence[SegmentArrays]) -> SegmentArrays:
        """Those of all curves of several, in order."""
        if len(several) == 1:
            return several[0]
        counts = [np.zeros(1, np.int64), *(np.diff(a.first) for a in several)]
        return SegmentArrays(
            np.concatenate([a.start for a in several]),
            np.concatenate([a.end for a in several]),
            np.concatenate([a.bulge for a in several]),
            np.concatenate([a.tangent_in for a in several]),
            np.concatenate([a.tangent_out for a in several]),
            np.concatenate([a.centre for a in several]),
            np.concatenate([a.radius_mm for a in several]),
            np.concatenate([a.starts_mm for a in several]),
            np.cumsum(np.concatenate(counts)),
            tuple(curve for a in several for curve in a.curves),
        )

    def each(self) -> list[SegmentArrays]:
        """Those of each curve by itself."""
        found = []
        for k, (curve, (a, b)) in enumerate(zip(self.curves, pairwise(self.first.tolist()), strict=True)):
            rows, starts = slice(a, b), slice(a + k, b + k + 1)
            found.append(
                SegmentArrays(
                    self.start[rows],
                    self.end[rows],
                    self.bulge[rows],
                    self.tangent_in[rows],
                    self.tangent_out[rows],
                    self.centre[rows],
                    self.radius_mm[rows],
                    self.starts_mm[starts],
                    np.array([0, b - a]),
                    (curve,),
                )
            )
        return found

    def __len__(self) -> int:
        return len(self.start)

    @cached_property
    def lengths_mm(self) -> Floats:
        """Array (curves,): the whole length of each."""
        return np.asarray(self.starts_mm[self.first[1:] + np.arange(len(self.curves))])

    @cached_property
    def following(self) -> Ints:
        """Array (n,): the number of the segment after each of a closed curve; the first follows the last."""
        following = np.arange(1, len(self) + 1)
        following[self.first[1:] - 1] = self.first[:-1]
        return following

    @cached_property
    def turn_rad(self) -> Floats:
        """Array (n,): the angle that a closed curve turns through at the end of each segment, positive to the left."""
        after = self.tangent_in[self.following]
        return np.asarray(np.arctan2(_cross(self.tangent_out, after), (self.tangent_out * after).sum(axis=1)))

    def frames(self, at_mm: Floats, of: Ints | None = None) -> tuple[Floats, Floats, Floats]:
        """Points of closed curves at path lengths (m,), and the unit tangents before and after them; arrays (m, 2).

        The tangents differ at corners only. `of` (m,) numbers the curve of each point, where there are several.

        Examples
        --------
        >>> square = SegmentArrays.of(Curve.of([(0, 0), (10, 0), (10, 10), (0, 10)]))
        >>> [a.tolist() for a in square.frames(np.array([10.0]))]
        [[[10.0, 0.0]], [[1.0, 0.0]], [[0.0, 1.0]]]
        """
        of = np.zeros(len(at_mm), np.int64) if of is None else of
        at_mm = at_mm % self.lengths_mm[of]
        k = self._reached(at_mm + 1e-9, of)
        start_mm = self.starts_mm[k + of]
        fraction = (at_mm - start_mm) / (self.starts_mm[k + of + 1] - start_mm)
        f, bulge = np.clip(fraction, 0, 1)[:, None], self.bulge[k]
        points = self.start[k] + f * (self.end[k] - self.start[k])
        tangents = self.tangent_in[k]
        arc = np.flatnonzero(bulge)
        angle = (4 * np.arctan(bulge[arc]))[:, None] * f[arc]
        cos, sin = np.cos(angle), np.sin(angle)
        spoke, along = self.start[k[arc]] - self.centre[k[arc]], tangents[arc]
        points[arc] = self.centre[k[arc]] + spoke * cos + _left(spoke) * sin
        tangents[arc] = along * cos + _left(along) * sin
        at_start = at_mm - start_mm < 1e-9
        before = self.tangent_out[np.where(k > self.first[of], k, self.first[of + 1]) - 1]
        return points, np.where(at_start[:, None], before, tangents), tangents

    def _reached(self, at_mm: Floats, of: Ints) -> Ints:
        """The segments of curves on which path lengths lie: the last that begins there or before."""
        low, high = self.first[of], self.first[of + 1] - 1
        while (open_ := low < high).any():
            middle = (low + high + 1) // 2
            begun = self.starts_mm[middle + of] <= at_mm
            low, high = np.where(open_ & begun, middle, low), np.where(open_ & ~begun, middle - 1, high)
        return low

    def project(self, points: Floats, of: Ints | None = None) -> tuple[Floats, Floats]:
        """Path lengths of the nearest points of curves to `points` (m, 2), and the distances to them, mm.

        `of` (m,), ascending, numbers the curve for each point, where there are several.

        Examples
        --------
        >>> circle = SegmentArrays.of(Curve.of([(-10, 0, 1), (10, 0, 1)]))
        >>> [a.round(3).tolist() for a in circle.project(np.array([[0.0, -12.0]]))]
        [[15.708], [2.0]]
        """
        if of is None or len(self.curves) == 1:
            return self._project_on_one(points)
        n = np.diff(self.first)
        pairs = np.bincount(of, minlength=len(n)) * n
        at_mm, far_mm = np.zeros(len(points)), np.zeros(len(points))
        alone = pairs > COMPARED_AT_ONCE
        every = self.each() if alone.any() else []
        for k in np.flatnonzero(alone).tolist():
            rows = of == k
            at_mm[rows], far_mm[rows] = every[k].project(points[rows])
        rows = np.flatnonzero(~alone[of])
        piece = np.cumsum(n[of[rows]]) // _TOGETHER
        for some in np.split(rows, np.flatnonzero(np.diff(piece)) + 1):
            at_mm[some], far_mm[some] = self._nearest(
                points[some], concat_ranges(self.first[of[some]], n[of[some]]), n[of[some]], of[some]
            )
        return at_mm, far_mm

    def _project_on_one(self, points: Floats) -> tuple[Floats, Floats]:
        if len(points) * len(self) <= COMPARED_AT_ONCE:
            return self._project(points, np.arange(len(self)))
        chords, of = self._chords
        found = shapely.points(points)
        _, far_mm = chords.query_nearest(found, return_distance=True, all_matches=False)
        row, chord = chords.query(found, predicate="dwithin", distance=far_mm + 2 * _CHORD_MM)
        ends = np.searchsorted(row, np.arange(0, len(points) + _POINTS_AT_ONCE, _POINTS_AT_ONCE))
        parts = [
            self._project(points[k * _POINTS_AT_ONCE :][:_POINTS_AT_ONCE], unique(of[chord[begin:end]]))
            for k, (begin, end) in enumerate(pairwise(ends.tolist()))
        ]
        return np.concatenate([at for at, _ in parts]), np.concatenate([mm for _, mm in parts])

    @cached_property
    def _chords(self) -> tuple[shapely.STRtree, Ints]:
        """The curve, where there is one, in chords, and the segment of each."""
        chords = [s.flatten(_CHORD_MM) for s in self.curves[0].segments]
        of = np.repeat(np.arange(len(chords)), [len(c) for c in chords])
        to = np.concatenate(chords)
        begins = np.concatenate([self.start[:1], to[:-1]])
        return shapely.STRtree(shapely.linestrings(np.stack([begins, to], axis=1))), of

    def _project(self, points: Floats, among: Ints) -> tuple[Floats, Floats]:
        """The same of one curve, where the segments that may be nearest are known: points are compared with each."""
        none = np.zeros(len(points), np.int64)
        return self._nearest(points, np.tile(among, len(points)), none + len(among), none)

    def _nearest(self, points: Floats, k: Ints, count: Ints, of: Ints) -> tuple[Floats, Floats]:
        """Each point, of one curve, compared with some of its segments: `count` of the numbers `k`, point after point.

        Of segments that are equally near the first counts.
        """
        row = np.repeat(np.arange(len(points)), count)
        at, start, bulge = points.take(row, axis=0), self.start.take(k, axis=0), self.bulge.take(k)
        along = self.end.take(k, axis=0) - start
        rel = at - start
        fraction = np.clip(_dot(rel, along) / _dot(along, along), 0, 1)
        arcs = np.flatnonzero(bulge)
        if len(arcs):
            centre = self.centre.take(k.take(arcs), axis=0)
            spoke, ray = start.take(arcs, axis=0) - centre, at.take(arcs, axis=0) - centre
            turn_rad = np.arctan2(_cross(spoke, ray), _dot(spoke, ray))
            sweep_rad = 4 * np.arctan(bulge[arcs])
            on_arc = (np.sign(sweep_rad) * turn_rad) % (2 * np.pi) / np.abs(sweep_rad)
            to_end = ray - (self.end.take(k.take(arcs), axis=0) - centre)
            to_start = ray - spoke
            nearer_start = _dot(to_start, to_start) <= _dot(to_end, to_end)
            fraction[arcs] = np.where(on_arc <= 1, on_arc, np.where(nearer_start, 0.0, 1.0))
        feet = start + fraction[:, None] * along
        if len(arcs):
            angle = (sweep_rad * fraction[arcs])[:, None]
            feet[arcs] = centre + spoke * np.cos(angle) + _left(spoke) * np.sin(angle)
        gap = feet - at
        squares = _dot(gap, gap)
        least = np.minimum.reduceat(squares, np.cumsum(count) - count)
        found = np.flatnonzero(squares == least[row])
        found = found[np.diff(row[found], prepend=-1) > 0]
        start_mm = self.starts_mm[k[found] + of]
        return start_mm + fraction[found] * (self.starts_mm[k[found] + of + 1] - start_mm), np.sqrt(least)


def _left(v: Floats) -> Floats:
    """Vectors turned a quarter to the left."""
    return np.stack([-v[..., 1], v[..., 0]], axis=-1)


def _cross(a: Floats, b: Floats) -> Floats:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def _dot(a: Floats, b: Floats) -> Floats:
    return np.asarray(a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1])
