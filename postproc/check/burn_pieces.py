"""A burn taken apart into the pieces that it cuts of rings, and which burns and rings belong together."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass, field, replace

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.geometry.curve import Curve

from .ring_coverage import (
    Chords,
    Covered,
    chords_of_lines,
    chords_of_paths,
    difference,
    intersection,
    near_stretches,
    total_mm,
    union,
)

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
    built: list[Piece] = []
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
            built.append(Piece(ring, start_mm, at_mm, when_mm, when_mm, True, min(since_mm, when_mm)))
            start_mm = at_mm = last_out_mm = when_mm
        adds = _adding(burn, row, coverage, at_mm, high_mm)
        if not here or max(adds.values(), default=0.0) > 2 * within_mm:
            ring = max(adds, key=lambda k: (adds[k], -k)) if adds else _longest(row, at_mm, high_mm)
            built.append(Piece(ring, start_mm, at_mm, high_mm, high_mm, False, at_mm))
        else:
            built[-1] = replace(built[-1], end_mm=high_mm)
        start_mm = high_mm
    if built:
        built[-1] = replace(built[-1], end_mm=length_mm)
    return built


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


# Stretches of burns that run along rings.

_ALONG = 0.8
"""Cosine of the angle up to which a chord runs along another one, and does not just meet it."""
LEAST_MM = 1.0
"""A burn that is along a ring for less than this, and than a quarter of the ring, only meets it."""


@dataclass(frozen=True, eq=False, slots=True)
class Stretch:
    """A stretch of a burn along a ring: `low_mm` to `high_mm` on the burn, and what that is on the ring."""

    ring: int
    low_mm: float
    high_mm: float
    on_ring: Floats

    @property
    def length_mm(self) -> float:
        """Its length on the burn."""
        return self.high_mm - self.low_mm


def stretches(burns: Chords, rings: Chords, lengths_mm: Floats, within_mm: float) -> dict[int, list[Stretch]]:
    """For each burn its stretches along rings, from its start on; those that only meet a ring are left out.

    `lengths_mm` are those of the rings.
    """
    found = near_stretches(burns, rings, within_mm)
    found = found.only(np.abs(found.along) > _ALONG)
    order = np.lexsort((found.low_mm, found.other, found.line))
    found = found.only(order)
    by_contour: dict[int, list[Stretch]] = {}
    if not len(found):
        return by_contour
    edges = np.flatnonzero((np.diff(found.line) != 0) | (np.diff(found.other) != 0)) + 1
    for rows in np.split(np.arange(len(found)), edges):
        line, ring = int(found.line[rows[0]]), int(found.other[rows[0]])
        low, high = found.low_mm[rows], found.high_mm[rows]
        least_mm = min(LEAST_MM, float(lengths_mm[ring]) / 4)
        for a, b in union(np.stack([low, high], axis=1), within_mm).tolist():
            if b - a >= least_mm:
                own = rows[(low >= a) & (high <= b)]
                ends = np.sort(np.stack([found.other_low_mm[own], found.other_high_mm[own]], axis=1), axis=1)
                by_contour.setdefault(line, []).append(Stretch(ring, a, b, union(ends)))
    for row in by_contour.values():
        row.sort(key=lambda s: (s.low_mm, s.high_mm, s.ring))
    return by_contour


def beside_own_mm(row: Sequence[Stretch], own: int | None) -> dict[int, float]:
    """How far a burn runs along each other ring where it does not run along its own, mm.

    Two rings may share a line, where parts stand a kerf apart: who follows the one is along the other too.
    """
    along = [(s.low_mm, s.high_mm) for s in row if s.ring == own]
    mine = union(np.array(along).reshape(-1, 2))
    found: dict[int, float] = {}
    for s in row:
        if s.ring != own:
            more_mm = total_mm(difference(np.array([[s.low_mm, s.high_mm]]), mine))
            found[s.ring] = found.get(s.ring, 0.0) + more_mm
    return found


def adds_mm(stretch: Stretch, new: Floats) -> float:
    """How much of what is newly covered of a ring a stretch covers, mm."""
    return total_mm(intersection(stretch.on_ring, new))


# Which burns and rings do not belong together one to one: chains, and contours that several burns cut.


@dataclass(frozen=True, eq=False, slots=True)
class SharedBurns:
    """Numbers of the burns that cut several rings, or rings with others, and of the rings that they cut so.

    `along` are the stretches along rings of all burns that were looked at.
    """

    burns: frozenset[int] = frozenset()
    rings: frozenset[int] = frozenset()
    along: Mapping[int, list[Stretch]] = field(default_factory=dict)


def find_shared_burns(
    paths: Sequence[Curve | None],
    lines: Sequence[shapely.LineString],
    rings: Sequence[shapely.LineString | None],
    own: Sequence[int | None],
    within_mm: float,
    tabbed: Set[int] = frozenset(),
) -> SharedBurns:
    """Find the burns that one ring each does not account for.

    `paths` and `lines`: the torch's paths and the same as lines; None is one that is not asked about, such as a mark.
    `rings`: the rings of all contours, None where the torch goes round nothing. `own`: for each path the contour that
    it cuts all by itself. One without a ring, such as a slit, shares nothing. `within_mm`: how far a burn may be from a
    ring that it runs along. `tabbed`: rings that are not to be covered all round, so that even one burn alone does not
    cover them.
    """
    own = [None if ring in tabbed else ring for ring in own]
    shared = _asked(paths, lines, rings, own, within_mm)
    if not shared:
        return SharedBurns()
    along = stretches_of(paths, rings, sorted(shared), within_mm)
    touched = {burn: _touched(along.get(burn, []), own[burn], rings) for burn in sorted(shared)}
    odd = {burn for burn, met in touched.items() if (ring := own[burn]) is None or (met and rings[ring] is not None)}
    whole = {ring for burn, ring in enumerate(own) if ring is not None and burn not in odd}
    burns_of: dict[int, set[int]] = {}
    for burn, row in along.items():
        for ring in {s.ring for s in row} - whole:
            burns_of.setdefault(ring, set()).add(burn)
    rings_of = {burn: touched[burn] | _one(own[burn]) for burn in odd}
    apart = {ring for ring, by in burns_of.items() if len(by) > 1} | tabbed
    burns = {burn for burn in odd if len(rings_of[burn]) > 1 or rings_of[burn] & apart}
    cut, waiting = set[int](), sorted(burns)
    while waiting:
        for ring in rings_of[waiting.pop()] - cut:
            cut.add(ring)
            more = set() if ring in whole else (burns_of.get(ring, set()) & odd) - burns
            burns |= more
            waiting += sorted(more)
    return SharedBurns(frozenset(burns), frozenset(cut), along)


def stretches_of(
    paths: Sequence[Curve | None], rings: Sequence[shapely.LineString | None], burns: Sequence[int], within_mm: float
) -> dict[int, list[Stretch]]:
    """The stretches of some burns along all rings, by the numbers of the burns."""
    chords = chords_of_paths([path for burn in burns if (path := paths[burn]) is not None])
    lines = np.array([shapely.LineString() if ring is None else ring for ring in rings], dtype=object)
    near = np.unique(shapely.STRtree(lines).query(chords.boxes(within_mm))[1])
    found = stretches(chords, chords_of_lines(lines[near]), np.asarray(shapely.length(lines[near])), within_mm)
    return {burns[k]: [replace(s, ring=int(near[s.ring])) for s in row] for k, row in found.items()}


def _asked(
    paths: Sequence[Curve | None],
    lines: Sequence[shapely.LineString],
    rings: Sequence[shapely.LineString | None],
    own: Sequence[int | None],
    within_mm: float,
) -> set[int]:
    """Burns that cover no ring, or come near another ring than their own."""
    burns = np.array([k for k, path in enumerate(paths) if path is not None and path.segments], dtype=np.int64)
    if not len(burns):
        return set()
    around = np.array([shapely.LineString() if ring is None else ring for ring in rings], dtype=object)
    candidates = np.array([lines[k] for k in burns.tolist()], dtype=object)
    bounds = shapely.bounds(candidates)
    boxes = shapely.box(*(bounds + np.array([-within_mm, -within_mm, within_mm, within_mm])).T)
    row, ring = shapely.STRtree(around).query(boxes)
    mine = np.array([-1 if own[k] is None else own[k] for k in burns.tolist()], dtype=np.int64)
    other = ring != mine[row]
    row, ring = row[other], ring[other]
    some = candidates[np.unique(row)]
    shapely.prepare(some)
    near = shapely.dwithin(candidates[row], around[ring], within_mm)
    shapely.destroy_prepared(some)
    return set(burns[row[near]].tolist())


def _touched(row: Sequence[Stretch], own: int | None, rings: Sequence[shapely.LineString | None]) -> set[int]:
    """The rings beside its own that a burn runs along."""
    beside = beside_own_mm(row, own)
    return {k for k, mm in beside.items() if (ring := rings[k]) is not None and mm >= min(LEAST_MM, ring.length / 4)}


def _one(ring: int | None) -> set[int]:
    return set() if ring is None else {ring}
