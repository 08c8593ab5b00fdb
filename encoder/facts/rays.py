"""What the outward normal meets first from each cell of the boundaries."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import shapely

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.encoder.ranges import laid_out

from .cells import Cells

CONTACT_MM = 0.05
"""Outlines that overlap by less than this touch; a contour's own curve nearer than this is the cell's own place."""
CELLS_PER_BOX = 8
BOXES_AT_ONCE = 20_000
PAIRS_AT_ONCE = 1 << 18
"""Pairs of a cell and a piece that are intersected in one go, which takes a hundred bytes of memory for each."""
NOTHING = -1


@dataclass(frozen=True, eq=False, slots=True)
class Obstacles:
    """Straight pieces (m, 2) that rays may meet; `owner` (m,) is what a hit is reported as."""

    start: Floats
    end: Floats
    owner: Ints


def first_hits(cells: Cells, obstacles: Obstacles, reach_mm: float) -> tuple[Ints, Floats]:
    """The owner of the first obstacle that each cell's outward normal meets within `reach_mm`, and how far it is.

    NOTHING and inf where there is none. A few cells in a row share one search rectangle in an STRtree of the
    obstacles, and what it finds is intersected with all their rays in one array operation: near-linear.
    """
    k = len(cells.contour)
    owner, distance_mm = np.full(k, NOTHING), np.full(k, np.inf)
    tree = shapely.STRtree(shapely.linestrings(np.stack([obstacles.start, obstacles.end], axis=1)))
    first, count = _boxes_of(cells.contour)
    for chunk in range(0, len(first), BOXES_AT_ONCE):
        begin, cells_in = first[chunk : chunk + BOXES_AT_ONCE], count[chunk : chunk + BOXES_AT_ONCE]
        all_in = slice(begin[0], begin[-1] + cells_in[-1])
        point, normal = cells.point[all_in], cells.normal[all_in]
        ends = np.stack([point - CONTACT_MM * normal, point + reach_mm * normal])
        x0, y0 = np.minimum.reduceat(ends.min(axis=0), begin - begin[0]).T
        x1, y1 = np.maximum.reduceat(ends.max(axis=0), begin - begin[0]).T
        box, piece = tree.query(shapely.box(x0, y0, x1, y1))
        for some in _at_once(box, cells_in):
            cell = laid_out(begin[box[some]], cells_in[box[some]])
            pieces = np.repeat(piece[some], cells_in[box[some]])
            met, away_mm = _crossings(cells, obstacles, cell, pieces, reach_mm)
            cell, pieces = cell[met], pieces[met]
            np.minimum.at(distance_mm, cell, away_mm)
            nearest = away_mm == distance_mm[cell]
            np.maximum.at(owner, cell[nearest], obstacles.owner[pieces[nearest]])
    return owner, np.maximum(distance_mm, 0.0)


def _at_once(box: Ints, cells_in: Ints) -> Iterator[slice]:
    """The rows of some whole boxes, ascending, that make no more pairs than PAIRS_AT_ONCE, but for a single box."""
    first = np.flatnonzero(np.diff(box, prepend=-1))
    pairs = np.diff(first, append=len(box)) * cells_in[box[first]]
    begin, so_many = 0, 0
    for row, more in zip(first.tolist(), pairs.tolist(), strict=True):
        if so_many and so_many + more > PAIRS_AT_ONCE:
            yield slice(begin, row)
            begin, so_many = row, 0
        so_many += more
    yield slice(begin, len(box))


def _boxes_of(contour: Ints) -> tuple[Ints, Ints]:
    """First cell and number of cells of each search box: CELLS_PER_BOX in a row, never of two contours."""
    new = np.flatnonzero(np.diff(contour, prepend=-1))
    place = np.arange(len(contour)) - np.repeat(new, np.diff(new, append=len(contour)))
    first = np.flatnonzero(place % CELLS_PER_BOX == 0)
    return first, np.diff(first, append=len(contour))


def _crossings(cells: Cells, obstacles: Obstacles, cell: Ints, piece: Ints, reach_mm: float) -> tuple[Bools, Floats]:
    """Which of the (cell, piece) pairs meet, and the distances along the normal of those that do."""
    normal, start = cells.normal.take(cell, axis=0), obstacles.start.take(piece, axis=0)
    step, offset = obstacles.end.take(piece, axis=0) - start, start - cells.point.take(cell, axis=0)
    turn = normal[:, 0] * step[:, 1] - normal[:, 1] * step[:, 0]
    parallel = np.abs(turn) < 1e-12
    turn = np.where(parallel, 1.0, turn)
    away_mm = (offset[:, 0] * step[:, 1] - offset[:, 1] * step[:, 0]) / turn
    share = (offset[:, 0] * normal[:, 1] - offset[:, 1] * normal[:, 0]) / turn
    nearest_mm = np.where(obstacles.owner.take(piece) == cells.contour.take(cell), CONTACT_MM, -CONTACT_MM)
    met = ~parallel & (share >= -1e-9) & (share <= 1 + 1e-9) & (away_mm >= nearest_mm) & (away_mm <= reach_mm)
    return met, away_mm[met]
