"""Two lines that lie partly on each other: the stretch they share is drawn twice, and hides where they meet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely

from kerfwise.encoder.geometry.curve import Curve

from .drawing import DrawnCurve
from .limits import SNAP_MM


def trimmed(chains: Sequence[DrawnCurve], tolerance_mm: float) -> tuple[list[DrawnCurve], list[DrawnCurve]]:
    """The chains without the stretches where the last lines of two ends overlap, and those stretches.

    Two ends overlap if each lies on the straight line that leads to the other; the later one is cut back to the
    earlier.

    Examples
    --------
    >>> lines = [DrawnCurve(Curve.of(rows, closed=False), "0", 0) for rows in ([(0, 0), (6, 0)], [(4, 0), (9, 0)])]
    >>> left, shared = trimmed(lines, 0.1)
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
