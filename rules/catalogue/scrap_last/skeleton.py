"""The pieces that scrap lines cut the skeleton into, and which lines have a piece between them: facts of this rule.

The skeleton is the sheet less every part and the kerf round it. Metal narrower than a kerf holds nothing and is no
piece. The lines, each as wide as the kerf, divide the rest. Two lines are beside each other where both bound the
same piece: as long as one of them is uncut, the metal at the other holds to what lies across it. The frame is the
largest piece that the lines leave of the largest piece that the parts leave: what is cut off from it is loose.
"""

from __future__ import annotations

import numpy as np
import shapely

from kerfwise.arrays import Bools, Ints
from kerfwise.encoder.facts.facts import Column, FactOptions
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.scrap import carrying, largest, pieces_of, skeleton
from kerfwise.encoder.validate import OVERSHOOT_MM

_TOUCH_MM = 0.02


def skeleton_of(nest: Nest, options: FactOptions) -> dict[str, Column]:
    """Which of n contours are scrap lines at the frame or at no piece, (n,), and the pairs beside each other, (k, 2).

    Each pair is listed both ways round.

    Examples
    --------
    Three lines across a strip: the piece right of the last is the largest.

    >>> from kerfwise.rules.case import nest
    >>> strip = nest(1000, 100, scrap=[[(x, 0), (x, 100)] for x in (200, 400, 600)])
    >>> [column.values.tolist() for column in skeleton_of(strip, FactOptions()).values()]
    [[False, False, True], [[0, 1], [1, 0], [1, 2], [2, 1]]]
    """
    n, kerf_mm = len(nest.contours), options.kerf_mm
    framed, none = np.full(n, False), np.empty((0, 2), dtype=np.int64)
    if not nest.scrap:
        return _columns(framed, none)
    kerfs = shapely.buffer(np.array([c.line for c in nest.scrap], dtype=object), kerf_mm / 2, quad_segs=4)
    whole = skeleton(nest.sheet.polygon, [part.outer.polygon for part in nest.parts], kerf_mm)
    uncut = pieces_of(carrying(whole, kerf_mm), kerf_mm)
    pieces = pieces_of(shapely.difference(shapely.union_all(uncut), shapely.union_all(kerfs)), kerf_mm)
    if not len(pieces):
        return _columns(framed, none)
    of_largest = np.flatnonzero(shapely.intersects(uncut[largest(uncut)], shapely.point_on_surface(pieces)))
    frame = of_largest[largest(pieces[of_largest])] if len(of_largest) else -1
    reach = shapely.buffer(kerfs, _TOUCH_MM, quad_segs=4)
    line, piece = shapely.STRtree(pieces).query(reach, predicate="intersects")
    shared_mm = shapely.length(shapely.intersection(shapely.boundary(pieces[piece]), reach[line]))
    length_mm = np.array([c.curve.length_mm for c in nest.scrap])
    bounds = shared_mm > np.minimum(2 * (OVERSHOOT_MM + kerf_mm), length_mm[line] / 2)
    line, piece = line[bounds], piece[bounds]
    first = n - len(nest.scrap)
    framed[first + line[piece == frame]] = True
    framed[first + np.setdiff1d(np.arange(len(nest.scrap)), line)] = True
    touches = np.zeros((len(nest.scrap), len(pieces)), dtype=bool)
    touches[line, piece] = True
    shared = touches.astype(np.int64) @ touches.T
    np.fill_diagonal(shared, 0)
    return _columns(framed, first + np.argwhere(shared > 0).astype(np.int64))


def _columns(framed: Bools, beside: Ints) -> dict[str, Column]:
    return {"scrap_framed": Column(framed, kind="scrap"), "scrap_beside": Column(beside, pairs=True, kind="scrap")}
