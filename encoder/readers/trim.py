"""Ends of lines that go on too far: over another line, along one, or past a corner."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely

from kerfwise.arrays import Floats, Ints, point_tree
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.measures import Circle, Line, crossings
from kerfwise.encoder.geometry.segment import Point, Segment

from .drawing import SNAP_MM, DrawnCurve

OVERRUN_SHARE = 0.25
"""An end that is longer than this share of its line is no overrun of a corner."""


@dataclass(frozen=True, slots=True)
class Overrun:
    """A corner past which lines ran by up to so much."""

    width_mm: float
    at: Point


def trim_overruns(pieces: Sequence[DrawnCurve], reach_mm: float) -> tuple[list[DrawnCurve], list[Overrun]]:
    """Open pieces, each end that crosses another within `reach_mm` of both ends cut back to where they cross.

    Ends that meet already stay as they are; of several that an end crosses it is cut back to the nearest.

    Examples
    --------
    >>> lines = [DrawnCurve(Curve.of(rows, closed=False), "0", 0) for rows in ([(0, 0), (9.2, 0)], [(9, -0.3), (9, 9)])]
    >>> trimmed, corners = trim_overruns(lines, 0.5)
    >>> [p.curve.as_rows() for p in trimmed], corners
    ([[[0.0, 0.0], [9.0, 0.0]], [[9.0, 0.0], [9.0, 9.0]]], [Overrun(width_mm=0.3, at=(9.0, 0.0))])
    """
    if not pieces:
        return [], []
    ends = np.array([p for c in pieces for p in c.curve.vertices[[0, -1], :2]])
    tree = point_tree(ends)
    met = set(tree.query_pairs(SNAP_MM, output_type="ndarray").ravel().tolist())
    pairs: Ints = tree.query_pairs(2 * reach_mm, output_type="ndarray").reshape(-1, 2)
    found: list[tuple[float, int, int, Point, float, float]] = []
    for i, j in pairs.tolist():
        if i in met or j in met or (i // 2 == j // 2 and len(pieces[i // 2].curve.segments) < 3):
            continue
        if (crossed := _crossed(pieces, i, j, reach_mm)) is not None:
            at, past_i, past_j = crossed
            found.append((past_i + past_j, i, j, at, past_i, past_j))
    cuts: dict[int, tuple[Point, float]] = {}
    corners = []
    for both_mm, i, j, at, past_i, past_j in sorted(found):
        if both_mm > SNAP_MM and i not in cuts and j not in cuts:
            cuts |= {i: (at, past_i), j: (at, past_j)}
            corners.append(Overrun(round(max(past_i, past_j), 6), at))
    return [_cut_back(p, cuts.get(2 * k), cuts.get(2 * k + 1)) for k, p in enumerate(pieces)], corners


def _crossed(pieces: Sequence[DrawnCurve], i: int, j: int, reach_mm: float) -> tuple[Point, float, float] | None:
    """Where the last lines or arcs of two ends cross, and how far each goes on from there, mm."""
    one, other = (pieces[end // 2].curve.segments[-1 if end % 2 else 0] for end in (i, j))
    tracks = [_track(segment) for segment in (one, other)]
    best: tuple[Point, float, float] | None = None
    for at in crossings(tracks[0], tracks[1]):
        past = []
        for end, segment in ((i, one), (j, other)):
            fraction, off_mm = segment.project(at)
            past_mm = segment.length_mm * (fraction if end % 2 == 0 else 1 - fraction)
            allowed_mm = min(reach_mm, OVERRUN_SHARE * pieces[end // 2].curve.length_mm)
            past.append(past_mm if off_mm <= SNAP_MM and past_mm <= allowed_mm else math.inf)
        if math.isfinite(sum(past)) and (best is None or sum(past) < best[1] + best[2]):
            best = (at[0], at[1]), past[0], past[1]
    return best


def _track(segment: Segment) -> Line | Circle:
    if segment.is_arc:
        return Circle(segment.centre, segment.radius_mm, 1)
    (x0, y0), (x1, y1) = segment.start, segment.end
    return Line(segment.start, ((x1 - x0) / segment.length_mm, (y1 - y0) / segment.length_mm))


def _cut_back(piece: DrawnCurve, start: tuple[Point, float] | None, end: tuple[Point, float] | None) -> DrawnCurve:
    if start is None and end is None:
        return piece
    from_mm = 0.0 if start is None else start[1]
    to_mm = piece.curve.length_mm - (0.0 if end is None else end[1])
    rows = piece.curve.between(from_mm, to_mm - from_mm).vertices.copy()
    for row, cut in ((0, start), (-1, end)):
        rows[row, :2] = piece.curve.vertices[row, :2] if cut is None else cut[0]
    return replace(piece, curve=Curve(rows, closed=False))


# Open lines that lie partly on closed ones: what lies on them is drawn twice, and the rest is a line of its own.

LEAST_SHARED = 10
"""A line that lies on a closed one for less than so many tolerances may just cross it."""


def trim_on_rings(
    chains: Sequence[DrawnCurve], rings: Sequence[DrawnCurve], tolerance_mm: float
) -> tuple[list[DrawnCurve], list[DrawnCurve]]:
    """The chains without the stretches that lie on rings, and those stretches.

    Examples
    --------
    >>> ring = DrawnCurve(Curve.of([(0, 0), (100, 0), (100, 60), (0, 60)]), "0", 0)
    >>> left, shared = trim_on_rings([DrawnCurve(Curve.of([(20, 60), (120, 60)], closed=False), "0", 1)], [ring], 0.1)
    >>> [p.curve.as_rows() for p in (*left, *shared)]
    [[[100.0, 60.0], [120.0, 60.0]], [[20.0, 60.0], [100.0, 60.0]]]
    """
    if not chains or not rings:
        return list(chains), []
    lines = np.array([r.curve.line() for r in rings], dtype=object)
    tree = shapely.STRtree(lines)
    left: list[DrawnCurve] = []
    shared: list[DrawnCurve] = []
    for chain in chains:
        line = chain.curve.line()
        near = np.sort(tree.query(line, predicate="dwithin", distance=tolerance_mm))
        stretches = _stretches(line, lines[near], tolerance_mm) if len(near) else []
        if not stretches:
            left.append(chain)
            continue
        scale = chain.curve.length_mm / line.length
        corners = shapely.points(np.concatenate([rings[k].curve.vertices[:, :2] for k in near.tolist()]))
        from_mm = 0.0
        for start, end in [*stretches, (line.length, line.length)]:
            start, end = (_to_corner(line, s, corners, tolerance_mm) * scale for s in (start, end))
            if start - from_mm > tolerance_mm:
                left.append(replace(chain, curve=chain.curve.between(from_mm, start - from_mm)))
            if end - start > SNAP_MM:
                shared.append(replace(chain, curve=chain.curve.between(start, end - start)))
            from_mm = end
    return left, shared


def _stretches(line: shapely.LineString, rings: Floats, tolerance_mm: float) -> list[tuple[float, float]]:
    """From where to where along a line it lies on rings, mm, in order."""
    band = shapely.union_all(shapely.buffer(rings, tolerance_mm, quad_segs=4))
    found = []
    for part in shapely.get_parts(shapely.line_merge(shapely.intersection(line, band))):
        if part.length > LEAST_SHARED * tolerance_mm:
            ends = (shapely.line_locate_point(line, shapely.Point(part.coords[k])) for k in (0, -1))
            start, end = sorted(map(float, ends))
            found.append((start, end))
    return sorted(found)


def _to_corner(line: shapely.LineString, at_mm: float, corners: Floats, tolerance_mm: float) -> float:
    """The same place along a line, or that of a ring's corner on it that is as near as the tolerance has made it."""
    point = shapely.line_interpolate_point(line, at_mm)
    nearest = corners[int(np.argmin(shapely.distance(corners, point)))]
    is_near = shapely.distance(nearest, point) <= 3 * tolerance_mm and shapely.distance(nearest, line) <= tolerance_mm
    return float(shapely.line_locate_point(line, nearest)) if is_near else at_mm


# Two lines that lie partly on each other: the stretch they share is drawn twice, and hides where they meet.


def trim_overlaps(chains: Sequence[DrawnCurve], tolerance_mm: float) -> tuple[list[DrawnCurve], list[DrawnCurve]]:
    """The chains without the stretches where the last lines of two ends overlap, and those stretches.

    Two ends overlap if each lies on the straight line that leads to the other; the later one is cut back to the
    earlier.

    Examples
    --------
    >>> lines = [DrawnCurve(Curve.of(rows, closed=False), "0", 0) for rows in ([(0, 0), (6, 0)], [(4, 0), (9, 0)])]
    >>> left, shared = trim_overlaps(lines, 0.1)
    >>> [p.curve.as_rows() for p in left]
    [[[0.0, 0.0], [6.0, 0.0]], [[6.0, 0.0], [9.0, 0.0]]]
    """
    if not chains:
        return [], []
    last = [s for c in chains for s in (c.curve.segments[0], c.curve.segments[-1])]
    ends = np.array([p for c in chains for p in c.curve.vertices[[0, -1], :2]])
    tree = shapely.STRtree([shapely.LineString([s.start, s.end]) for s in last])
    end, line = tree.query(shapely.points(ends), predicate="dwithin", distance=tolerance_mm)
    lies_on = set(zip(end.tolist(), line.tolist(), strict=True))
    rows = [c.curve.vertices.copy() for c in chains]
    shared: list[DrawnCurve] = []
    taken: set[int] = set()
    for a, b in sorted(lies_on):
        each_on_the_other = a < b and (b, a) in lies_on and not (last[a].is_arc or last[b].is_arc)
        neighbours = a // 2 == b // 2 and len(chains[a // 2].curve.segments) < 3
        apart = np.hypot(*(ends[a] - ends[b])) > SNAP_MM
        if not each_on_the_other or neighbours or not apart or {a, b} & taken:
            continue
        for n in (a, b):  # the one line of a chain is both its first and its last
            taken |= {n, n ^ 1} if len(chains[n // 2].curve.segments) == 1 else {n}
        shared.append(replace(chains[b // 2], curve=Curve.of([ends[a], ends[b]], closed=False)))
        rows[b // 2][-(b % 2), :2] = ends[a]
    left = [replace(c, curve=Curve(r, closed=False)) for r, c in zip(rows, chains, strict=True)]
    return left, shared
