"""Loose lines and arcs become rings: the outlines that CAD exports as a soup of segments."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.components import weak_components
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point

from .branches import faces, twins
from .drawing import DrawnCurve
from .limits import SNAP_MM
from .nodes import meeting_points
from .overdrawn import trimmed
from .trace import Trail, trace


@dataclass(frozen=True, slots=True)
class Gap:
    """Two ends that were taken to meet, this far apart, at this point."""

    width_mm: float
    at: Point


@dataclass(frozen=True, slots=True)
class Joined:
    """Rings and open chains, each in the order of the file.

    `repeats` are lines drawn over others, `specks` pieces of no length, `gaps` the distances closed.
    """

    rings: tuple[DrawnCurve, ...]
    chains: tuple[DrawnCurve, ...]
    repeats: tuple[DrawnCurve, ...] = ()
    specks: tuple[DrawnCurve, ...] = ()
    gaps: tuple[Gap, ...] = ()


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
        Wider gaps, up to this, are closed by a straight line.
    """
    specks = tuple(p for p in pieces if p.curve.length_mm <= SNAP_MM)
    sound = [p for p in pieces if p.curve.length_mm > SNAP_MM]
    rings = [p for p in sound if p.curve.closed]
    loose = [p for p in sound if not p.curve.closed]
    chains: list[DrawnCurve] = []
    gaps: list[Gap] = []
    if loose:
        ends = np.concatenate([p.curve.vertices[[0, -1], :2] for p in loose])
        lengths = np.array([p.curve.length_mm for p in loose])
        nodes = meeting_points(ends, lengths, max(tolerance_mm, bridge_mm)).reshape(-1, 2)
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
    open_chains, shared = trimmed(bare, tolerance_mm)
    if shared and _length(open_chains) < _length(bare) - SNAP_MM:
        again = join(open_chains, tolerance_mm, bridge_mm)
        rings, open_chains = [*rings, *again.rings], list(again.chains)
        repeats, gaps = [*repeats, *again.repeats], [*gaps, *again.gaps]
    return Joined(_in_order(rings), _in_order(open_chains), _in_order([*repeats, *shared]), specks, tuple(gaps))


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
