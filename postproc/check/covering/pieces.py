"""A burn taken apart into the pieces that it cuts of rings, with what it runs on no ring before and after each."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.geometry.curve import Curve

from .covered import Covered
from .intervals import total_mm, union
from .stretches import Stretch, adds_mm

_SNAP = 10.0
"""A place is moved on to the next vertex of the burn where that is so near, in tolerances: there blocks end."""
_ROUND_KERFS, _ROUND_SHARE = 4.0, 0.25
"""A stretch this short, and no further than this share of a kerf from rings, goes round a corner or over a crossing."""
_STEP_MM = 0.1


@dataclass(frozen=True, eq=False, slots=True)
class Piece:
    """A stretch of a burn on a ring: it comes from `start_mm` to the ring at `join_mm`, and leaves it at `leave_mm`.

    From there to `end_mm` it cuts nothing new. `out` says that the ring is covered then; `since_mm` is where the burn
    first came to that ring since the ring before was out.
    """

    ring: int
    start_mm: float
    join_mm: float
    leave_mm: float
    end_mm: float
    out: bool
    since_mm: float


def pieces(
    burn: int,
    path: Curve,
    row: Sequence[Stretch],
    coverage: Mapping[int, Covered],
    rings: Sequence[shapely.LineString | None],
    kerf_mm: float,
    within_mm: float,
) -> list[Piece]:
    """Take one burn apart; `coverage` is that of the rings that are cut by several burns, or in a chain.

    The first piece begins where the burn does, the last one ends there; each begins where the one before it ended.
    """
    length_mm = path.length_mm
    vertices_mm = path.starts_mm

    def snapped(at_mm: float) -> float:
        k = int(np.searchsorted(vertices_mm, at_mm - 1e-6))
        near = k < len(vertices_mm) and vertices_mm[k] - at_mm <= _SNAP * within_mm
        return float(vertices_mm[k]) if near else at_mm

    events = sorted((snapped(done.out[1]), ring) for ring, done in coverage.items() if done.out and done.out[0] == burn)
    made: list[Piece] = []
    start_mm = last_out_mm = 0.0
    blocks = _blocks(path, row, rings, kerf_mm, within_mm)
    for number, (low_mm, high_mm) in enumerate(blocks, 1):
        at_mm, high_mm = snapped(low_mm), snapped(high_mm)
        until_mm = high_mm + _SNAP * within_mm if number < len(blocks) else length_mm
        here = [event for event in events if event[0] <= until_mm]
        events = events[len(here) :]
        for found_mm, ring in here:
            comes = (
                max(snapped(s.low_mm), last_out_mm) for s in row if _finishes(s, ring, burn, coverage, last_out_mm)
            )
            since_mm = next(comes, at_mm)
            when_mm = _closes(path, since_mm, found_mm, _SNAP * within_mm, within_mm) or found_mm
            when_mm = max(min(when_mm, high_mm), at_mm)
            made.append(Piece(ring, start_mm, at_mm, when_mm, when_mm, True, min(since_mm, when_mm)))
            start_mm = at_mm = last_out_mm = when_mm
        adds = _adding(burn, row, coverage, at_mm, high_mm)
        if not here or max(adds.values(), default=0.0) > 2 * within_mm:
            ring = max(adds, key=lambda k: (adds[k], -k)) if adds else _longest(row, at_mm, high_mm)
            made.append(Piece(ring, start_mm, at_mm, high_mm, high_mm, False, at_mm))
        else:
            made[-1] = replace(made[-1], end_mm=high_mm)
        start_mm = high_mm
    if made:
        made[-1] = replace(made[-1], end_mm=length_mm)
    return made


def _closes(path: Curve, since_mm: float, from_mm: float, reach_mm: float, within_mm: float) -> float | None:
    """Where a burn that goes all round comes back to where it began, soon after a place; None where it does not."""
    begins = path.point_at(since_mm)
    ends = path.starts_mm[(path.starts_mm >= from_mm - 1e-6) & (path.starts_mm <= from_mm + reach_mm)].tolist()
    apart = [(math.dist(path.point_at(mm), begins), mm) for mm in ends]
    nearest = min(apart, default=(math.inf, 0.0))
    return nearest[1] if nearest[0] <= within_mm else None


def _finishes(stretch: Stretch, ring: int, burn: int, coverage: Mapping[int, Covered], after_mm: float) -> bool:
    """Whether a stretch covers something of a ring after a place of its burn."""
    new = coverage[ring].new.get(burn)
    return stretch.ring == ring and stretch.high_mm > after_mm and new is not None and adds_mm(stretch, new) > 0


def _blocks(
    path: Curve, row: Sequence[Stretch], rings: Sequence[shapely.LineString | None], kerf_mm: float, within_mm: float
) -> list[tuple[float, float]]:
    """Where a burn is on rings, corners and crossings of kerfs that it goes straight over included."""
    on = union(np.array([(s.low_mm, s.high_mm) for s in row]).reshape(-1, 2), within_mm)
    near = shapely.MultiLineString([ring for k in sorted({s.ring for s in row}) if (ring := rings[k]) is not None])
    blocks: list[tuple[float, float]] = []
    for low, high in on.tolist():
        if blocks and _round(path, blocks[-1][1], low, near, kerf_mm, within_mm):
            blocks[-1] = (blocks[-1][0], high)
        else:
            blocks.append((low, high))
    return blocks


def _round(path: Curve, low: float, high: float, near: shapely.Geometry, kerf_mm: float, within_mm: float) -> bool:
    """Whether a stretch between two others only goes round a corner."""
    if high - low > _ROUND_KERFS * kerf_mm:
        return False
    at = [path.point_at(mm) for mm in np.arange(low, high, _STEP_MM).tolist()]
    return bool(shapely.distance(near, shapely.points(at)).max() <= _ROUND_SHARE * kerf_mm + within_mm)


def _adding(
    burn: int, row: Sequence[Stretch], coverage: Mapping[int, Covered], low_mm: float, high_mm: float
) -> dict[int, float]:
    """How much of rings that are still open is covered between two places of a burn."""
    adds: dict[int, float] = {}
    for s in row:
        if s.ring in coverage and min(s.high_mm, high_mm) > max(s.low_mm, low_mm):
            done = coverage[s.ring]
            later = done.out is None or done.out[0] > burn or done.out[1] > low_mm
            share = (min(s.high_mm, high_mm) - max(s.low_mm, low_mm)) / s.length_mm
            new = done.new.get(burn)
            if later and new is not None:
                adds[s.ring] = adds.get(s.ring, 0.0) + share * adds_mm(s, new)
    return adds


def _longest(row: Sequence[Stretch], low_mm: float, high_mm: float) -> int:
    return max(row, key=lambda s: (min(s.high_mm, high_mm) - max(s.low_mm, low_mm), -s.ring)).ring


def is_whole(piece: Piece, done: Covered, burn: int, ring: shapely.LineString, free: Floats, within_mm: float) -> bool:
    """Whether a piece goes all round a ring, and nothing else has burnt any of it."""
    new = done.new.get(burn)
    if new is None or not piece.out:
        return False
    around_mm = ring.length - 4 * within_mm
    alone = total_mm(union(np.concatenate([new, free]))) >= around_mm
    return alone and piece.leave_mm - piece.since_mm >= float(around_mm - total_mm(free))
