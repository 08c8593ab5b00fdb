"""Which areas straight moves cross, by whole arrays: the same as `crossed_areas` says compiled, where moves are few."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from kerfwise.arrays import Bools, Floats, Ints

AT_ONCE = 1 << 21
"""Moves times areas, or times edges, that are looked at together."""


class Areas(NamedTuple):
    """Areas as edges: those of area a are `edges[edge_from[a]:edge_from[a + 1]]`, each x, y, x, y; `boxes` (a, 4)."""

    boxes: Floats
    edge_from: Ints
    edges: Floats


def crossed_by_arrays(leave: Floats, reach: Floats, owner: Ints, areas: Areas, near: Ints, late: Bools) -> Ints:
    """Rows of leave, reach and area of all moves that cross one of the areas `near`, (3, rows)."""
    boxes, asked = areas.boxes[near], ~late[owner][:, near]
    step = max(1, AT_ONCE // max(1, len(reach) * len(near)))
    found = [np.empty((3, 0), dtype=np.int64)]
    for at in range(0, len(leave), step):
        begin = leave[at : at + step, None, :]
        low, high = np.minimum(begin, reach)[:, :, None, :], np.maximum(begin, reach)[:, :, None, :]
        beside = (low > boxes[:, 2:]).any(axis=3) | (high < boxes[:, :2]).any(axis=3)
        i, j, k = np.nonzero(asked & ~beside)
        rows = np.stack([i + at, j, near[k]])
        found.append(rows[:, _crosses(leave[rows[0]], reach[rows[1]], areas, rows[2])])
    return np.concatenate(found, axis=1)


def _crosses(p: Floats, q: Floats, areas: Areas, area: Ints) -> Bools:
    """Whether each move from p to q, (k, 2), meets its area, whose box it overlaps."""
    d, end = q - p, np.ones(len(p))
    point = (d == 0.0).all(axis=1)
    d[point], end[point] = (1.0, 0.0), 0.0
    left, low, right, high = areas.boxes[area].T
    aside = d[:, 0] * ((low + high) / 2 - p[:, 1]) - d[:, 1] * ((left + right) / 2 - p[:, 0])
    meets: Bools = np.abs(aside) <= np.abs(d[:, 0]) * (high - low) / 2 + np.abs(d[:, 1]) * (right - left) / 2
    rows = np.flatnonzero(meets)
    rows = rows[np.argsort(area[rows], kind="stable")]
    for same in np.split(rows, np.flatnonzero(np.diff(area[rows])) + 1):
        if len(same):
            a = area[same[0]]
            edges = areas.edges[areas.edge_from[a] : areas.edge_from[a + 1]]
            step = max(1, AT_ONCE // max(1, len(edges)))
            for at in range(0, len(same), step):
                some = same[at : at + step]
                meets[some] = _meets(p[some], d[some], end[some], edges)
    return meets


def _meets(p: Floats, d: Floats, end: Floats, edges: Floats) -> Bools:
    """Whether an edge cuts the move, or edges cut the line beyond it an odd number of times."""
    (px, py), (dx, dy) = p.T[:, :, None], d.T[:, :, None]
    ux, uy, vx, vy = edges.T[:, None, :]
    u = dx * (uy - py) - dy * (ux - px)
    v = dx * (vy - py) - dy * (vx - px)
    cuts = (u > 0) != (v > 0)
    share = u / np.where(cuts, u - v, 1.0)
    along = (dx * (ux + share * (vx - ux) - px) + dy * (uy + share * (vy - uy) - py)) / (dx * dx + dy * dy)
    beyond = along > end[:, None]
    inside = (cuts & beyond).sum(axis=1) % 2 == 1
    whole: Bools = inside | (cuts & ~beyond & (along >= 0)).any(axis=1)
    return whole
