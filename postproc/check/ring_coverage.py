"""When burns have covered a ring: by intervals, not by samples."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
import shapely

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.encoder.cut import Tab
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Contour


@dataclass(frozen=True, eq=False, slots=True)
class Covered:
    """What burns make of one ring, all places in mm along the ring.

    `out` is the burn with which the ring is covered, and how far along that burn; None where stretches are left `open`.
    `new` is what each burn covers first, `again` what it runs along although it was burnt by another before, and
    `until_mm` how far along a burn it leaves the ring for good.
    """

    out: tuple[int, float] | None
    open: tuple[tuple[float, float], ...]
    new: Mapping[int, Floats]
    again: Mapping[int, Floats] = field(default_factory=dict)
    until_mm: Mapping[int, float] = field(default_factory=dict)

    def numbered(self, burns: Sequence[int]) -> Covered:
        """The same, with the numbers that burns have elsewhere."""
        out = None if self.out is None else (burns[self.out[0]], self.out[1])
        new, again = ({burns[k]: rows for k, rows in of.items()} for of in (self.new, self.again))
        return Covered(out, self.open, new, again, {burns[k]: mm for k, mm in self.until_mm.items()})

    @property
    def open_mm(self) -> float:
        """How much is left open."""
        return sum(high - low for low, high in self.open)


def covered(
    rings: Sequence[shapely.LineString], free: Sequence[Floats], burns: Chords, within_mm: float
) -> list[Covered]:
    """What burns, in order of time, cover of each ring.

    Parameters
    ----------
    rings
        Lines round which the torch's centre has to go, each closed.
    free
        For each ring the stretches that nobody has to burn (see `intervals`).
    burns
        The torch's paths, by number in the order in which they are burnt.
    within_mm
        How far a burn may be from a ring that it covers.

    Returns
    -------
    One answer a ring. Stretches of less than `within_mm` do not count as open.
    """
    found = near_stretches(chords_of_lines(rings), burns, within_mm)
    first = np.searchsorted(found.line, np.arange(len(rings) + 1))
    return [
        _of_ring(found.only(np.arange(first[k], first[k + 1])), float(ring.length), free[k], within_mm)
        for k, ring in enumerate(rings)
    ]


def _of_ring(rows: NearStretches, length_mm: float, free: Floats, slack_mm: float) -> Covered:
    held, burnt = free, NONE
    new: dict[int, Floats] = {}
    again: dict[int, Floats] = {}
    until_mm: dict[int, float] = {}
    out: tuple[int, float] | None = None
    for burn in np.unique(rows.other).tolist():
        mine = rows.only(rows.other == burn)
        own = union(np.stack([mine.low_mm, mine.high_mm], axis=1))
        if total_mm(fresh := difference(own, burnt)) > 0:
            new[burn] = fresh
            until_mm[burn] = float(np.maximum(mine.other_low_mm, mine.other_high_mm).max())
        if total_mm(twice := intersection(own, burnt)) > 0:
            again[burn] = twice
        now = union(np.concatenate([held, own]))
        if out is None and not _left(now, length_mm, slack_mm):
            out = burn, _when(mine, held, length_mm, slack_mm)
        held, burnt = now, union(np.concatenate([burnt, own]))
    return Covered(out, tuple(_left(held, length_mm, slack_mm)), new, again, until_mm)


def _left(held: Floats, length_mm: float, slack_mm: float) -> list[tuple[float, float]]:
    """What of a ring counts as open."""
    left = closed_up(complement(held, length_mm), length_mm)
    return [(low, high) for low, high in left if high - low > slack_mm]


def _when(mine: NearStretches, held: Floats, length_mm: float, slack_mm: float) -> float:
    """How far along a burn the ring is covered, `held` being covered before."""
    done_mm = np.maximum(mine.other_low_mm, mine.other_high_mm)
    order = np.argsort(done_mm, kind="stable")
    mine, done_mm = mine.only(order), done_mm[order]
    rows = np.stack([mine.low_mm, mine.high_mm], axis=1)

    def after(count: int) -> Floats:
        return union(np.concatenate([held, rows[:count]]))

    low, high = 0, len(rows)
    while low < high:
        middle = (low + high) // 2
        if _left(after(middle), length_mm, slack_mm):
            low = middle + 1
        else:
            high = middle
    if low == 0:
        return float(done_mm[0])
    last = low - 1
    lacking = intersection(complement(after(last), length_mm), rows[last : last + 1])
    if not len(lacking) or rows[last, 1] - rows[last, 0] < 1e-9:
        return float(done_mm[last])
    at = np.interp(lacking.ravel(), rows[last], [mine.other_low_mm[last], mine.other_high_mm[last]])
    return float(at.max())


# Which stretch of each chord lies near another chord, in closed form for all pairs at once.
#
# The distance to a convex set is convex along a line. So what of a chord lies within a distance of another is one
# interval. It is where the chord meets a strip beside the other one, and two discs round its ends.


@dataclass(frozen=True, eq=False, slots=True)
class NearStretches:
    """Pairs of a chord and another one: the stretch of the first that is near the second, and what it lies beside.

    `line` and `low_mm` to `high_mm` are the line of the first chord and the stretch of it; `other` is the line of the
    second, `other_low_mm` and `other_high_mm` the places on it beside the two ends; `along` is the cosine between them.
    """

    line: Ints
    low_mm: Floats
    high_mm: Floats
    other: Ints
    other_low_mm: Floats
    other_high_mm: Floats
    along: Floats

    def __len__(self) -> int:
        return len(self.line)

    def only(self, rows: Bools | Ints) -> NearStretches:
        """Some of the pairs."""
        return NearStretches(*(getattr(self, name)[rows] for name in self.__slots__))


def near_stretches(chords: Chords, others: Chords, within_mm: float) -> NearStretches:
    """The stretches of chords within a distance of other chords.

    Examples
    --------
    >>> one, other = (chords_of_lines([shapely.LineString(p)]) for p in ([(0, 0), (10, 0)], [(4, 3), (4, 1), (9, 1)]))
    >>> found = near_stretches(one, other, 1.0)
    >>> found.low_mm.tolist(), found.high_mm.tolist(), found.other_high_mm.tolist()
    ([4.0, 4.0], [4.0, 9.0], [2.0, 7.0])
    """
    if not len(chords) or not len(others):
        return NearStretches(*(np.empty(0, dtype=kind) for kind in (int, float, float, int, float, float, float)))
    mine, theirs = shapely.STRtree(others.lines()).query(chords.lines(), "dwithin", distance=within_mm)
    order = np.lexsort((theirs, mine))
    mine, theirs = mine[order], theirs[order]
    start, way = chords.begin[mine], chords.end[mine] - chords.begin[mine]
    origin, theirs_way = others.begin[theirs], others.end[theirs] - others.begin[theirs]
    length_mm = np.hypot(*theirs_way.T)
    unit = theirs_way / length_mm[:, None]
    from_mm, along_mm = _dot(start - origin, unit), _dot(way, unit)
    strip = np.stack(
        [
            _slab(from_mm, along_mm, 0.0 * length_mm, length_mm),
            _slab(
                _cross(unit, start - origin), _cross(unit, way), -within_mm + 0 * length_mm, within_mm + 0 * length_mm
            ),
        ]
    )
    pieces = [np.stack([strip[:, 0].max(axis=0), strip[:, 1].min(axis=0)])]
    for at, free in ((origin, others.first[theirs]), (others.end[theirs], others.last[theirs])):
        disc = _disc(start - at, way, within_mm)
        disc[:, free] = np.array([[np.inf], [-np.inf]])
        pieces.append(disc)
    low, high = np.inf + 0 * length_mm, -np.inf + 0 * length_mm
    for a, b in pieces:
        some = a <= b
        low, high = np.where(some, np.minimum(low, a), low), np.where(some, np.maximum(high, b), high)
    low, high = np.maximum(low, 0.0), np.minimum(high, 1.0)
    kept = low <= high
    mine, theirs, low, high = mine[kept], theirs[kept], low[kept], high[kept]
    share = others.span_mm[theirs] / length_mm[kept]

    def beside(fraction: Floats) -> Floats:
        along = np.clip(from_mm[kept] + fraction * along_mm[kept], 0.0, length_mm[kept])
        return np.asarray(others.at_mm[theirs] + along * share)

    at_mm, span_mm = chords.at_mm[mine], chords.span_mm[mine]
    return NearStretches(
        chords.of[mine], at_mm + low * span_mm, at_mm + high * span_mm,
        others.of[theirs], beside(low), beside(high), along_mm[kept] / np.hypot(*way[kept].T),
    )  # fmt: skip


def _slab(at: Floats, step: Floats, least: Floats, most: Floats) -> Floats:
    """Where `at` + t · `step` lies between two bounds: (2, n), the first greater than the second where nowhere."""
    still = np.abs(step) < 1e-12
    safe = np.where(still, 1.0, step)
    one, other = (least - at) / safe, (most - at) / safe
    inside = (least <= at) & (at <= most)
    low = np.where(still, np.where(inside, -np.inf, np.inf), np.minimum(one, other))
    high = np.where(still, np.where(inside, np.inf, -np.inf), np.maximum(one, other))
    return np.stack([low, high])


def _disc(away: Floats, way: Floats, radius_mm: float) -> Floats:
    """Where a point at `away` from the middle, moved by t · `way`, lies in a disc: (2, n)."""
    a, b, c = _dot(way, way), _dot(away, way), _dot(away, away) - radius_mm**2
    under = b * b - a * c
    root = np.sqrt(np.maximum(under, 0.0))
    none = under < 0
    return np.stack([np.where(none, np.inf, (-b - root) / a), np.where(none, -np.inf, (-b + root) / a)])


def _dot(one: Floats, other: Floats) -> Floats:
    return np.asarray((one * other).sum(axis=1))


def _cross(one: Floats, other: Floats) -> Floats:
    return np.asarray(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])


# Lines and paths as chords, all in a few arrays.

CHORD_MM = 0.005
"""Arcs of paths are followed by chords that leave them by no more than this."""


@dataclass(frozen=True, eq=False, slots=True)
class Chords:
    """Chords of several lines, those of a line in a row.

    `begin` and `end` (n, 2) are their ends, mm; `of` is the number of the line, `at_mm` how far along it a chord
    begins, and `span_mm` how much of it the chord stands for. `first` and `last` mark chords at the free ends of open
    lines.
    """

    begin: Floats
    end: Floats
    of: Ints
    at_mm: Floats
    span_mm: Floats
    first: Bools
    last: Bools

    def __len__(self) -> int:
        return len(self.of)

    def boxes(self, more_mm: float) -> Floats:
        """A box around all chords of each line, so much wider."""
        numbers, first = np.unique(self.of, return_index=True)
        if not len(numbers):
            return np.empty(0, dtype=object)
        low = np.minimum.reduceat(np.minimum(self.begin, self.end), first) - more_mm
        high = np.maximum.reduceat(np.maximum(self.begin, self.end), first) + more_mm
        return np.asarray(shapely.box(low[:, 0], low[:, 1], high[:, 0], high[:, 1]))

    def lines(self) -> Floats:
        """Each chord as a shapely line."""
        return np.asarray(shapely.linestrings(np.stack([self.begin, self.end], axis=1)))


def chords_of_lines(lines: Sequence[shapely.Geometry]) -> Chords:
    """The chords of shapely lines or rings; places along them are by their own lengths.

    Examples
    --------
    >>> chords = chords_of_lines([shapely.LineString([(0, 0), (3, 0), (3, 4)])])
    >>> chords.at_mm.tolist(), chords.span_mm.tolist(), chords.last.tolist()
    ([0.0, 3.0], [3.0, 4.0], [False, True])
    """
    points, of = shapely.get_coordinates(lines, return_index=True)
    closed = shapely.is_closed(lines)
    return _chords(points, of, None, np.asarray(closed))


def chords_of_paths(paths: Iterable[Curve]) -> Chords:
    """The chords of open paths; places along them are by the true lengths of arcs."""
    points, at, of = [np.empty((0, 2))], [np.empty(0)], [np.empty(0, dtype=np.int64)]
    count = 0
    for count, path in enumerate(paths, 1):
        if not path.segments:
            continue
        pieces = [np.array([path.segments[0].start])] + [s.flatten(CHORD_MM) for s in path.segments]
        starts = path.starts_mm.tolist()
        places = [np.zeros(1)] + [
            a + (b - a) * np.arange(1, len(piece) + 1) / len(piece)
            for (a, b), piece in zip(pairwise(starts), pieces[1:], strict=True)
        ]
        points += pieces
        at += places
        of.append(np.full(sum(map(len, pieces)), count - 1, dtype=np.int64))
    return _chords(np.concatenate(points), np.concatenate(of), np.concatenate(at), np.zeros(count, dtype=bool))


def _chords(points: Floats, of: Ints, at_mm: Floats | None, closed: Bools) -> Chords:
    follows = np.flatnonzero(of[1:] == of[:-1])
    lengths = np.hypot(*(points[follows + 1] - points[follows]).T)
    follows, lengths = follows[lengths > 1e-9], lengths[lengths > 1e-9]
    line = of[follows]
    new = np.concatenate([[True], line[1:] != line[:-1]]) if len(line) else np.zeros(0, dtype=bool)
    if at_mm is None:
        ends = np.cumsum(lengths)
        begins = ends - lengths
        starts = begins[new][np.cumsum(new) - 1] if len(line) else begins
        at, span = begins - starts, lengths
    else:
        at, span = at_mm[follows], at_mm[follows + 1] - at_mm[follows]
    last = np.concatenate([new[1:], [True]]) if len(line) else new
    is_open = ~closed[line] if len(line) else new
    return Chords(points[follows], points[follows + 1], line, at, span, new & is_open, last & is_open)


# Sets of intervals on a line, each an array (k, 2) of ends in order that do not touch.

NONE: Floats = np.empty((0, 2))


def union(rows: Floats, slack_mm: float = 1e-9) -> Floats:
    """Any intervals (n, 2) as a set; those less than `slack_mm` apart become one.

    Examples
    --------
    >>> union(np.array([[4.0, 6.0], [0.0, 1.0], [5.0, 9.0]])).tolist()
    [[0.0, 1.0], [4.0, 9.0]]
    """
    if not len(rows):
        return NONE
    rows = rows[np.argsort(rows[:, 0], kind="stable")]
    reach = np.maximum.accumulate(rows[:, 1])
    new = np.concatenate([[True], rows[1:, 0] > reach[:-1] + slack_mm])
    first = np.flatnonzero(new)
    return np.stack([rows[first, 0], reach[np.concatenate([first[1:] - 1, [len(rows) - 1]])]], axis=1)


def complement(held: Floats, length_mm: float) -> Floats:
    """What a set leaves of 0 to `length_mm`.

    Examples
    --------
    >>> complement(np.array([[1.0, 2.0], [5.0, 9.0]]), 8.0).tolist()
    [[0.0, 1.0], [2.0, 5.0]]
    """
    low = np.concatenate([[0.0], held[:, 1]])
    high = np.concatenate([held[:, 0], [length_mm]])
    left = np.stack([np.clip(low, 0.0, length_mm), np.clip(high, 0.0, length_mm)], axis=1)
    return np.asarray(left[left[:, 1] - left[:, 0] > 1e-9])


def intersection(one: Floats, other: Floats) -> Floats:
    """What two sets share.

    Examples
    --------
    >>> intersection(np.array([[0.0, 3.0], [5.0, 9.0]]), np.array([[2.0, 6.0]])).tolist()
    [[2.0, 3.0], [5.0, 6.0]]
    """
    low = np.maximum(one[:, None, 0], other[None, :, 0]).ravel()
    high = np.minimum(one[:, None, 1], other[None, :, 1]).ravel()
    return union(np.stack([low, high], axis=1)[high > low])


def difference(one: Floats, other: Floats) -> Floats:
    """What one set has and the other has not."""
    if not len(one) or not len(other):
        return one
    return intersection(one, complement(other, float(max(one[-1, 1], other[-1, 1]))))


def total_mm(held: Floats) -> float:
    """How long a set is altogether."""
    return float((held[:, 1] - held[:, 0]).sum())


def closed_up(left: Floats, length_mm: float) -> list[tuple[float, float]]:
    """What is left of a closed ring, the stretch across its first point in one piece: its end is beyond the length.

    Examples
    --------
    >>> closed_up(np.array([[0.0, 1.0], [4.0, 5.0], [7.0, 8.0]]), 8.0)
    [(4.0, 5.0), (7.0, 9.0)]
    """
    rows = [(low, high) for low, high in left.tolist()]
    if len(rows) > 1 and rows[0][0] <= 1e-9 and rows[-1][1] >= length_mm - 1e-9:
        rows = [*rows[1:-1], (rows[-1][0], length_mm + rows[0][1])]
    return rows


# What of a ring nobody has to burn: its rounds at corners, and its tabs.

_SAME_MM = 1e-4
_CHORD_MM = 0.005


def rounds(ring: shapely.LineString, contour: Contour) -> Floats:
    """The stretches of a ring that go round corners of its contour, as a set of intervals.

    Once the torch has been at both ends of such a round, the corner is cut. Whether it goes round in between, or
    straight on until its next way crosses, is the same to the part.
    """
    points = shapely.points(shapely.get_coordinates(ring))
    at_mm = shapely.line_locate_point(ring, points)
    at_mm[-1] = ring.length if contour.encloses else at_mm[-1]
    beside = shapely.line_locate_point(contour.curve.line(_CHORD_MM), points)
    turns = np.abs(np.diff(beside)) < _SAME_MM
    return union(np.stack([at_mm[:-1][turns], at_mm[1:][turns]], axis=1), _SAME_MM) if turns.any() else NONE


def tab_intervals(ring: shapely.LineString, tabs: Sequence[Tab], more_mm: float) -> Floats:
    """The stretches of a closed ring that its tabs take, each `more_mm` wider at both ends, as a set of intervals.

    Here a tab is as wide as the ring is not burnt: as its metal and the kerf.
    """
    rows: list[tuple[float, float]] = []
    length_mm = float(ring.length)
    for tab in tabs:
        middle = float(shapely.line_locate_point(ring, shapely.Point(tab.at)))
        half = min(tab.width_mm / 2 + more_mm, length_mm / 2)
        low, high = middle - half, middle + half
        rows += [(max(low, 0.0), min(high, length_mm))]
        rows += [(length_mm + low, length_mm)] if low < 0 else []
        rows += [(0.0, high - length_mm)] if high > length_mm else []
    return union(np.array(rows)) if rows else NONE
