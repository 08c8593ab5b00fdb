"""The ways of a tilted torch: where it goes at the sheet's top face, which way it leans there, and what it burns below.

A torch at one angle cuts along the contour as drawn at one depth, its root. Its way at every other depth is that way,
moved along the direction in which the torch leans. On straight edges that direction stays; on arcs it turns with them;
at a corner that bends away from the part the torch goes out past it and comes back in a loop, or turns about the corner
itself; at one that bends into the part it turns about the place where both edges meet.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any, Literal

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.cut import Cut
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.offset import offset_curve
from kerfwise.encoder.geometry.segment import Point, Segment
from kerfwise.encoder.nest import Contour

from .bevel import BevelPass

Corner = Literal["either", "loop", "turn"]
SHARP_RAD = math.radians(30)
"""A corner that turns less is no sharp one: the torch turns about it."""
LEAST_LOOP_MM = 2.0
"""No loop is tighter than this: a head cannot follow."""
_SAME_RAD, _SAME_MM = 1e-4, 1e-6
_ON_RING_MM = 2e-3
_STEP_RAD = math.radians(3)
_CHORD_MM = 0.01
Loops = tuple[tuple[Point, float], ...]
"""Corners of a contour as drawn that are cut by loops, each with how far past it the torch runs, mm."""


@dataclass(frozen=True, slots=True)
class Step:
    """A line or an arc of the torch's point at the top face, and the direction in which its jet goes down, degrees.

    The direction turns evenly from `begin_deg` to `end_deg`; where the segment has no length the torch turns on the
    spot. `along` says that it cuts the contour; else it is a lead or a loop.
    """

    segment: Segment
    begin_deg: float
    end_deg: float
    along: bool

    def moved(self, dx_mm: float, dy_mm: float) -> Step:
        """The same elsewhere."""
        (x0, y0), (x1, y1) = self.segment.start, self.segment.end
        there = Segment((x0 + dx_mm, y0 + dy_mm), (x1 + dx_mm, y1 + dy_mm), self.segment.bulge)
        return Step(there, self.begin_deg, self.end_deg, self.along)


@dataclass(frozen=True, eq=False, slots=True)
class TiltedPath:
    """One pass of a torch at `tilt_deg`, from on to off, through a sheet; its cut is twice `half_mm` wide, level."""

    steps: tuple[Step, ...]
    tilt_deg: float
    half_mm: float
    thickness_mm: float = 0.0

    @property
    def slope(self) -> float:
        """How far the jet goes sideways for each mm that it goes down."""
        return math.tan(math.radians(self.tilt_deg))

    @property
    def feed_share(self) -> float:
        """The share of the cut feed: the way through the metal is longer."""
        return math.cos(math.radians(self.tilt_deg))

    @property
    def start(self) -> Point:
        """Where the torch is switched on."""
        return self.steps[0].segment.start

    @property
    def length_mm(self) -> float:
        """How far the torch's point goes."""
        return math.fsum(step.segment.length_mm for step in self.steps)

    @property
    def curve(self) -> Curve:
        """The way of its point; where it turns on the spot there is nothing."""
        rows = [(*step.segment.start, step.segment.bulge) for step in self.steps if step.segment.length_mm > 0]
        return Curve.of([*rows, (*self.steps[-1].segment.end, 0.0)], closed=False)

    def moved(self, dx_mm: float, dy_mm: float) -> TiltedPath:
        """The same elsewhere."""
        return replace(self, steps=tuple(step.moved(dx_mm, dy_mm) for step in self.steps))

    def as_json(self) -> dict[str, Any]:
        """As a plan has it: points at the top face, each with the bulge and the direction of the jet from there on."""
        rows = [[*s.segment.start, s.segment.bulge, s.begin_deg, float(s.along)] for s in self.steps]
        last = self.steps[-1]
        rows.append([*last.segment.end, 0.0, last.end_deg, float(last.along)])
        top = [[round(v, 6) + 0.0 for v in row[:4]] + [bool(row[4])] for row in rows]
        return {"tilt": self.tilt_deg, "kerf": round(2 * self.half_mm, 6), "thickness": self.thickness_mm, "top": top}

    @staticmethod
    def of_json(data: Mapping[str, Any]) -> TiltedPath:
        """The same, read back."""
        steps = tuple(
            Step(Segment((a[0], a[1]), (b[0], b[1]), a[2]), a[3], b[3], a[4]) for a, b in pairwise(data["top"])
        )
        return TiltedPath(steps, data["tilt"], data["kerf"] / 2, data["thickness"])

    def lines(self, depth_mm: float, along: bool | None = None) -> list[shapely.LineString]:
        """Its way at a depth: all of it in one line, or only the stretches that are, or are not, along the contour."""
        lines: list[list[tuple[float, float]]] = []
        for step, rows in zip(self.steps, self._sampled(), strict=True):
            if along is not None and step.along != along:
                lines.append([])
                continue
            below = (rows[:, :2] + depth_mm * self.slope * rows[:, 2:]).tolist()
            if lines and lines[-1]:
                lines[-1] += [(x, y) for x, y in below[1:]]
            else:
                lines.append([(x, y) for x, y in below])
        return [shapely.LineString(points) for points in lines if len(points) > 1]

    def _sampled(self) -> Iterator[Floats]:
        """Of each step points (m, 4): the torch's point and the direction of its jet, chords within 0.01 mm."""
        for step in self.steps:
            segment, turn = step.segment, math.radians(step.end_deg - step.begin_deg)
            count = max(segment.chords_within(_CHORD_MM) if segment.is_arc else 1, math.ceil(abs(turn) / _STEP_RAD))
            share = np.linspace(0.0, 1.0, count + 1)
            points = np.array([segment.point_at(f) for f in share.tolist()])
            angle = math.radians(step.begin_deg) + turn * share
            yield np.column_stack([points, np.cos(angle), np.sin(angle)])


@dataclass(frozen=True, eq=False, slots=True)
class Edge:
    """A contour as drawn with a pass along it: the way of the torch at the root, the way it goes, and its loops."""

    contour: Contour
    made_by: BevelPass
    half_mm: float
    ccw: bool
    loops: Loops = ()

    @property
    def ring(self) -> Curve:
        """The way of the torch at the root, closed.

        Raises
        ------
        ValueError
            If the kerf leaves nothing of the contour.
        """
        outwards = self.half_mm if self.contour.kind == "outer" else -self.half_mm
        return offset_curve(self.contour.curve, outwards).towards("ccw" if self.ccw else "cw")

    @property
    def _waste_on_right(self) -> bool:
        return (self.contour.kind == "outer") == self.ccw

    def direction_rad(self, tangent: Point) -> float:
        """The direction from the part to the waste, where the torch goes this way."""
        x, y = tangent
        return math.atan2(-x, y) if self._waste_on_right else math.atan2(x, -y)

    def at_top(self, root: Point, direction_rad: float) -> Point:
        """The torch's point at the top face, where its cut goes through a point at the root."""
        by = self.made_by.slope * self.made_by.root_mm
        return root[0] - by * math.cos(direction_rad), root[1] - by * math.sin(direction_rad)

    def corner_of(self, segment: Segment) -> Point | None:
        """The corner as drawn that a piece of the ring goes round; None for any other piece."""
        if not segment.is_arc or abs(segment.radius_mm - self.half_mm) > _ON_RING_MM:
            return None
        at, centre = self.contour.curve.vertices[:, :2], np.array(segment.centre)
        apart = np.hypot(*(at - centre).T)
        k = int(np.argmin(apart))
        if apart[k] > _ON_RING_MM or self._turns_at(k) < _SAME_RAD:
            return None
        return float(at[k, 0]), float(at[k, 1])

    def _turns_at(self, vertex: int) -> float:
        """How far the contour turns at a vertex, rad."""
        segments, at = self.contour.curve.segments, self.contour.curve.vertices[vertex, :2]
        after = next((s for s in segments if math.dist(s.start, at) < _SAME_MM), None)
        before = next((s for s in segments if math.dist(s.end, at) < _SAME_MM), None)
        if after is None or before is None:
            return 0.0
        return abs(_turn(before.tangent_at(1.0), after.tangent_at(0.0)))

    def sharp_corners(self) -> Iterator[Point]:
        """The corners as drawn that bend away from the part, and are sharp."""
        for segment in self.ring.segments:
            if abs(segment.sweep_rad) >= SHARP_RAD and (corner := self.corner_of(segment)) is not None:
                yield corner


def pass_along(edge: Edge, cut: Cut, main_half_mm: float) -> TiltedPath:
    """The pass of an edge that belongs to a cut, whose leads join the way that is `main_half_mm` off the contour.

    Raises
    ------
    ValueError
        If the kerf leaves nothing of the contour; if the torch would be pierced at a corner, or would run into a loop.
    """
    ring = edge.ring
    join = cut.pierce if cut.lead_in is None else _end(cut.lead_in)
    at_mm, _ = ring.project(join)
    walk = _Walk(edge, ring.tangent_at(at_mm))
    if _at_corner(edge, ring, at_mm):
        raise ValueError("the torch cannot begin at a corner")
    by = edge.half_mm - main_half_mm
    x, y = by * math.cos(walk.angle), by * math.sin(walk.angle)
    if cut.lead_in is not None:
        walk.lead(cut.lead_in.moved(x, y))
    walk.round(ring.opened_at(at_mm))
    if cut.lead_out is not None and cut.lead_out.segments:
        off = [ring.project(cut.lead_out.moved(x, y).point_at(s))[1] for s in (0.0, cut.lead_out.length_mm)]
        if max(off) <= _ON_RING_MM:
            walk.round(ring.between(at_mm, cut.lead_out.length_mm))
        else:
            walk.lead(cut.lead_out.moved(x, y))
    return TiltedPath(tuple(walk.steps), edge.made_by.tilt_deg, edge.half_mm)


def round_alone(edge: Edge) -> TiltedPath:
    """The pass of an edge without leads, from the middle of the longest piece of its ring on."""
    ring = edge.ring
    lengths = [0.0 if edge.corner_of(s) is not None else s.length_mm for s in ring.segments]
    k = int(np.argmax(lengths))
    at_mm = float(ring.starts_mm[k]) + lengths[k] / 2
    walk = _Walk(edge, ring.tangent_at(at_mm))
    walk.round(ring.opened_at(at_mm))
    return TiltedPath(tuple(walk.steps), edge.made_by.tilt_deg, edge.half_mm)


class _Walk:
    """The steps so far; `angle` is the direction of the jet, rad, counted on as the torch turns."""

    def __init__(self, edge: Edge, tangent: Point) -> None:
        self.edge, self.angle = edge, edge.direction_rad(tangent)
        self.steps: list[Step] = []

    def _add(self, start: Point, end: Point, bulge: float, turn: float, along: bool) -> None:
        begin, self.angle = self.angle, self.angle + turn
        self.steps.append(Step(Segment(start, end, bulge), math.degrees(begin), math.degrees(self.angle), along))

    def lead(self, path: Curve) -> None:
        """Follow a lead, the torch leaning as where it joins."""
        for segment in path.segments:
            start, end = (self.edge.at_top(at, self.angle) for at in (segment.start, segment.end))
            self._add(start, end, segment.bulge, 0.0, along=False)

    def round(self, path: Curve) -> None:
        """Follow an open stretch of the ring."""
        segments = path.segments
        for before, segment in pairwise((None, *segments)):
            assert segment is not None
            if before is not None:
                self._pivot(segment.start, _turn(before.tangent_at(1.0), segment.tangent_at(0.0)))
            corner = self.edge.corner_of(segment)
            run_mm = None if corner is None else self._run_mm(corner)
            if run_mm is not None:
                self._loop(segment, run_mm)
                continue
            start = self.edge.at_top(segment.start, self.angle)
            end = self.edge.at_top(segment.end, self.angle + segment.sweep_rad)
            self._turned(start, end, segment, segment.sweep_rad)

    def _turned(self, start: Point, end: Point, segment: Segment, turn: float) -> None:
        """A piece of the ring; where it is an arc its way at the top goes about the same middle."""
        still = math.dist(start, end) < _SAME_MM
        bulge = 0.0 if still or not segment.is_arc else math.tan(turn / 4)
        self._add(start, start if still else end, bulge, turn, along=True)

    def _pivot(self, at: Point, turn: float) -> None:
        """Turn about a place at the root, where two edges meet."""
        if abs(turn) < _SAME_RAD:
            return
        start, end = self.edge.at_top(at, self.angle), self.edge.at_top(at, self.angle + turn)
        still = math.dist(start, end) < _SAME_MM
        self._add(start, start if still else end, 0.0 if still else math.tan(turn / 4), turn, along=True)

    def _run_mm(self, corner: Point) -> float | None:
        near = (run for at, run in self.edge.loops if math.dist(at, corner) < _ON_RING_MM)
        return next(near, None)

    def _loop(self, segment: Segment, run_mm: float) -> None:
        """Go on past a corner, back in an arc outside it, and on along the other edge."""
        turn = segment.sweep_rad
        (ux, uy), (vx, vy) = segment.tangent_at(0.0), segment.tangent_at(1.0)
        (ax, ay), (bx, by) = (
            self.edge.at_top(segment.start, self.angle),
            self.edge.at_top(segment.end, self.angle + turn),
        )
        to_meet = ((bx - ax) * vy - (by - ay) * vx) / (ux * vy - uy * vx)  # along the first edge to where both meet
        reach = run_mm - to_meet
        radius = reach / math.tan(abs(turn) / 2)
        if min(reach, radius) < LEAST_LOOP_MM:
            raise ValueError("the run past a corner is too short for a loop")
        first, last = (ax + run_mm * ux, ay + run_mm * uy), (bx - run_mm * vx, by - run_mm * vy)
        side = -1.0 if turn > 0 else 1.0  # the loop goes the other way round
        cx, cy = first[0] - side * uy * radius, first[1] + side * ux * radius
        sweep = side * (math.tau - abs(turn))
        half = math.atan2(first[1] - cy, first[0] - cx) + sweep / 2
        middle = cx + radius * math.cos(half), cy + radius * math.sin(half)
        self._add((ax, ay), first, 0.0, 0.0, along=False)
        self._add(first, middle, math.tan(sweep / 8), turn / 2, along=False)
        self._add(middle, last, math.tan(sweep / 8), turn / 2, along=False)
        self._add(last, (bx, by), 0.0, 0.0, along=False)


def _turn(before: Point, after: Point) -> float:
    """How far the direction turns from one tangent to the next, rad."""
    (ax, ay), (bx, by) = before, after
    return math.atan2(ax * by - ay * bx, ax * bx + ay * by)


def _at_corner(edge: Edge, ring: Curve, at_mm: float) -> bool:
    """Whether a place on the ring is a corner, or lies on the arc round one."""
    k, share = ring.locate(at_mm)
    segments = ring.segments
    around = [segments[k]]
    if share * segments[k].length_mm < _ON_RING_MM:
        around.append(segments[k - 1])
    if (1 - share) * segments[k].length_mm < _ON_RING_MM:
        around.append(segments[(k + 1) % len(segments)])
    if any(edge.corner_of(one) is not None for one in around):
        return True
    return any(
        abs(_turn(around[0].tangent_at(a), one.tangent_at(1 - a))) > _SAME_RAD
        for one in around[1:]
        for a in (0, 1)
        if math.dist(around[0].point_at(a), one.point_at(1 - a)) < _SAME_MM
    )


def _end(path: Curve) -> Point:
    x, y = path.vertices[-1, :2].tolist()
    return x, y


def within_turns(paths: Sequence[TiltedPath], most_deg: float) -> tuple[TiltedPath, ...] | None:
    """The paths with whole turns added, so that the head stays near its zero; None where that is beyond its end."""
    found = []
    for path in paths:
        angles = [angle for step in path.steps for angle in (step.begin_deg, step.end_deg)]
        low, high = min(angles), max(angles)
        turns = -round((low + high) / 2 / 360) * 360.0
        if max(high + turns, -low - turns) > most_deg + 1e-6:
            return None
        steps = tuple(Step(s.segment, s.begin_deg + turns, s.end_deg + turns, s.along) for s in path.steps)
        found.append(replace(path, steps=steps))
    return tuple(found)
