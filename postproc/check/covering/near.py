"""Which stretch of each chord lies near another chord, in closed form for all pairs at once.

The distance to a convex set is convex along a line. So what of a chord lies within a distance of another is one
interval. It is where the chord meets a strip beside the other one, and two discs round its ends.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from kerfwise.arrays import Bools, Floats, Ints

from .chords import Chords


@dataclass(frozen=True, eq=False, slots=True)
class Near:
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

    def only(self, rows: Bools | Ints) -> Near:
        """Some of the pairs."""
        return Near(*(getattr(self, name)[rows] for name in self.__slots__))


def near(chords: Chords, others: Chords, within_mm: float) -> Near:
    """The stretches of chords within a distance of other chords.

    Examples
    --------
    >>> from .chords import chords_of_lines
    >>> one, other = (chords_of_lines([shapely.LineString(p)]) for p in ([(0, 0), (10, 0)], [(4, 3), (4, 1), (9, 1)]))
    >>> found = near(one, other, 1.0)
    >>> found.low_mm.tolist(), found.high_mm.tolist(), found.other_high_mm.tolist()
    ([4.0, 4.0], [4.0, 9.0], [2.0, 7.0])
    """
    if not len(chords) or not len(others):
        return Near(*(np.empty(0, dtype=kind) for kind in (int, float, float, int, float, float, float)))
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
    return Near(
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
