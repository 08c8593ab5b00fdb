"""What the boundary of parts and the ends of cuts face, and how much of it is rigid metal, by plain geometry."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
import shapely

from kerfwise.arrays import Bools, Floats, Ints, concat_ranges
from kerfwise.encoder.cut import Cut, CutSequence
from kerfwise.encoder.nest import Contour, Nest, cached_with_nest

from .metal import host_holes

# What the boundary of parts faces, as the judging of rules sees it (Petunin 2009, section 2.1).
#
# Plain shapely on purpose, and nothing from the facts that models are built on: a wrong fact must not hide here too.

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


def spots_along_each(stretches: Sequence[Stretch]) -> Spots:
    """As `spots_along` of each, one behind the other, in less time."""
    return Spots.joined([_spots(stretches[k : k + LINES_AT_ONCE]) for k in range(0, len(stretches), LINES_AT_ONCE)])


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
    place = concat_ranges(np.zeros_like(until), np.asarray(count))
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
        return concat_ranges(first.take(box), times), np.repeat(chord, times)

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


@cached_with_nest(most=2)
def facing(nest: Nest, web_mm: float, edge_band_mm: float) -> Facing:
    """The outlines of a nest, laid out once: every excuse asks for them again."""
    return Facing(nest, web_mm, edge_band_mm)


# How much rigid metal the end of a cut faces, by plain geometry: the judging half of rule part-rigidity.

STEP_MM, LEAST_SPOTS, MOST_SPOTS = 1.0, 100, 200
"""The end of a cut is looked at a millimetre apart, in no less and no more spots than these."""
ROUND = 400
"""Spots on a whole contour."""


def rigid_at_the_end(
    nest: Nest, cuts: CutSequence, tail_share: float, web_mm: float, edge_band_mm: float
) -> Iterator[tuple[int, float]]:
    """Position of the cut of each outer contour, and the share of its end that faces solid metal or parts still in."""
    cut_at = np.full(len(nest.parts), len(cuts) + 1)
    judged: list[tuple[int, int]] = []
    pairs: list[tuple[Contour, Cut]] = []
    for k, cut in enumerate(cuts, 1):
        contour = nest.contour(cut.contour)
        if contour.kind != "outer":
            continue
        part = nest.owners[nest.index[cut.contour]]
        cut_at[part] = k
        judged.append((k, part))
        pairs.append((contour, cut))
    tails: list[Stretch] = []
    for (_, part), (contour, _), way in zip(judged, pairs, follow_all(pairs), strict=True):
        end_mm, tail_mm = way.stretch(tail_share, last=True)
        count = min(max(math.ceil(abs(tail_mm) / STEP_MM), LEAST_SPOTS), MOST_SPOTS)
        tails.append((part, contour.line, end_mm, tail_mm, count))
    faced = facing(nest, web_mm, edge_band_mm).faced(spots_along_each(tails))
    begin = 0
    for (k, _), (*_, count) in zip(judged, tails, strict=True):
        met = faced[begin : begin + count]
        begin += count
        still_in = cut_at[np.maximum(met, 0)] > k
        yield k, float(np.where(met >= 0, still_in, met != EDGE).mean())


@cached_with_nest(most=2)
def _rounds(nest: Nest, web_mm: float, edge_band_mm: float) -> dict[int, Ints]:
    """Part number → what it faces in `ROUND` spots all the way round, for the parts that were asked about."""
    return {}


def rigid_at_best(
    nest: Nest, contour: str, out: frozenset[str], tail_share: float, web_mm: float, edge_band_mm: float
) -> float:
    """The greatest share of rigid metal at the end of any way round from any entry, once the contours `out` are cut."""
    part, rounds = nest.owners[nest.index[contour]], _rounds(nest, web_mm, edge_band_mm)
    if part not in rounds:
        line = nest.parts[part].outer.line
        rounds[part] = facing(nest, web_mm, edge_band_mm).faced(spots_along(part, line, 0.0, line.length, ROUND))
    faced = rounds[part]
    free = [EDGE, *(k for k in np.unique(faced[faced >= 0]).tolist() if nest.parts[k].outer.id in out)]
    rigid = np.concatenate([[0], np.cumsum(np.tile(~np.isin(faced, free), 2))])
    tail = max(1, round(tail_share * ROUND))
    return float((rigid[tail:] - rigid[:-tail]).max() / tail)


# Which stretch of its contour a cut follows: all of it, or what others have left.


@dataclass(frozen=True, slots=True)
class Followed:
    """Where a cut begins and ends along its contour as drawn, mm, and how far it follows it: below 0 against it."""

    begin_mm: float
    end_mm: float
    length_mm: float

    def stretch(self, share: float, *, last: bool) -> tuple[float, float]:
        """Where the first or the last share of the cut begins, as seen from its end of the cut, and how long it is."""
        return (self.end_mm, -share * self.length_mm) if last else (self.begin_mm, share * self.length_mm)


def followed(contour: Contour, cut: Cut) -> Followed:
    """The stretch of a closed contour that a cut follows.

    Examples
    --------
    >>> from kerfwise.rules.case import part, rect
    >>> from kerfwise.encoder.cut import Span
    >>> square = part("A", rect(0, 0, 10, 10)).outer
    >>> followed(square, Cut("A.outer", (10, 0), "cw", (11, 0)))
    Followed(begin_mm=10.0, end_mm=10.0, length_mm=-40.0)
    >>> followed(square, Cut("A.outer", (10, 0), "cw", (11, 0), span=Span((11, 0), (10, 11))))
    Followed(begin_mm=10.0, end_mm=20.0, length_mm=-30.0)
    """
    return follow_all([(contour, cut)])[0]


def follow_all(rows: Sequence[tuple[Contour, Cut]]) -> list[Followed]:
    """As `followed` of each, in less time."""
    if not rows:
        return []
    lines = np.array([contour.line for contour, _ in rows], dtype=object)
    begin_mm = shapely.line_locate_point(lines, shapely.points([cut.entry for _, cut in rows]))
    points, of = shapely.get_coordinates(lines, return_index=True)
    ccw = shapely.is_ccw(shapely.linearrings(points, indices=of))
    walks = zip(rows, lines, begin_mm.tolist(), shapely.length(lines).tolist(), ccw.tolist(), strict=True)
    return [
        _followed(cut, line, begin, around, (cut.direction == "ccw") == turns)
        for (_, cut), line, begin, around, turns in walks
    ]


def _followed(cut: Cut, line: shapely.LineString, begin_mm: float, around_mm: float, as_drawn: bool) -> Followed:
    if cut.span is None:
        return Followed(begin_mm, begin_mm, around_mm if as_drawn else -around_mm)
    end_mm = float(shapely.line_locate_point(line, shapely.Point(cut.span.end)))
    way_mm = (end_mm - begin_mm if as_drawn else begin_mm - end_mm) % around_mm
    return Followed(begin_mm, end_mm, way_mm if as_drawn else -way_mm)


# What the first and the last stretch of each cut face, and each outline as a whole, by plain geometry.

STRETCH_STEP_MM, LEAST_STRETCH_SPOTS, MOST_STRETCH_SPOTS = 0.5, 200, 2000
"""A stretch is looked at this far apart, in no less and no more spots than these."""


@dataclass(frozen=True, eq=False, slots=True)
class Faced:
    """A stretch of an outer contour: its length, how much of it faces the sheet's edge and solid metal, and the rest:

    contour number → length that faces it.
    """

    total_mm: float
    edge_mm: float
    solid_mm: float
    contours_mm: Mapping[int, float]


def faced_by_cuts(
    nest: Nest, cuts: CutSequence, share: float, web_mm: float, edge_band_mm: float, *, last: bool
) -> dict[int, Faced]:
    """Contour number → what the first (or `last`) share of its cut faces, for each outer contour that is cut."""
    of_cuts = ((nest.contour(cut.contour), cut) for cut in cuts)
    outers = [(contour, cut) for contour, cut in of_cuts if contour.kind == "outer"]
    ways = zip(outers, follow_all(outers), strict=True)
    queries = [(nest.index[contour.id], *way.stretch(share, last=last)) for (contour, _), way in ways]
    return _faced(nest, queries, web_mm, edge_band_mm)


def faced_all_round(nest: Nest, web_mm: float, edge_band_mm: float) -> dict[int, Faced]:
    """Contour number → what the whole outline faces, for each outer contour."""
    outers = [part.outer for part in nest.parts]
    return _faced(nest, [(nest.index[c.id], 0.0, c.line.length) for c in outers], web_mm, edge_band_mm)


def _faced(nest: Nest, queries: list[tuple[int, float, float]], web_mm: float, edge_band_mm: float) -> dict[int, Faced]:
    """What stretches of contours (number, where they begin, how long they are) face."""
    part = {p.id: k for k, p in enumerate(nest.parts)}
    outer = [nest.index[p.outer.id] for p in nest.parts]
    stretches: list[Stretch] = []
    for number, begin_mm, length_mm in queries:
        contour = nest.contours[number]
        count = min(max(math.ceil(abs(length_mm) / STRETCH_STEP_MM), LEAST_STRETCH_SPOTS), MOST_STRETCH_SPOTS)
        stretches.append((part[contour.part], contour.line, begin_mm, length_mm, count))
    met = facing(nest, web_mm, edge_band_mm).faced(spots_along_each(stretches))
    counts = [count for *_, count in stretches]
    found: dict[int, Faced] = {}
    for (number, _, length_mm), own in zip(queries, np.split(met, np.cumsum(counts)[:-1]), strict=True):
        each_mm = abs(length_mm) / len(own)
        values, times = np.unique(own, return_counts=True)
        mm = {int(value): float(count * each_mm) for value, count in zip(values, times, strict=True)}
        edge_mm, solid_mm = mm.pop(EDGE, 0.0), mm.pop(SOLID, 0.0)
        found[number] = Faced(abs(length_mm), edge_mm, solid_mm, {outer[k]: v for k, v in mm.items()})
    return found
