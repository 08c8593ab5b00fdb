"""Lines and paths as chords, all in a few arrays."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.encoder.geometry.curve import Curve

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
