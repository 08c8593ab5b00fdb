"""The largest rectangle along a side of a sheet that no block reaches into."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kerfwise.encoder.cut import Side
from kerfwise.encoder.geometry.segment import Box, Point


def saved(sheet: Box, blocks: Sequence[Box], side: Side, half_kerf_mm: float) -> tuple[Box, tuple[Point, ...]]:
    """The rectangle, and the line of the torch's centre round it, from one edge of the sheet to another.

    The line may lie on the border of a block, and the rectangle begins half a kerf beside the line. It is straight
    where the rectangle is as long as the side, else it has one corner or two.

    Examples
    --------
    >>> saved((0, 0, 1000, 400), [(0, 0, 600, 400), (600, 0, 900, 100)], "right", 0.5)
    ((600.5, 100.5, 1000, 400.0), ((600.0, 400.0), (600.0, 100.0), (1000, 100.0)))
    """
    flip = side in ("left", "bottom")
    along = 1 if side in ("left", "right") else 0
    across = 1 - along
    low, high, deepest = sheet[along], sheet[along + 2], sheet[across + 2] - sheet[across]
    edge = sheet[across] if flip else sheet[across + 2]
    begins = np.clip([b[along] for b in blocks], low, high)
    ends = np.clip([b[along + 2] for b in blocks], low, high)
    free = np.array([b[across] - edge if flip else edge - b[across + 2] for b in blocks])
    cuts = np.unique(np.concatenate([[low, high], begins, ends]))
    depth = np.full(len(cuts) - 1, deepest)
    for a, b, room in zip(begins.tolist(), ends.tolist(), np.clip(free, 0.0, deepest).tolist(), strict=True):
        within = (cuts[:-1] >= a) & (cuts[:-1] < b)
        depth[within] = np.minimum(depth[within], room)
    best = (-1.0, 0, 0, 0.0)
    for first in range(len(depth)):
        rooms = np.minimum.accumulate(depth[first:])
        areas = rooms * (cuts[first + 1 :] - cuts[first])
        k = int(np.argmax(areas))
        if areas[k] > best[0] * (1 + 1e-9):
            best = (float(areas[k]), first, first + k + 1, float(rooms[k]))
    a, b, room = float(cuts[best[1]]), float(cuts[best[2]]), best[3]
    inner = edge + room if flip else edge - room
    ways = [*([(edge, b)] if b < high else []), (inner, b), (inner, a), *([(edge, a)] if a > low else [])]
    line = tuple((d, t) if along else (t, d) for d, t in ways)
    near = inner - half_kerf_mm if flip else inner + half_kerf_mm
    t0, t1 = a + half_kerf_mm * (a > low), b - half_kerf_mm * (b < high)
    d0, d1 = min(near, edge), max(near, edge)
    return ((d0, t0, d1, t1) if along else (t0, d0, t1, d1)), line
