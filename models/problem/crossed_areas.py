"""Which areas straight moves cross, compiled by numba: millions of moves, a few areas near each."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
import shapely

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.models.kernels import cores, inner, kept, suited

from .crossed_by_arrays import Areas, crossed_by_arrays

THREADS = cores()
STEPS_A_MOVE = 8
"""Turns of inner loops that it takes to tell whether a move crosses an area."""
SLOTS_AT_FIRST = 1 << 10
GROUPS_AT_ONCE = 8

Going = Callable[[float], bool]
"""Whether to go on, given the share that is done."""


class Stopped(Exception):
    """Whoever asked has had enough."""


@dataclass(frozen=True, eq=False, slots=True)
class IdleMoves:
    """Moves from every one of `leave` (k, 2) to every one of `reach` (l, 2), points of the contours `owner` (l,).

    `areas` are those that may be crossed.
    """

    leave: Floats
    reach: Floats
    owner: Ints
    areas: Ints


def crossed_areas(
    groups: Sequence[IdleMoves], areas: Sequence[shapely.Geometry], late: Bools, going: Going = lambda share: True
) -> list[tuple[Ints, Ints, Ints]]:
    """For every group of moves: where crossing ones leave and reach, as numbers in the group, and the area crossed.

    `late[c, a]` says that area a is of no account to moves that reach contour c. `going` is asked now and then, with
    the share that is done, whether to go on.

    Raises
    ------
    Stopped
        If it says no.

    Examples
    --------
    >>> reach = np.array([[9.0, 0.0], [0.0, 9.0], [9.0, 0.0]])
    >>> moves = IdleMoves(np.array([[0.0, 0.0]]), reach, np.array([0, 0, 1]), np.array([0]))
    >>> late = np.array([[False], [True]])
    >>> [rows.tolist() for rows in crossed_areas([moves], [shapely.box(4, -1, 5, 1)], late)[0]]
    [[0], [0], [0]]
    """
    tree = shapely.STRtree(areas)
    made = _edges_of(areas)

    done = np.cumsum([0, *(len(moves.leave) * len(moves.reach) * len(moves.areas) for moves in groups)])
    cross = suited(_crossed, STEPS_A_MOVE * float(done[-1]), crossed_by_arrays)

    def look(moves: IdleMoves) -> tuple[Ints, Ints, Ints]:
        ends = np.concatenate([moves.leave, moves.reach])
        around = tree.query(shapely.box(*ends.min(axis=0), *ends.max(axis=0)))
        near = np.intersect1d(around, moves.areas).astype(np.int64)
        rows = cross(moves.leave, moves.reach, moves.owner, made, near, late)
        return rows[0], rows[1], rows[2]

    found: list[tuple[Ints, Ints, Ints]] = []
    with ThreadPoolExecutor(THREADS) as threads:
        for begin in range(0, len(groups), GROUPS_AT_ONCE):
            if not going(float(done[begin] / max(1, done[-1]))):
                raise Stopped
            found += threads.map(look, groups[begin : begin + GROUPS_AT_ONCE])
    return found


def _edges_of(areas: Sequence[shapely.Geometry]) -> Areas:
    parts, part_of = shapely.get_parts(np.array(areas, dtype=object), return_index=True)
    rings, ring_part = shapely.get_rings(parts, return_index=True)
    points, point_ring = shapely.get_coordinates(rings, return_index=True)
    same = point_ring[1:] == point_ring[:-1]
    area_of = part_of[ring_part[point_ring]][:-1][same]
    return Areas(
        shapely.bounds(np.array(areas, dtype=object)),
        np.searchsorted(area_of, np.arange(len(areas) + 1)).astype(np.int64),
        np.hstack([points[:-1], points[1:]])[same],
    )


@kept(nogil=True)
def _crossed(  # pragma: no cover - compiled
    leave: Floats, reach: Floats, owner: Ints, areas: Areas, near: Ints, late: Bools
) -> Ints:
    """Rows of leave, reach and area of all moves that cross one of the areas `near`, (3, rows)."""
    rows = np.empty((3, SLOTS_AT_FIRST), np.int64)
    count = 0
    boxes = np.empty((len(near), 4))
    for k in range(len(near)):
        for side in range(4):
            boxes[k, side] = areas.boxes[near[k], side]
    for i in range(len(leave)):
        px, py = leave[i, 0], leave[i, 1]
        for j in range(len(reach)):
            x0, x1, y0, y1 = min(px, reach[j, 0]), max(px, reach[j, 0]), min(py, reach[j, 1]), max(py, reach[j, 1])
            for k in range(len(near)):
                if x0 > boxes[k, 2] or x1 < boxes[k, 0] or y0 > boxes[k, 3] or y1 < boxes[k, 1]:
                    continue  # most are told by that
                a = near[k]
                if not late[owner[j], a] and _crosses(leave[i], reach[j], areas, a):
                    if count == rows.shape[1]:
                        wider = np.empty((3, 2 * count), np.int64)
                        for r in range(count):  # numba takes seconds to compile what copies a block
                            wider[0, r], wider[1, r], wider[2, r] = rows[0, r], rows[1, r], rows[2, r]
                        rows = wider
                    rows[0, count], rows[1, count], rows[2, count] = i, j, a
                    count += 1
    return rows[:, :count].copy()


@inner(nogil=True)
def _crosses(p: Floats, q: Floats, areas: Areas, a: int) -> bool:  # pragma: no cover - compiled
    """Whether the move from p to q meets area a.

    It does if an edge cuts it, or if both ends are inside: if edges cut the line beyond q an odd number of times.
    """
    px, py, qx, qy = p[0], p[1], q[0], q[1]
    left, low, right, high = areas.boxes[a]
    if not (min(px, qx) <= right and max(px, qx) >= left and min(py, qy) <= high and max(py, qy) >= low):
        return False
    dx, dy, end = qx - px, qy - py, 1.0
    if dx == 0.0 and dy == 0.0:
        dx, end = 1.0, 0.0
    aside = dx * ((low + high) / 2 - py) - dy * ((left + right) / 2 - px)
    if abs(aside) > abs(dx) * (high - low) / 2 + abs(dy) * (right - left) / 2:
        return False  # the box lies on one side of the line
    inside = False
    for e in range(areas.edge_from[a], areas.edge_from[a + 1]):
        ux, uy, vx, vy = areas.edges[e]
        u = dx * (uy - py) - dy * (ux - px)
        v = dx * (vy - py) - dy * (vx - px)
        if (u > 0) != (v > 0):
            share = u / (u - v)
            along = (dx * (ux + share * (vx - ux) - px) + dy * (uy + share * (vy - uy) - py)) / (dx * dx + dy * dy)
            if along > end:
                inside = not inside
            elif along >= 0:
                return True
    return inside
