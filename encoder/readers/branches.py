"""Places where more than two lines meet: lines drawn twice, and parts that share a line."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Sequence

import numpy as np
import shapely

from kerfwise.arrays import Ints
from kerfwise.encoder.geometry.curve import Curve

from .trace import Step, Trail


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
