"""What the boundary of parts faces, as the judging of rules sees it (Petunin 2009, section 2.1).

Plain shapely on purpose, and nothing from the facts that models are built on: a wrong fact must not hide here too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
import shapely

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.encoder.kept import kept_with_nest
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.ranges import laid_out

from .placement import host_holes

SOLID, EDGE = -1, -2
"""Faced by a boundary that looks at wide uncut metal, or at the end of the sheet."""
LINES_AT_ONCE = 256
"""Lines along which spots are laid out together: more would take memory, and no less time."""
AT_ONCE = 1 << 16
"""Spots that are looked at together: more would take memory, and no less time."""
DOUBT_MM2 = 1e-6
"""Areas this small may be rounding: a thousand times what it makes of a sheet of a hundred metres."""
FLAT_MM2 = 1e-6
"""An outline that leaves less than this of its convex hull has no mouth that a look could go across."""
RAYS_IN_BOX = 4
CONTACT_MM = 0.05
"""Outlines that overlap by less touch; a contour's own line nearer than this is where one stands."""
Stretch: TypeAlias = tuple[int, shapely.LineString, float, float, int]
"""The number of a part, a line of it, where spots begin there, mm, for how far, mm, and how many they are."""


@dataclass(frozen=True, eq=False, slots=True)
class Spots:
    """k places on the outer contours of parts: `part` (k,) its number, `at` (k, 2), `normal` (k, 2) out of the part."""

    part: Ints
    at: Floats
    normal: Floats

    @staticmethod
    def joined(spots: list[Spots]) -> Spots:
        """Several lists as one."""
        if not spots:
            return Spots(np.empty(0, np.int64), np.empty((0, 2)), np.empty((0, 2)))
        return Spots(
            np.concatenate([s.part for s in spots]),
            np.concatenate([s.at for s in spots]),
            np.concatenate([s.normal for s in spots]),
        )


def spots_along(part: int, line: shapely.LineString, begin_mm: float, length_mm: float, count: int) -> Spots:
    """The middles of `count` equal pieces of a closed line, from `begin_mm` on for `length_mm` (negative: backwards).

    Examples
    --------
    >>> square = shapely.LineString([(0, 0), (10, 0), (10, 10), (0, 10), (0, 0)])
    >>> spots = spots_along(0, square, 35, 10, 2)
    >>> spots.at.tolist(), (spots.normal + 0.0).tolist()
    ([[0.0, 2.5], [2.5, 0.0]], [[-1.0, 0.0], [0.0, -1.0]])
    """
    return spots_along_each([(part, line, begin_mm, length_mm, count)])


def spots_along_each(asked: Sequence[Stretch]) -> Spots:
    """As `spots_along` of each, one behind the other, in less time."""
    return Spots.joined([_spots(asked[k : k + LINES_AT_ONCE]) for k in range(0, len(asked), LINES_AT_ONCE)])


def _spots(stretches: Sequence[Stretch]) -> Spots:
    """See `spots_along_each`; of some stretches, but not too many."""
    parts, lines, begin_mm, length_mm, count = zip(*stretches, strict=True)
    points, of = shapely.get_coordinates(lines, return_index=True)
    chord = np.flatnonzero(of[1:] == of[:-1])
    step = points.take(chord + 1, axis=0) - points.take(chord, axis=0)
    step_mm = np.hypot(step[:, 0], step[:, 1])
    moves = step_mm > 0
    chord, step, step_mm = chord.compress(moves), step.compress(moves, axis=0), step_mm.compress(moves)
    first = np.searchsorted(of.take(chord), np.arange(len(lines) + 1))
    until = np.cumsum(count)
    place = laid_out(np.zeros_like(until), np.asarray(count))
    begins, lengths, counts = (np.repeat(given, count) for given in (begin_mm, length_mm, count))
    where = begins + lengths * (place + 0.5) / counts
    ends, k = np.empty_like(step_mm), np.empty(len(where), dtype=np.int64)
    spot = 0
    for a, b, last in zip(first[:-1].tolist(), first[1:].tolist(), until.tolist(), strict=True):
        own, asked = np.cumsum(step_mm[a:b], out=ends[a:b]), slice(spot, last)
        where[asked] %= own[-1]
        k[asked] = a + np.minimum(np.searchsorted(own, where[asked], side="right"), b - a - 1)
        spot = last
    along = step.take(k, axis=0) / step_mm.take(k)[:, None]
    outwards = np.repeat(np.where(shapely.is_ccw(shapely.linearrings(points, indices=of)), 1.0, -1.0), count)
    at = points.take(chord.take(k), axis=0) + along * (where - ends.take(k) + step_mm.take(k))[:, None]
    return Spots(np.repeat(parts, count), at, outwards[:, None] * np.column_stack([along[:, 1], -along[:, 0]]))


class Facing:
    """The outlines of a nest, to be looked at along outward normals.

    A look that meets another part within `web_mm` faces it, one that meets the end of the sheet within `edge_band_mm`
    an edge, any other solid metal: also one across a mouth of the same part. A part inside a hole of a host faces the
    host.
    """

    def __init__(self, nest: Nest, web_mm: float, edge_band_mm: float) -> None:
        number = {part.id: k for k, part in enumerate(nest.parts)}
        lines: list[Any] = [part.outer.line for part in nest.parts]
        owners = list(range(len(nest.parts)))
        for hole in {hole.id: hole for hole in host_holes(nest).values()}.values():
            lines.append(hole.line)
            owners.append(number[hole.part])
        for curve in (nest.sheet.outline, *nest.sheet.holes):
            lines.append(curve.line())
            owners.append(EDGE)
        points, of = shapely.get_coordinates(lines, return_index=True)
        within = of[1:] == of[:-1]
        self.begin: Floats = points[:-1].compress(within, axis=0)
        self.end: Floats = points[1:].compress(within, axis=0)
        self._xy: Floats = np.ascontiguousarray(np.hstack([self.begin, self.end]).T)
        self.owner: Ints = np.array(owners, dtype=np.int64)[of[1:][within]]
        self.tree = shapely.STRtree(shapely.linestrings(np.stack([self.begin, self.end], axis=1)))
        self.web_mm, self.edge_band_mm = web_mm, edge_band_mm
        outlines = np.array([part.outer.polygon for part in nest.parts], dtype=object)
        self.convex: Bools = shapely.area(shapely.convex_hull(outlines)) - shapely.area(outlines) < FLAT_MM2

    def faced(self, spots: Spots) -> Ints:
        """What each spot faces: the number of a part, EDGE or SOLID."""
        count = len(spots.part)
        some = (slice(k, min(k + AT_ONCE, count)) for k in range(0, count, AT_ONCE))
        found = [self._faced(Spots(spots.part[s], spots.at[s], spots.normal[s])) for s in some]
        return np.concatenate([np.empty(0, np.int64), *found])

    def _faced(self, spots: Spots) -> Ints:
        """See `faced`; of not too many spots."""
        found = np.full(len(spots.part), SOLID, dtype=np.int64)
        start = spots.at - CONTACT_MM * spots.normal
        end = spots.at + (max(self.web_mm, self.edge_band_mm) + 1e-6) * spots.normal
        ray, chord = self._met(start, end, spots.part)
        away_mm = self._away(start.take(ray, axis=0), spots.normal.take(ray, axis=0), chord) - CONTACT_MM
        owner = self.owner.take(chord)
        itself = (owner == spots.part.take(ray)) & (away_mm < CONTACT_MM)
        ray, owner, away_mm = ray[~itself], owner[~itself], away_mm[~itself]
        order = np.lexsort((owner, away_mm, ray))
        ray, owner, away_mm = ray[order], owner[order], away_mm[order]
        first = np.flatnonzero(np.diff(ray, prepend=-1))
        ray, owner, away_mm = ray[first], owner[first], away_mm[first]
        near = away_mm <= np.where(owner == EDGE, self.edge_band_mm, self.web_mm) + 1e-6
        near &= owner != spots.part[ray]
        found[ray[near]] = owner[near]
        return found

    def _met(self, start: Floats, end: Floats, part: Ints) -> tuple[Ints, Ints]:
        """The numbers of rays and of chords that meet: mostly told by the sides that ends lie on, else by shapely."""
        ray, chord = self._near(start, end, part)
        (x, y), (dx, dy) = start.T, (end - start).T
        x, y, dx, dy = x.take(ray), y.take(ray), dx.take(ray), dy.take(ray)
        u_at = dx * (self._xy[1].take(chord) - y) - dy * (self._xy[0].take(chord) - x)
        v_at = dx * (self._xy[3].take(chord) - y) - dy * (self._xy[2].take(chord) - x)
        maybe = np.flatnonzero(~_surely_alike(u_at, v_at))
        ray, chord, u_at, v_at = ray.take(maybe), chord.take(maybe), u_at.take(maybe), v_at.take(maybe)
        p, q = start.take(ray, axis=0), end.take(ray, axis=0)
        u, v = self.begin.take(chord, axis=0), self.end.take(chord, axis=0)
        p_at, q_at = _side(u, v, p), _side(u, v, q)
        met = (u_at * v_at < 0) & (p_at * q_at < 0)
        least = np.minimum(np.minimum(abs(u_at), abs(v_at)), np.minimum(abs(p_at), abs(q_at)))
        doubt = np.flatnonzero(~_surely_alike(p_at, q_at) & (least < DOUBT_MM2))
        rays = shapely.linestrings(np.stack([p[doubt], q[doubt]], axis=1))
        met[doubt] = shapely.intersects(rays, self.tree.geometries[chord[doubt]])
        return ray[met], chord[met]

    def _near(self, start: Floats, end: Floats, part: Ints) -> tuple[Ints, Ints]:
        """The numbers of rays and of chords that may meet: chords are looked up in the box of some rays in a row."""
        if not len(part):
            return np.empty(0, np.int64), np.empty(0, np.int64)
        new = np.flatnonzero(np.diff(part, prepend=-1))
        place = np.arange(len(part)) - np.repeat(new, np.diff(new, append=len(part)))
        first = np.flatnonzero(place % RAYS_IN_BOX == 0)
        count = np.diff(first, append=len(part))
        low = np.minimum.reduceat(np.minimum(start, end), first)
        high = np.maximum.reduceat(np.maximum(start, end), first)
        box, chord = self.tree.query(shapely.box(low[:, 0], low[:, 1], high[:, 0], high[:, 1]))
        looks = part.take(first).take(box)
        # a look out of a convex part meets only where it is
        other = (self.owner.take(chord) != looks) | ~self.convex.take(looks)
        box, chord = box.compress(other), chord.compress(other)
        times = count.take(box)
        return laid_out(first.take(box), times), np.repeat(chord, times)

    def _away(self, start: Floats, normal: Floats, chord: Ints) -> Floats:
        """How far along the normals the chords are that they meet, mm; along a chord itself, its nearer end."""
        (x, y), (u, v) = start.T, normal.T
        along, aside = [], []
        for xs, ys in (self._xy[:2], self._xy[2:]):
            dx, dy = xs.take(chord) - x, ys.take(chord) - y
            along.append(dx * u + dy * v)
            aside.append(dx * v - dy * u)
        width = aside[0] - aside[1]
        share = np.where(np.abs(width) > 1e-12, aside[0] / np.where(width == 0, 1.0, width), 0.0)
        across = along[0] + np.clip(share, 0.0, 1.0) * (along[1] - along[0])
        return np.asarray(np.where(np.abs(width) > 1e-12, across, np.maximum(np.minimum(*along), 0.0)))


def _side(begin: Floats, end: Floats, at: Floats) -> Floats:
    """On which side of a line from begin to end a place lies, as twice the area of the triangle, mm²."""
    along, towards = end - begin, at - begin
    return np.asarray(along[:, 0] * towards[:, 1] - along[:, 1] * towards[:, 0])


def _surely_alike(one: Floats, other: Floats) -> Bools:
    """Whether two places lie on the same side of a line, whatever rounding did."""
    return np.asarray((one * other > 0) & (np.minimum(abs(one), abs(other)) >= DOUBT_MM2))


@kept_with_nest(most=2)
def facing(nest: Nest, web_mm: float, edge_band_mm: float) -> Facing:
    """The outlines of a nest, laid out once: every excuse asks for them again."""
    return Facing(nest, web_mm, edge_band_mm)
