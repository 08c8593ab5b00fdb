"""Loose lines and arcs become rings: the outlines that CAD exports as a soup of segments."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely

from kerfwise.arrays import Floats, Ints, point_tree
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.graphs import weak_components

from .drawing import SNAP_MM, DrawnCurve
from .trim import Overrun, trim_on_rings, trim_overlaps, trim_overruns


@dataclass(frozen=True, slots=True)
class Gap:
    """Two ends that were taken to meet, this far apart, at this point."""

    width_mm: float
    at: Point


@dataclass(frozen=True, slots=True)
class Joined:
    """Rings and open chains, each in the order of the file.

    `repeats` are lines drawn over others, `specks` pieces of no length, `gaps` the distances closed, `overruns` the
    corners past which lines ran.
    """

    rings: tuple[DrawnCurve, ...]
    chains: tuple[DrawnCurve, ...]
    repeats: tuple[DrawnCurve, ...] = ()
    specks: tuple[DrawnCurve, ...] = ()
    gaps: tuple[Gap, ...] = ()
    overruns: tuple[Overrun, ...] = ()


def join(pieces: Sequence[DrawnCurve], tolerance_mm: float, bridge_mm: float = 0.0) -> Joined:
    """Rings of the pieces whose ends meet; closed pieces are rings already. Near-linear in their number.

    Where more than two ends meet, a line goes on into the one drawn next to it in the file. If that leaves lines
    over, the faces between the lines are taken instead: two parts drawn with one line between them.

    Parameters
    ----------
    pieces
        Open and closed curves in the order of the file.
    tolerance_mm
        Ends up to this far apart meet in their middle.
    bridge_mm
        Wider gaps, up to this, are closed by a straight line, and longer ends past corners are cut off.
    """
    specks = tuple(p for p in pieces if p.curve.length_mm <= SNAP_MM)
    sound = [p for p in pieces if p.curve.length_mm > SNAP_MM]
    rings = [p for p in sound if p.curve.closed]
    loose, overruns = trim_overruns([p for p in sound if not p.curve.closed], max(tolerance_mm, bridge_mm))
    chains: list[DrawnCurve] = []
    gaps: list[Gap] = []
    if loose:
        ends = np.concatenate([p.curve.vertices[[0, -1], :2] for p in loose])
        lengths = np.array([p.curve.length_mm for p in loose])
        nodes = endpoint_clusters(ends, lengths, max(tolerance_mm, bridge_mm)).reshape(-1, 2)
        curves = [p.curve for p in loose]
        branching = (np.bincount(nodes.ravel())[nodes].max(axis=1) > 2).tolist()
        for group in _groups(nodes):
            for trail in _trails(group, any(branching[k] for k in group), curves, nodes, tolerance_mm):
                piece, wide = _linked(trail, loose, tolerance_mm)
                (rings if trail.closed else chains).append(piece)
                gaps.extend(wide)
    covered = _drawn_over(chains, rings, tolerance_mm)
    repeats = [c for c, over in zip(chains, covered, strict=True) if over]
    bare = [c for c, over in zip(chains, covered, strict=True) if not over]
    bare, on_rings = trim_on_rings(bare, rings, tolerance_mm)
    repeats += on_rings
    open_chains, shared = trim_overlaps(bare, tolerance_mm)
    if shared and _length(open_chains) < _length(bare) - SNAP_MM:
        again = join(open_chains, tolerance_mm, bridge_mm)
        rings, open_chains = [*rings, *again.rings], list(again.chains)
        repeats, gaps = [*repeats, *again.repeats], [*gaps, *again.gaps]
    repeats = [*repeats, *shared]
    return Joined(_in_order(rings), _in_order(open_chains), _in_order(repeats), specks, tuple(gaps), tuple(overruns))


def _length(pieces: Iterable[DrawnCurve]) -> float:
    return sum(p.curve.length_mm for p in pieces)


def _in_order(pieces: Iterable[DrawnCurve]) -> tuple[DrawnCurve, ...]:
    return tuple(sorted(pieces, key=lambda p: p.order))


def _groups(nodes: Ints) -> list[list[int]]:
    """The pieces that hang together, group by group in the order of the file."""
    size = int(nodes.max()) + 1
    label = weak_components(size, nodes)[nodes[:, 0]]
    order = np.argsort(label, kind="stable")
    split = np.split(order, np.flatnonzero(np.diff(label[order])) + 1)
    return sorted((group.tolist() for group in split), key=lambda g: g[0])


def _trails(
    group: list[int], branching: bool, curves: Sequence[Curve], nodes: Ints, tolerance_mm: float
) -> list[Trail]:
    """The rings and chains of one group, by the order of the file or, if that leaves lines over, by its faces."""
    if not branching and len(group) != 2:  # two pieces may be one line drawn twice
        return trace(group, nodes, {k: k for k in group})
    twin = twins(group, curves, nodes, tolerance_mm)
    drawn = trace(group, nodes, twin)
    if not _left_over(drawn, twin, curves):
        return drawn
    by_faces = faces(sorted(set(twin.values())), curves, nodes)
    return min((drawn, by_faces), key=lambda trails: _left_over(trails, twin, curves))


def _left_over(trails: Sequence[Trail], twin: dict[int, int], curves: Sequence[Curve]) -> float:
    """Length of the lines that are in no ring, mm; those drawn twice count once."""
    used = {twin[k] for t in trails if t.closed for k, _ in t.steps}
    return round(sum(curves[k].length_mm for k in sorted(set(twin.values()) - used)), 6)


def _linked(trail: Trail, loose: Sequence[DrawnCurve], tolerance_mm: float) -> tuple[DrawnCurve, list[Gap]]:
    """One piece of the trail's pieces, and the gaps closed on the way."""
    curves = [loose[k].curve if forward else loose[k].curve.reversed() for k, forward in trail.steps]
    rows = [_halved(c.vertices) for c in curves]
    gaps = []
    for k in range(0 if trail.closed else 1, len(rows)):
        before, after = rows[k - 1], rows[k]
        start, end = before[-1, :2].copy(), after[0, :2].copy()
        width, (x, y) = float(np.hypot(*(end - start))), (start + end).tolist()
        if width > SNAP_MM:
            gaps.append(Gap(width, (x / 2, y / 2)))
        if width > tolerance_mm:
            rows[k - 1] = np.concatenate([before, [[*end, 0.0]]])
        else:
            before[-1, :2] = after[0, :2] = (start + end) / 2
    kept = [r[:-1] for r in rows] if trail.closed else [*(r[:-1] for r in rows[:-1]), rows[-1]]
    first = min((loose[k] for k, _ in trail.steps), key=lambda p: p.order)
    return replace(first, curve=Curve(np.concatenate(kept), trail.closed)), gaps


def _halved(vertices: Floats) -> Floats:
    """A copy in which no arc exceeds a half-circle: moving an end of a longer one a little would bloat it."""
    if (np.abs(vertices[:-1, 2]) <= 1).all():
        return np.concatenate([vertices[:-1], vertices[-1:] * [1.0, 1.0, 0.0]])
    rows: list[tuple[float, float, float]] = []
    for segment in Curve(vertices, closed=False).segments:
        halves = (segment.between(0, 0.5), segment.between(0.5, 1)) if abs(segment.bulge) > 1 else (segment,)
        rows += [(*h.start, h.bulge) for h in halves]
    return np.array([*rows, (*vertices[-1, :2], 0.0)])


def _drawn_over(chains: Sequence[DrawnCurve], rings: Iterable[DrawnCurve], tolerance_mm: float) -> list[bool]:
    """Which chains lie wholly on lines of the rings."""
    lines = [r.curve.line() for r in rings]
    if not chains or not lines:
        return [False] * len(chains)
    tree = shapely.STRtree(lines)
    covered = []
    for chain in chains:
        line = chain.curve.line()
        near = [lines[k] for k in sorted(tree.query(line, predicate="dwithin", distance=tolerance_mm).tolist())]
        band = shapely.union_all([shapely.buffer(x, tolerance_mm, quad_segs=4) for x in near])
        covered.append(bool(near) and bool(shapely.covered_by(line, band)))
    return covered


# Where the ends of loose lines meet.


def endpoint_clusters(ends: Floats, lengths_mm: Floats, tolerance_mm: float) -> Ints:
    """The number of the meeting point of every end.

    Ends within `SNAP_MM` meet, however many. An end still alone then meets the nearest other lone end within
    `tolerance_mm`, closest pairs first. The two ends of one piece may meet if the piece is long beside the gap. `ends`:
    array (2 n, 2): start and end of piece k in rows 2 k and 2 k + 1, mm. `lengths_mm`: array (n,): the length of each
    piece. `tolerance_mm`: widest gap between two ends that meet.

    Examples
    --------
    >>> ends = np.array([[0, 0], [10, 0], [10.05, 0], [20, 0]])
    >>> endpoint_clusters(ends, np.array([10.0, 9.95]), 0.1).tolist()
    [0, 1, 1, 2]
    """
    points = _clusters(ends, min(SNAP_MM, tolerance_mm))
    lone = np.flatnonzero(np.bincount(points)[points] == 1)
    if len(lone) > 1 and tolerance_mm > SNAP_MM:
        pairs = lone[point_tree(ends[lone]).query_pairs(tolerance_mm, output_type="ndarray")].reshape(-1, 2)
        pairs.sort(axis=1)
        gaps = np.hypot(*(ends[pairs[:, 0]] - ends[pairs[:, 1]]).T)
        own = pairs[:, 0] // 2 == pairs[:, 1] // 2
        keep = ~own | (lengths_mm[pairs[:, 0] // 2] > 4 * gaps)
        taken: set[int] = set()
        for k in np.lexsort((pairs[:, 1], pairs[:, 0], gaps)).tolist():
            i, j = pairs[k].tolist()
            if keep[k] and i not in taken and j not in taken:
                taken |= {i, j}
                points[j] = points[i]
    return np.unique(points, return_inverse=True)[1].astype(np.int64)


def _clusters(ends: Floats, within_mm: float) -> Ints:
    distinct, index = np.unique(ends, axis=0, return_inverse=True)
    pairs = point_tree(distinct).query_pairs(within_mm, output_type="ndarray").reshape(-1, 2)
    return weak_components(len(distinct), pairs)[index.ravel()]


# Following loose pieces from meeting point to meeting point.

Step = tuple[int, bool]
"""A piece's number and whether it is followed as drawn."""


@dataclass(frozen=True, slots=True)
class Trail:
    """Pieces that follow each other, back to the start if closed."""

    steps: tuple[Step, ...]
    closed: bool


def trace(group: Sequence[int], nodes: Ints, twin: Mapping[int, int]) -> list[Trail]:
    """Every piece of the group in one ring or chain.

    `group`: numbers of pieces, in the order of the file. `nodes`: array (n, 2): the meeting points at the start and the
    end of each piece. `twin`: piece → the first piece that runs along the same line; a trail never turns back along
    one.

    Examples
    --------
    >>> import numpy as np
    >>> trace([0, 1, 2], np.array([[0, 1], [2, 1], [2, 0]]), {0: 0, 1: 1, 2: 2})
    [Trail(steps=((0, True), (1, False), (2, True)), closed=True)]
    """
    at: dict[int, list[int]] = defaultdict(list)
    for k in group:
        for node in nodes[k].tolist():
            at[node].append(k)
    free, trails = dict.fromkeys(group), []
    loose_ends = [k for k in group if any(len(at[n]) == 1 for n in nodes[k].tolist())]
    for seed in [*loose_ends, *group]:
        if seed in free:
            rings, chain = _walk(seed, at, free, nodes, twin)
            trails += [Trail(ring, closed=True) for ring in rings]
            if chain:
                trails.append(Trail(chain, closed=False))
    return trails


def _walk(
    seed: int, at: Mapping[int, Sequence[int]], free: dict[int, None], nodes: Ints, twin: Mapping[int, int]
) -> tuple[list[tuple[Step, ...]], tuple[Step, ...]]:
    """The rings that the way from `seed` closes, and what is left of the way when it ends.

    Whenever the way comes back to a point it has passed, the loop is a ring of its own: contours that share a
    corner come apart there.
    """
    start, end = nodes[seed].tolist()
    forward = len(at[start]) == 1 or len(at[end]) > 1
    here, there = (start, end) if forward else (end, start)
    passed, steps = {here: 0}, [(seed, forward)]
    rings: list[tuple[Step, ...]] = []
    visited = [here]
    del free[seed]
    while True:
        if there in passed:
            loop = passed[there]
            rings.append(tuple(steps[loop:]))
            for node in visited[loop + 1 :]:
                del passed[node]
            del steps[loop:], visited[loop + 1 :]
        else:
            passed[there] = len(steps)
            visited.append(there)
        last = steps[-1][0] if steps else rings[-1][-1][0]
        onward = [k for k in at[there] if k in free and twin[k] != twin[last]]
        if not onward or (not steps and rings):
            return rings, tuple(steps)
        chosen = min(onward, key=lambda k: (abs(k - last), k < last))
        del free[chosen]
        forward = int(nodes[chosen][0]) == there
        steps.append((chosen, forward))
        there = int(nodes[chosen][1 if forward else 0])


def face_rings(pieces: Sequence[DrawnCurve], tolerance_mm: float) -> list[tuple[DrawnCurve, tuple[DrawnCurve, ...]]]:
    """The faces between open pieces that meet at their ends, each with the pieces round it.

    Examples
    --------
    >>> rows = [(0, 0), (9, 0), (9, 9)], [(9, 9), (0, 9), (0, 0)], [(0, 0), (9, 9)]
    >>> pieces = [DrawnCurve(Curve.of(row, closed=False), "0", k) for k, row in enumerate(rows)]
    >>> [abs(ring.curve.signed_area_mm2) for ring, _ in face_rings(pieces, 0.1)]
    [40.5, 40.5]
    """
    if not pieces:
        return []
    ends = np.concatenate([p.curve.vertices[[0, -1], :2] for p in pieces])
    nodes = _clusters(ends, tolerance_mm).astype(np.int64).reshape(-1, 2)
    curves, every = [p.curve for p in pieces], list(range(len(pieces)))
    single = sorted(set(twins(every, curves, nodes, tolerance_mm).values()))
    trails = [trail for trail in faces(single, curves, nodes) if trail.closed]
    return [(_linked(t, pieces, tolerance_mm)[0], tuple(pieces[k] for k, _ in t.steps)) for t in trails]


# Places where more than two lines meet: lines drawn twice, and parts that share a line.


def twins(group: Sequence[int], curves: Sequence[Curve], nodes: Ints, tolerance_mm: float) -> dict[int, int]:
    """Piece → the first piece of the group that runs along the same line, itself if there is none."""
    seen: dict[tuple[int, int], list[int]] = defaultdict(list)
    twin = {}
    for k in group:
        a, b = nodes[k].tolist()
        alike = seen[min(a, b), max(a, b)]
        twin[k] = next((j for j in alike if _same_line(curves[j], curves[k], tolerance_mm)), k)
        if twin[k] == k:
            alike.append(k)
    return twin


def _same_line(one: Curve, other: Curve, tolerance_mm: float) -> bool:
    middles = (c.point_at(c.length_mm / 2) for c in (one, other))
    if math.dist(*middles) > tolerance_mm + 0.01 * one.length_mm:
        return False
    return bool(shapely.hausdorff_distance(one.line(), other.line(), densify=0.2) <= tolerance_mm)


def faces(group: Sequence[int], curves: Sequence[Curve], nodes: Ints) -> list[Trail]:
    """A ring around every face between the lines; lines beside no face are chains of their own.

    `group` holds no two pieces along the same line. A line between two faces is in both rings.
    """
    at: dict[int, list[tuple[float, float]]] = defaultdict(list)
    for k in group:
        for node, point in zip(nodes[k].tolist(), curves[k].vertices[[0, -1], :2].tolist(), strict=True):
            at[node].append((point[0], point[1]))
    corner = {node: np.mean(points, axis=0) for node, points in at.items()}
    lines, step_at = [], {}
    for k in group:
        points = curves[k].flatten().copy()
        points[0], points[-1] = (corner[n] for n in nodes[k].tolist())
        lines.append(shapely.LineString(points))
        rows = [tuple(p) for p in points.tolist()]
        step_at[rows[0], rows[1]] = (k, True), len(rows) - 1
        step_at[rows[-1], rows[-2]] = (k, False), len(rows) - 1
    trails = []
    for face in shapely.polygonize(lines).geoms:
        steps: list[Step] = []
        rows, here = [tuple(p) for p in face.exterior.coords], 0
        while here < len(rows) - 1:
            step, length = step_at[rows[here], rows[here + 1]]
            steps.append(step)
            here += length
        trails.append(Trail(tuple(steps), closed=True))
    used = {k for t in trails for k, _ in t.steps}
    trails += [Trail(((k, True),), closed=False) for k in group if k not in used]
    return sorted(trails, key=lambda t: min(k for k, _ in t.steps))
