"""The pieces that scrap lines cut the skeleton into, and which lines have a piece between them.

The skeleton is the sheet less every part and the kerf round it. The lines, each as wide as the kerf, divide it. Two
lines are beside each other where both bound the same piece: as long as one of them is uncut, the metal at the other
holds to what lies across it. The frame is the largest piece: what is cut off from it is loose.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from kerfwise.arrays import Bools, Ints
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.validate.scrap import OVERSHOOT_MM

_TOUCH_MM = 0.02
_SAME_SHARE = 1e-3
"""Pieces that differ by less than this share of the largest are equally large."""


@dataclass(frozen=True, eq=False, slots=True)
class Skeleton:
    """Which of n contours are scrap lines that bound the frame, (n,), and the pairs beside each other, (k, 2).

    Each pair is listed both ways round.
    """

    framed: Bools
    beside: Ints


def skeleton_of(nest: Nest, kerf_mm: float) -> Skeleton:
    """What the scrap lines of a nest make of its skeleton.

    Examples
    --------
    Three lines across a strip: the piece right of the last is the largest.

    >>> from kerfwise.encoder.by_hand import nest
    >>> found = skeleton_of(nest(1000, 100, scrap=[[(x, 0), (x, 100)] for x in (200, 400, 600)]), 1.5)
    >>> found.framed.tolist(), found.beside.tolist()
    ([False, False, True], [[0, 1], [1, 0], [1, 2], [2, 1]])
    """
    n = len(nest.contours)
    framed, none = np.full(n, False), np.empty((0, 2), dtype=np.int64)
    if not nest.scrap:
        return Skeleton(framed, none)
    kerfs = shapely.buffer(np.array([c.line for c in nest.scrap], dtype=object), kerf_mm / 2, quad_segs=4)
    gone = [shapely.buffer(part.outer.polygon, kerf_mm, quad_segs=4) for part in nest.parts]
    metal = shapely.difference(shapely.make_valid(nest.sheet.polygon), shapely.union_all([*gone, *kerfs]))
    pieces = np.array([p for p in shapely.get_parts(metal) if p.area > kerf_mm**2], dtype=object)
    if not len(pieces):
        return Skeleton(framed, none)
    reach = shapely.buffer(kerfs, _TOUCH_MM, quad_segs=4)
    line, piece = shapely.STRtree(pieces).query(reach, predicate="intersects")
    shared_mm = shapely.length(shapely.intersection(shapely.boundary(pieces[piece]), reach[line]))
    length_mm = np.array([c.curve.length_mm for c in nest.scrap])
    bounds = shared_mm > np.minimum(2 * (OVERSHOOT_MM + kerf_mm), length_mm[line] / 2)
    line, piece = line[bounds], piece[bounds]
    first = n - len(nest.scrap)
    framed[first + line[piece == _frame(pieces)]] = True
    touches = np.zeros((len(nest.scrap), len(pieces)), dtype=bool)
    touches[line, piece] = True
    shared = touches.astype(np.int64) @ touches.T
    np.fill_diagonal(shared, 0)
    return Skeleton(framed, first + np.argwhere(shared > 0).astype(np.int64))


def _frame(pieces: np.ndarray) -> int:
    """The number of the largest piece; of equal ones the lowest, then the leftmost."""
    area = shapely.area(pieces)
    large = np.flatnonzero(area >= area.max() * (1 - _SAME_SHARE))
    x0, y0 = np.round(shapely.bounds(pieces[large])[:, :2]).T
    return int(large[np.lexsort((x0, y0))[0]])
