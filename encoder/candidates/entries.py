"""Where the torch can join a contour, which of these points to offer as entries, and leads to them as arrays."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Bools, Floats, Ints, Rows
from kerfwise.encoder.cut import Direction
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment_arrays import SegmentArrays
from kerfwise.encoder.nest import Contour, Kind

OFF_MM = 0.01
"""A joining point this far from where an entry asks for it is that of another entry."""


@dataclass(frozen=True, eq=False)
class Outline:
    """A contour to cut (number `index` of the nest) with its compensated path, both also as arrays.

    `right` is 1.0 where the waste lies to the right of the contour as drawn, else -1.0.
    """

    index: int
    contour: Contour
    path: Curve
    drawn: SegmentArrays
    path_drawn: SegmentArrays
    right: float
    half_kerf_mm: float

    @staticmethod
    def of(paths: Mapping[int, tuple[Contour, Curve]], half_kerf_mm: float) -> dict[int, Outline]:
        """The outlines of contours, by number, whose compensated paths are known."""
        drawn = SegmentArrays.of(*(contour.curve for contour, _ in paths.values())).each()
        path_drawn = SegmentArrays.of(*(path for _, path in paths.values())).each()
        return {
            k: Outline(k, contour, path, one, other, _right(contour), half_kerf_mm)
            for (k, (contour, path)), one, other in zip(paths.items(), drawn, path_drawn, strict=True)
        }

    @cached_property
    def path_reversed(self) -> Curve:
        """The path the other way round."""
        return self.path.reversed()

    @property
    def around_mm(self) -> float:
        """The length of the contour as drawn."""
        return float(self.drawn.starts_mm[-1])

    def joints(self, at_mm: Floats) -> tuple[Joints, Bools]:
        """See `joints_at`."""
        return joints_at([self], at_mm, np.zeros(len(at_mm), np.int64))


@dataclass(frozen=True, eq=False, slots=True)
class Joints(Rows):
    """Parallel arrays, one row a joint.

    `contour` the number of the contour, `entry_mm` and `entry` (m, 2) where on it as drawn, `join_mm` and `join`
    (m, 2) where on its compensated path as drawn, `out` (m, 2) the unit vector from there into the waste.
    """

    contour: Ints
    entry_mm: Floats
    entry: Floats
    join_mm: Floats
    join: Floats
    out: Floats


NO_JOINTS = Joints(
    np.zeros(0, np.int64), np.zeros(0), np.zeros((0, 2)), np.zeros(0), np.zeros((0, 2)), np.zeros((0, 2))
)


def joints_at(outlines: Sequence[Outline], at_mm: Floats, of: Ints) -> tuple[Joints, Bools]:
    """Entries at path lengths along contours with where the torch joins, and which of them it really comes to.

    `of` (m,), ascending, numbers the outline of each. The entries that the torch does not come to lie in hollow
    corners, where it cannot come as close to the contour as elsewhere; they are joined at the nearest place.
    """
    if not outlines:
        return NO_JOINTS, np.zeros(0, np.bool_)
    drawn = SegmentArrays.joined([outline.drawn for outline in outlines])
    paths = SegmentArrays.joined([outline.path_drawn for outline in outlines])
    right = np.array([outline.right for outline in outlines])[of][:, None]
    half_kerf_mm = np.array([outline.half_kerf_mm for outline in outlines])[of][:, None]
    entry, before, after = drawn.frames(at_mm, of)
    tangent = before + after
    length = np.hypot(tangent[:, 0], tangent[:, 1])[:, None]
    # Where the contour turns back there is no mean tangent: go straight on.
    tangent = np.where(length > 1e-6, tangent / np.maximum(length, 1e-6), _left(before) * right)
    out = -right * _left(tangent)
    wanted = entry + half_kerf_mm * out
    join_mm, off_mm = paths.project(wanted, of)
    join, _, _ = paths.frames(join_mm, of)
    reach = join - entry
    distance_mm = np.hypot(reach[:, 0], reach[:, 1])[:, None]
    moved = (off_mm > OFF_MM)[:, None] & (distance_mm > 1e-6)
    out = np.where(moved, reach / np.maximum(distance_mm, 1e-6), out)
    index = np.array([outline.index for outline in outlines], dtype=np.int64)[of]
    return Joints(index, at_mm, entry, join_mm, join, out), off_mm <= OFF_MM


def _right(contour: Contour) -> float:
    return 1.0 if contour.curve.is_ccw == (contour.kind == "outer") else -1.0


def _left(v: Floats) -> Floats:
    return np.column_stack([-v[:, 1], v[:, 0]])


# Which points of a contour to offer as entries: corners first, then middles of edges, well apart.

CORNER_RAD = math.radians(30)
"""A contour that turns by no more has no corner there."""
STRAIGHT_RAD = math.radians(1)
"""Straight pieces that turn by less, all together, are one edge."""
TIED_MM, TIED_RAD = 1e-6, 1e-9
"""What differs by less is equal: where a drawing lies on the sheet must not tell which entry is better."""

CORNER, MIDDLE, ANYWHERE = 0, 1, 2
Ranks = NDArray[np.int64]


def places(outlines: Sequence[Outline], count: int) -> tuple[Floats, Ranks, Ints]:
    """Path lengths along contours that could be entries, the rank of each, and the number of its outline, ascending.

    Corners that stick out into the waste, where a scar matters least, rank before the middles of straight edges, and
    those before `4 * count` points spread evenly. A tilted torch does not begin at corners.
    """
    if not outlines:
        return np.zeros(0), np.zeros(0, np.int64), np.zeros(0, np.int64)
    drawn = SegmentArrays.joined([outline.drawn for outline in outlines])
    each, around_mm = np.arange(len(outlines)), drawn.lengths_mm
    of = np.repeat(each, np.diff(drawn.first))
    k = np.arange(len(drawn)) + of
    right = np.array([outline.right for outline in outlines])[of]
    tilted = np.array([outline.contour.bevelled for outline in outlines])[of]
    corners = np.flatnonzero((drawn.turn_rad * right > CORNER_RAD + TIED_RAD) & ~tilted)
    length_mm = _edges_mm(drawn, drawn.starts_mm[k + 1] - drawn.starts_mm[k])
    edges = np.flatnonzero(length_mm > around_mm[of] / (8 * count) + TIED_MM)
    groups = [
        drawn.starts_mm[k[corners] + 1] % around_mm[of[corners]],
        (drawn.starts_mm[k[edges]] + length_mm[edges] / 2) % around_mm[of[edges]],
        (around_mm[:, None] * (np.arange(4 * count) + 0.5) / (4 * count)).ravel(),
    ]
    whose = np.concatenate([of[corners], of[edges], np.repeat(each, 4 * count)])
    order = np.argsort(whose, kind="stable")
    ranks = np.repeat([CORNER, MIDDLE, ANYWHERE], [len(g) for g in groups])
    return np.concatenate(groups)[order], ranks[order], whose[order]


def _edges_mm(drawn: SegmentArrays, length_mm: Floats) -> Floats:
    """Array (n,): how long the straight edge is that begins with each segment; 0 where none begins.

    A long edge may be drawn, or compensated, in several pieces that hardly turn.
    """
    straight, after = drawn.bulge == 0, drawn.following
    goes_on = straight & straight[after] & (np.abs(drawn.turn_rad) < STRAIGHT_RAD)
    edge_mm = np.where(straight, length_mm, 0.0)
    if not goes_on.any():
        return edge_mm
    begins = np.ones(len(drawn), np.bool_)
    begins[after[goes_on]] = False
    for first, last in zip(drawn.first[:-1].tolist(), drawn.first[1:].tolist(), strict=True):
        if not goes_on[first:last].any():
            continue
        start = first + int(np.argmax(begins[first:last]))
        edge, turned_rad = start, 0.0
        for k in (*range(start + 1, last), *range(first, start)):
            before = k - 1 if k > first else last - 1
            turned_rad += float(drawn.turn_rad[before])
            if goes_on[before] and abs(turned_rad) < STRAIGHT_RAD:
                edge_mm[edge] += edge_mm[k]
                edge_mm[k] = 0.0
            else:
                edge, turned_rad = k, 0.0
    return edge_mm


def choose(at_mm: Floats, ranks: Ranks, around_mm: float, count: int, taken_mm: Floats) -> list[int]:
    """See `choose_each`, of one contour, as many as it can have.

    Examples
    --------
    >>> choose(np.array([0.0, 1.0, 50.0, 55.0]), np.array([0, 0, 1, 2]), 100.0, 3, np.zeros(0))
    [0, 2]
    """
    one, both = np.zeros(len(at_mm), np.int64), np.zeros(len(taken_mm), np.int64)
    found = choose_each(at_mm, ranks, one, np.array([around_mm]), count, np.array([count]), taken_mm, both)
    return [int(k) for k in found]


def choose_each(
    at_mm: Floats,
    ranks: Ranks,
    of: Ints,
    around_mm: Floats,
    count: int,
    wanting: Ints,
    taken_mm: Floats,
    taken_of: Ints,
) -> Ints:
    """Places on contours, for each up to as many as it is `wanting` of `count`, contour after contour.

    Best rank first and each as far as can be from those before it and those taken. Places no farther than a quarter of
    an even share of the way round from another are passed over; of places that are equally far, the first is taken.
    `of`, ascending, numbers the contour of each place, of `taken_of` that of those that are taken; `around_mm` is the
    way round each contour. All contours are gone through at a time, a place each.
    """
    apart_mm = np.full(len(at_mm), np.inf)
    order = np.argsort(taken_of, kind="stable")
    first, last = (np.searchsorted(taken_of[order], of, side) for side in ("left", "right"))
    while len(more := np.flatnonzero(first < last)):
        place_mm = taken_mm[order[first[more]]]
        apart_mm[more] = np.minimum(apart_mm[more], shorter_way_mm(at_mm[more], place_mm, around_mm[of[more]]))
        first[more] += 1
    least_mm = around_mm / (4 * count) + TIED_MM
    rank, left = np.zeros(len(around_mm), np.int64), wanting.copy()
    chosen = [np.zeros(0, np.int64)]
    rows = np.flatnonzero(left[of] > 0)
    while len(rows):
        best = rows[ranks[rows] == rank[of[rows]]]
        begins = np.flatnonzero(np.diff(of[best], prepend=-1))
        farthest_mm = np.full(len(around_mm), -np.inf)
        if len(begins):
            farthest_mm[of[best[begins]]] = np.maximum.reduceat(apart_mm[best], begins)
        found = farthest_mm > least_mm
        best = best[found[of[best]] & (apart_mm[best] >= farthest_mm[of[best]] - TIED_MM)]
        best = best[np.diff(of[best], prepend=-1) > 0]
        chosen.append(best)
        place_mm = np.zeros(len(around_mm))
        place_mm[of[best]] = at_mm[best]
        near = rows[found[of[rows]]]
        way_mm = shorter_way_mm(at_mm[near], place_mm[of[near]], around_mm[of[near]])
        apart_mm[near] = np.minimum(apart_mm[near], way_mm)
        left[found] -= 1
        rank[~found] += 1
        rows = rows[(left[of[rows]] > 0) & (rank[of[rows]] <= ANYWHERE)]
    every = np.concatenate(chosen)
    return every[np.argsort(of[every], kind="stable")]


def shorter_way_mm(at_mm: Floats, place_mm: Floats | float, around_mm: Floats | float) -> Floats:
    """Shorter way round from a place to others."""
    ahead_mm = np.abs(at_mm - place_mm) % around_mm
    return np.minimum(ahead_mm, around_mm - ahead_mm)


# Leads as arrays: one line or arc each, from the pierce to where the torch joins.

_POINTS = 17
"""Points that an arc is judged by: a quarter of a circle of 4 mm radius in chords within 0.005 mm."""


@dataclass(frozen=True, slots=True)
class LeadShape:
    """How a lead is tried.

    `shortened` runs from 0 (as long as it may be) to 1 (as short as it may be). A line is turned by `angle_rad` from
    straight into the waste towards where the torch comes from; an arc, tangent to the cut, sweeps `angle_rad`.
    """

    kind: Literal["line", "arc"]
    shortened: float
    angle_rad: float


@dataclass(frozen=True, eq=False, slots=True)
class Leads(Rows):
    """Parallel arrays: `pierce` and `join` (m, 2), the bulge from one to the other and the length, mm."""

    pierce: Floats
    join: Floats
    bulge: Floats
    length_mm: Floats

    def points(self, left_out_mm: float = 0.0, most: float = 0.5) -> Floats:
        """Array (m, q, 2) of points along the leads, without the last `left_out_mm` before joining.

        No more than a share of `most` is left out of any lead.
        """
        until = 1 - np.minimum(left_out_mm / np.maximum(self.length_mm, 1e-9), most)
        if not self.bulge.any():
            last = self.pierce + until[:, None] * (self.join - self.pierce)
            return np.stack([self.pierce, last], axis=1)
        fraction = until[:, None] * np.linspace(0, 1, _POINTS)
        # On the circle through both ends the point a fraction f along lies, seen from the pierce, at
        # sin(f s / 2) / sin(s / 2) of the chord, turned by (f - 1) s / 2, where s is the sweep.
        half = 2 * np.arctan(self.bulge)[:, None]
        bent = np.abs(half) > 1e-9
        scale = np.where(bent, np.sin(half * fraction) / np.where(bent, np.sin(half), 1.0), fraction)
        turn = half * (fraction - 1)
        (dx, dy) = (self.join - self.pierce).T[:, :, None]
        x = self.pierce[:, :1] + scale * (np.cos(turn) * dx - np.sin(turn) * dy)
        y = self.pierce[:, 1:] + scale * (np.sin(turn) * dx + np.cos(turn) * dy)
        return np.stack([x, y], axis=2)


def shaped(shape: LeadShape, joints: Joints, along: Floats, longest_mm: Floats, shortest_mm: float) -> Leads:
    """Leads of one shape to all joints, where the torch then goes `along` (m, 2).

    Examples
    --------
    >>> at = Joints(*(np.array(a) for a in ([0], [0.0], [[0.0, 0.0]], [0.0], [[0.0, 0.0]], [[0.0, 1.0]])))
    >>> shaped(LeadShape("line", 0.0, 0.0), at, np.array([[1.0, 0.0]]), np.array([6.0]), 1.0).pierce.tolist()
    [[0.0, 6.0]]
    """
    length_mm = longest_mm * (shortest_mm / longest_mm) ** shape.shortened
    out, back = joints.out, -along
    if shape.kind == "line":
        ray = math.cos(shape.angle_rad) * out + math.sin(shape.angle_rad) * back
        return Leads(joints.join + length_mm[:, None] * ray, joints.join, np.zeros(len(joints)), length_mm)
    radius_mm = (length_mm / shape.angle_rad)[:, None]
    sideways, outwards = math.sin(shape.angle_rad), 1 - math.cos(shape.angle_rad)
    pierce = joints.join + radius_mm * (sideways * back + outwards * out)
    turn = np.sign(along[:, 0] * out[:, 1] - along[:, 1] * out[:, 0])
    return Leads(pierce, joints.join, turn * math.tan(shape.angle_rad / 4), length_mm)


# Ways to join contours: a joint, a direction and a lead to it.


@dataclass(frozen=True, eq=False, slots=True)
class Ways(Rows):
    """Joints with a direction each: `ccw`, and the unit vector `along` (m, 2) that the torch leaves the joint in."""

    joints: Joints
    ccw: Bools
    along: Floats


def ways(joints: Joints, outlines: Mapping[int, Outline], directions: Mapping[Kind, tuple[Direction, ...]]) -> Ways:
    """Each joint in all directions that its kind of contour may be cut in."""
    outer = np.array([outlines[k].contour.kind == "outer" for k in joints.contour.tolist()], dtype=np.bool_)
    row, ccw = [], []
    kinds: dict[Kind, Bools] = {"outer": outer, "hole": ~outer}
    for kind, of_kind in kinds.items():
        for direction in directions[kind]:
            rows = np.flatnonzero(of_kind)
            row.append(rows)
            ccw.append(np.full(len(rows), direction == "ccw"))
    rows, turns = np.concatenate([np.zeros(0, np.int64), *row]), np.concatenate([np.zeros(0, np.bool_), *ccw])
    order = np.argsort(rows, kind="stable")
    rows, turns = rows[order], turns[order]
    taken = joints.take(rows)
    # Counter-clockwise the waste of an outer contour is to the right, that of a hole to the left.
    side = np.where(turns == outer[rows], 1.0, -1.0)[:, None]
    along = side * np.column_stack([-taken.out[:, 1], taken.out[:, 0]])
    return Ways(taken, turns, along)


@dataclass(frozen=True, eq=False, slots=True)
class Approaches(Rows):
    """Ways with the lead of each; `edge` where it comes in from the edge of the sheet."""

    ways: Ways
    leads: Leads
    edge: Bools

    def in_order(self) -> Approaches:
        """The same in order of contour, entry, direction and kind."""
        joints = self.ways.joints
        return self.take(np.lexsort((self.edge, self.ways.ccw, joints.entry_mm, joints.contour)))


# The keys of a profile that set the options of leads, for messages.

IN_PROFILE = {
    "lead_in_mm": "leads.lead_in",
    "lead_in_min_mm": "leads.lead_in_min",
    "pierce_clearance_mm": "rules.pierce.clearance",
    "under": "small_holes.under",
    "least_mm": "small_holes.min_hole",
    "splash_mm": "rules.pierce.splash",
    "tabs": "rules.hold-small-parts",
    "common": "cuts.common",
    "narrow": "cuts.narrow",
    "corner_mm": "corners.leave",
}
"""What the people who read messages know these options as."""
