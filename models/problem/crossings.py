"""Idle moves over parts that may already be out, worked out for every move that can occur."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple, cast

import numpy as np
import shapely

from kerfwise.arrays import Bools, Floats, Int32s, Ints
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.tolerances import GRAZE_UM, UM_PER_MM
from kerfwise.models.jit import KERNEL, cores, inner, jit, suited
from kerfwise.rules.registry import RULES
from kerfwise.rules.statements import Crossing

from .precedence import Followers

FORBIDDEN = -1
MOST_MOVES = 3_000_000
"""Moves that can be looked at one by one in a minute or so."""


def _none() -> Ints:
    return np.zeros(0, dtype=np.int64)


@dataclass(frozen=True, eq=False, slots=True)
class Crossings:
    """Row k: going from site `leave[k]` to site `reach[k]` once contour `over[k]` is cut costs `cost[k]` µm.

    A site number of m, the number of sites, is the machine's home; a cost of `FORBIDDEN` makes the move unlawful.
    `statement[k]` is the place of the statement among those given. What is out from the start is said of the contour
    that the move leaves, which is cut before the move: `over[k]` is that one. All but the costs are narrow numbers, as
    there are many millions of rows on large nests without zones.
    """

    leave: Ints | Int32s = field(default_factory=_none)
    reach: Ints | Int32s = field(default_factory=_none)
    over: Ints | Int32s = field(default_factory=_none)
    cost: Ints = field(default_factory=_none)
    statement: Ints | Int32s = field(default_factory=_none)

    def __len__(self) -> int:
        return len(self.leave)

    @property
    def nbytes(self) -> int:
        """What the rows take."""
        return sum(column.nbytes for column in (self.leave, self.reach, self.over, self.cost, self.statement))

    def moves(self, m: int) -> Ints:
        """A number for the move of every row between `m` sites and home: leave (m + 1) + reach."""
        numbers = self.leave.astype(np.int64)
        numbers *= m + 1
        numbers += self.reach
        return numbers

    def only(self, kept: Bools | Ints) -> Crossings:
        """Some of the rows: those that are told, or those of these numbers, in their order."""
        return Crossings(self.leave[kept], self.reach[kept], self.over[kept], self.cost[kept], self.statement[kept])

    def renumbered(self, number: Ints) -> Crossings:
        """The rows between sites that are left, and home: `number[s]` (m + 1,) is the new number of site s, or -1."""
        left = self.only((number[self.leave] >= 0) & (number[self.reach] >= 0))
        leave, reach = number[left.leave].astype(np.int32), number[left.reach].astype(np.int32)
        return replace(left, leave=leave, reach=reach)


class TooManyMoves(InputError):
    """The moves that can occur cannot all be looked at."""


def find_crossings(
    statements: Sequence[Crossing],
    before: Bools,
    lawful: Followers,
    first: Ints,
    ends_um: Ints,
    pierces_um: Ints,
    going: Going = lambda share: True,
) -> Crossings:
    """All crossings between contours that may follow each other, of areas that may be out before the move.

    `before` (n, n) is the closed order, `lawful` who may follow whom, `first` the first site of every contour and of
    home; `ends_um`, `pierces_um` (m + 1, 2) include home as their last row.

    `going` is asked now and then, with the share of the moves that has been looked at, whether to go on. Raises
    TooManyMoves if there are more than `MOST_MOVES` moves between sites, as on large nests without zones, or `going`
    says no.
    """
    if not statements:
        return Crossings()
    sites = np.diff(first)
    if (moves := int(sites @ lawful.weighed(sites))) > MOST_MOVES:
        zones = " or ".join(name for name, rule in RULES.items() if rule.makes_zones)
        raise TooManyMoves(
            f"idle travel over parts that are out asks about {moves:,} moves, more than the {MOST_MOVES:,} that can be "
            f"looked at: switch {statements[0].about.rule} off or {zones} on in the profile"
        )
    n = len(before)
    over = np.array([-1 if s.over is None else s.over for s in statements], dtype=np.int64)
    from_start = over < 0
    late = np.vstack([before[:, over] | (np.arange(n)[:, None] == over), np.zeros(len(over), dtype=np.bool_)])
    late[:, from_start] = False
    owner = np.repeat(np.arange(n + 1), sites)
    ends, pierces = ends_um.astype(np.float64), pierces_um.astype(np.float64)
    ahead = [np.flatnonzero(lawful[c][owner]) for c in range(n)]
    left = [c for c in range(n) if len(ahead[c]) and sites[c]]
    asked = [
        IdleMoves(
            ends[first[c] : first[c + 1]],
            pierces[ahead[c]],
            owner[ahead[c]],
            np.flatnonzero(~before[c, over] | from_start),
        )
        for c in left
    ]
    try:
        found = crossed_areas(asked, _areas_um(statements), late, going)
    except Stopped:
        raise TooManyMoves(
            f"idle travel over parts that are out asks about {moves:,} moves, for which the time limit is too short"
        ) from None
    rows = list[list[Int32s]]()
    for c in reversed(left):  # what is found is given back as it is taken over
        leave, reach, area = found.pop()
        rows.append(_narrow([first[c] + leave, ahead[c][reach], area]))
    leave, reach, area = (np.concatenate(column) for column in zip(_narrow([_none()] * 3), *rows[::-1], strict=True))
    price = [FORBIDDEN if s.weight is None else round(s.weight * UM_PER_MM) for s in statements]
    out = np.where(from_start[area], owner[leave], over[area]).astype(np.int32)
    return Crossings(leave, reach, out, np.array(price, dtype=np.int64)[area], area)


def in_order(moves: Ints) -> Ints | None:
    """The order of rows by the numbers of their moves; None where they stand so, as those that were found do."""
    return None if (moves[1:] >= moves[:-1]).all() else np.argsort(moves, kind="stable")


def _narrow(columns: list[Ints]) -> list[Int32s]:
    return [column.astype(np.int32) for column in columns]


def from_home(
    statements: Sequence[Crossing], lawful: Followers, first: Ints, pierces_um: Ints
) -> list[tuple[int, int]]:
    """Site, and number of the statement, of every move from home that leads over what is out from the start.

    The other arguments are those of `find_crossings`.
    """
    indices = [k for k, s in enumerate(statements) if s.over is None]
    if not indices:
        return []
    sites = np.diff(first)
    n = len(sites) - 1
    owner = np.repeat(np.arange(n + 1), sites)
    pierces = pierces_um.astype(np.float64)
    ahead = np.flatnonzero(lawful[n][owner] & (owner < n))
    moves = IdleMoves(pierces[-1:], pierces[ahead], owner[ahead], np.arange(len(indices)))
    never = np.zeros((n + 1, len(indices)), dtype=np.bool_)
    ((_, reach, area),) = crossed_areas([moves], _areas_um([statements[k] for k in indices]), never)
    return sorted((int(ahead[r]), indices[a]) for r, a in zip(reach.tolist(), area.tolist(), strict=True))


def paid_along(statements: Sequence[Crossing], ends_um: Ints, pierces_um: Ints, place: Ints, linked: Bools) -> int:
    """What the idle moves of one order cost for the areas that they cross, µm: soft statements only.

    Move k leads from `ends_um[k]` to `pierces_um[k]` (k + 1, 2), the first from home and the last back to it; `place`
    (n,) is that of every contour in the order, from 0. Moves that are `linked` (k + 1,) are free.
    """
    soft = [s for s in statements if s.weight is not None]
    if not soft:
        return 0
    areas = np.array(_areas_um(soft), dtype=object)
    moves = shapely.linestrings(np.stack([ends_um, pierces_um], axis=1).astype(np.float64))
    move, area = shapely.STRtree(areas).query(moves, predicate="intersects")
    out_from = np.array([0 if s.over is None else place[s.over] + 1 for s in soft])
    price = np.array([round((s.weight or 0.0) * UM_PER_MM) for s in soft])
    return int(price[area[(out_from[area] <= move) & ~linked[move]]].sum())


def _areas_um(statements: Sequence[Crossing]) -> list[shapely.Geometry]:
    """What must not be crossed, less what a move may graze."""
    return list(shapely.buffer([shapely.transform(s.area, lambda xy: xy * UM_PER_MM) for s in statements], -GRAZE_UM))


# Which areas straight moves cross, compiled by numba: millions of moves, a few areas near each.

THREADS = cores()
STEPS_A_MOVE = 8
"""Turns of inner loops that it takes to tell whether a move crosses an area."""
ROWS_AT_FIRST = 1 << 10
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
    the share that is done, whether to go on. Raises Stopped if it says no.

    Examples
    --------
    >>> reach = np.array([[9.0, 0.0], [0.0, 9.0], [9.0, 0.0]])
    >>> moves = IdleMoves(np.array([[0.0, 0.0]]), reach, np.array([0, 0, 1]), np.array([0]))
    >>> late = np.array([[False], [True]])
    >>> [rows.tolist() for rows in crossed_areas([moves], [shapely.box(4, -1, 5, 1)], late)[0]]
    [[0], [0], [0]]
    """
    tree = shapely.STRtree(areas)
    edges = _edges_of(areas)

    done = np.cumsum([0, *(len(moves.leave) * len(moves.reach) * len(moves.areas) for moves in groups)])
    step: Callable[..., Any] = suited(cast(Any, _crossed), STEPS_A_MOVE * float(done[-1]), crossed_by_arrays)

    def look(moves: IdleMoves) -> tuple[Ints, Ints, Ints]:
        ends = np.concatenate([moves.leave, moves.reach])
        around = tree.query(shapely.box(*ends.min(axis=0), *ends.max(axis=0)))
        near = np.intersect1d(around, moves.areas).astype(np.int64)
        given = moves.leave, moves.reach, moves.owner, edges, near, late
        rows = step(*given) if step is crossed_by_arrays else _every_row(step, given, len(near))
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


def _every_row(step: Callable[..., bool], given: tuple[Any, ...], most: int) -> Ints:
    """What `_crossed` finds, with room for it made as it is needed: a move crosses `most` areas."""
    rows, far = np.empty((3, max(ROWS_AT_FIRST, most)), np.int64), np.zeros(3, np.int64)
    while not step(*given, rows, far):
        rows = np.hstack([rows, np.empty_like(rows)])
    return rows[:, : far[2]].copy()


@jit(**KERNEL)
def _crossed(  # pragma: no cover - compiled
    leave: Floats, reach: Floats, owner: Ints, areas: Areas, near: Ints, late: Bools, rows: Ints, far: Ints
) -> bool:
    """Write leave, reach and area of all moves that cross one of the areas `near` to `rows`, (3, rows).

    Begins with the move from `far[0]` to `far[1]`, where `far[2]` rows are written. Whether there was room for all.
    """
    begin, first, count = far[0], far[1], far[2]
    for i in range(begin, len(leave)):
        px, py = leave[i, 0], leave[i, 1]
        for j in range(first, len(reach)):
            if count + len(near) > rows.shape[1]:
                far[0], far[1], far[2] = i, j, count
                return False
            x0, x1, y0, y1 = min(px, reach[j, 0]), max(px, reach[j, 0]), min(py, reach[j, 1]), max(py, reach[j, 1])
            for a in near:
                if x0 > areas.boxes[a, 2] or x1 < areas.boxes[a, 0] or y0 > areas.boxes[a, 3] or y1 < areas.boxes[a, 1]:
                    continue  # most are told by that
                if not late[owner[j], a] and _crosses(leave[i], reach[j], areas, a):
                    rows[0, count], rows[1, count], rows[2, count] = i, j, a
                    count += 1
        first = 0
    far[2] = count
    return True


@inner(**KERNEL)
def _crosses(p: Floats, q: Floats, areas: Areas, a: int) -> bool:  # pragma: no cover - compiled
    """Whether the move from p to q meets area a.

    It does if an edge cuts it, or if both ends are inside: if edges cut the line beyond q an odd number of times.
    """
    px, py, qx, qy = p[0], p[1], q[0], q[1]
    left, low, right, high = areas.boxes[a, 0], areas.boxes[a, 1], areas.boxes[a, 2], areas.boxes[a, 3]
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
        ux, uy, vx, vy = areas.edges[e, 0], areas.edges[e, 1], areas.edges[e, 2], areas.edges[e, 3]
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


# Which areas straight moves cross, by whole arrays: the same as `crossed_areas` says compiled, where moves are few.

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
        found.append(rows[:, _crosses_by_arrays(leave[rows[0]], reach[rows[1]], areas, rows[2])])
    return np.concatenate(found, axis=1)


def _crosses_by_arrays(p: Floats, q: Floats, areas: Areas, area: Ints) -> Bools:
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
