"""Once round a contour with a torch that leans: along its edges, round its corners, and from one angle to another.

A torch at one angle cuts along the contour as drawn at one depth, its root. Its way at every other depth is that way,
moved along the direction in which the torch leans. On straight edges that direction stays; on arcs it turns with them;
at a corner that bends away from the part the torch goes out past it and comes back in a loop, or turns about the corner
itself; at one that bends into the part it turns about the place where both edges meet.

Where single edges have bevels the torch changes its angle between two of them: in the loop past a sharp corner; else it
comes upright on the edge, goes on to the next, and leans there. At a sharp corner its jet runs through to the end of
the edge, else it stops half its width before, so that it stays off what lies ahead.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import shapely

from kerfwise.encoder.cut import Cut
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.offset import offset_curve
from kerfwise.encoder.geometry.segment import Point, Segment
from kerfwise.encoder.nest import Contour

from .tilted_path import Lean, Step, TiltedPath

Corner = Literal["either", "loop", "turn"]
SHARP_RAD = math.radians(30)
"""A corner that turns less is no sharp one: the torch turns about it."""
LEAST_LOOP_MM = 2.0
"""No loop is tighter than this: a head cannot follow."""
_SAME_RAD, _SAME_MM = 1e-4, 1e-6
_ON_RING_MM = 2e-3
_LEAN_DEG = 2.0
"""Where a torch leans on the spot its jet's root stays within 0.02 mm, if no move leans it further."""
Loops = tuple[tuple[Point, float], ...]
"""Corners of a contour as drawn that are cut by loops, each with how far past it the torch runs, mm."""
Joint = Literal["on", "loop", "through", "short"]
"""How an edge ends: on into the next at one angle, in a loop, upright past a sharp corner, or upright before it."""


@dataclass(frozen=True, eq=False, slots=True)
class Round:
    """A contour as drawn and how the torch leans along it: the way of the torch at the root, and its loops.

    Where edges differ, `leans` has the lean of each, and `lean` is upright. Of a pass along some edges alone `run` has
    them, in the order of the contour.
    """

    contour: Contour
    lean: Lean
    ccw: bool
    loops: Loops = ()
    leans: tuple[Lean, ...] = ()
    run: tuple[int, ...] = ()
    thickness_mm: float = 0.0
    apart_mm: float = 0.0

    @property
    def tilted(self) -> bool:
        """Whether a torch leans anywhere: along it, or in a block whose torches stand `apart_mm`."""
        return self.apart_mm > 0 or any(one.tilt_deg for one in (self.lean, *self.leans))

    @property
    def ring(self) -> Curve:
        """The way of the torch at the root, closed; where edges differ, that of an upright one.

        Raises ValueError if the kerf leaves nothing of the contour.
        """
        outwards = self.lean.half_mm if self.contour.kind == "outer" else -self.lean.half_mm
        return offset_curve(self.contour.curve, outwards).towards("ccw" if self.ccw else "cw")

    @property
    def waste_on_right(self) -> bool:
        """Whether the waste is on the right of the torch as it goes."""
        return (self.contour.kind == "outer") == self.ccw

    def direction_rad(self, tangent: Point) -> float:
        """The direction from the part to the waste, where the torch goes this way."""
        x, y = tangent
        return math.atan2(-x, y) if self.waste_on_right else math.atan2(x, -y)

    def at_top(self, on_ring: Point, direction_rad: float, lean: Lean) -> Point:
        """The torch's point at the top face, where its cut at the root is beside a point of the ring."""
        by = lean.slope * lean.root_mm - (lean.half_mm - self.lean.half_mm)
        return on_ring[0] - by * math.cos(direction_rad), on_ring[1] - by * math.sin(direction_rad)

    def edge_of(self, segment: Segment) -> int:
        """The number of the edge that a piece of the ring runs along."""
        middle = segment.point_at(0.5)
        return int(np.argmin([abs(one.project(middle)[1] - self.lean.half_mm) for one in self.contour.curve.segments]))

    def lean_of(self, segment: Segment) -> Lean:
        """How the torch leans along a piece of the ring."""
        return self.leans[self.edge_of(segment)] if self.leans else self.lean

    def corner_of(self, segment: Segment) -> Point | None:
        """The corner as drawn that a piece of the ring goes round; None for any other piece."""
        if not segment.is_arc or abs(segment.radius_mm - self.lean.half_mm) > _ON_RING_MM:
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
        """The corners as drawn that bend away from the part, are sharp, and that a leaning torch comes to or leaves."""
        segments = self.ring.segments
        for before, segment, after in zip(
            (segments[-1], *segments), segments, (*segments[1:], segments[0]), strict=False
        ):
            least = _SAME_RAD if self.apart_mm else SHARP_RAD
            if abs(segment.sweep_rad) >= least and (corner := self.corner_of(segment)) is not None:
                leans = [self.lean_of(before), self.lean_of(after)]
                if self.run and {self.edge_of(before), self.edge_of(after)} - {*self.run}:
                    continue
                if self.apart_mm or any(one.tilt_deg for one in leans):
                    yield corner

    def turn_between(self, before: Segment, after: Segment) -> float:
        """How far the ring turns from one piece to another, rad: more than nothing away from the part."""
        turn = _turn(before.tangent_at(1.0), after.tangent_at(0.0))
        return turn if self.waste_on_right else -turn


def pass_along(way: Round, cut: Cut, main_half_mm: float) -> TiltedPath:
    """The pass that belongs to a cut, whose leads join the way that is `main_half_mm` off the contour.

    Raises ValueError if the kerf leaves nothing of the contour; if the torch would be pierced at a corner, or would run
    into a loop.
    """
    ring = way.ring
    join = cut.pierce if cut.lead_in is None else _end(cut.lead_in)
    at_mm, _ = ring.project(join)
    walk = _Walk(way, ring, at_mm)
    if _at_corner(way, ring, at_mm):
        raise ValueError("the torch cannot begin at a corner")
    by = way.lean.half_mm - main_half_mm
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
    return TiltedPath(tuple(walk.steps))


def round_alone(way: Round) -> TiltedPath:
    """The pass without leads, from the middle of the longest piece of its ring on."""
    ring = way.ring
    lengths = [0.0 if way.corner_of(s) is not None else s.length_mm for s in ring.segments]
    k = int(np.argmax(lengths))
    at_mm = float(ring.starts_mm[k]) + lengths[k] / 2
    walk = _Walk(way, ring, at_mm)
    walk.round(ring.opened_at(at_mm))
    return TiltedPath(tuple(walk.steps))


def run_along(way: Round, run_mm: float) -> TiltedPath:
    """The pass along some edges alone, from the waste before the first of them, with where it begins and ends.

    At a sharp corner it comes from `run_mm` before and goes on as far; else it begins so far beside the edge, and ends
    on it. Raises ValueError if the edges are too short for it.
    """
    ring = way.ring
    segments = ring.segments
    of = [None if way.corner_of(s) is not None else way.edge_of(s) for s in segments]
    count = len(segments)
    on = [k for k in range(count) if of[k] in way.run]
    if not on:
        raise ValueError("the kerf leaves nothing of the edge")
    mine = {*on, *(k for k in range(count) if of[k] is None and {(k - 1) % count, (k + 1) % count} <= {*on})}
    first = next((k for k in on if (k - 1) % count not in mine), on[0])
    last = next(k for k in (*range(first, count), *range(first)) if k in mine and (k + 1) % count not in mine)
    start_mm = float(ring.starts_mm[first])
    length_mm = (float(ring.starts_mm[last]) + segments[last].length_mm - start_mm) % ring.length_mm
    through = []
    for k, after in ((first, False), (last, True)):
        there = (k + 1) % count if after else (k - 1) % count
        beyond = there if of[there] is not None else (there + 1) % count if after else (there - 1) % count
        turn = (
            way.turn_between(segments[k], segments[beyond])
            if after
            else way.turn_between(segments[beyond], segments[k])
        )
        through.append(turn >= SHARP_RAD)
    begin_mm = 0.0 if through[0] else _clip_mm(way, segments[first], at_end=False)
    end_mm = 0.0 if through[1] else _clip_mm(way, segments[last], at_end=True)
    if length_mm - begin_mm - end_mm < _LEAST_EDGE_MM:
        raise ValueError("the edge is too short for its bevel")
    path = ring.between(start_mm + begin_mm, length_mm - begin_mm - end_mm)
    walk = _Walk(way, ring, start_mm + begin_mm)
    x, y = path.segments[0].tangent_at(0.0) if through[0] else (-math.cos(walk.angle), -math.sin(walk.angle))
    at = path.segments[0].start
    walk.lead(Curve.of([(at[0] - run_mm * x, at[1] - run_mm * y), at], closed=False))
    walk.round(path)
    if through[1]:
        (x, y), at = path.segments[-1].tangent_at(1.0), path.segments[-1].end
        walk.lead(Curve.of([at, (at[0] + run_mm * x, at[1] + run_mm * y)], closed=False))
    return TiltedPath(tuple(walk.steps))


_LEAST_EDGE_MM = 1.0


def _clip_mm(way: Round, segment: Segment, at_end: bool) -> float:
    """How far before its end the jet must leave an edge, so that it stays off what lies ahead."""
    lean = way.lean_of(segment)
    area = shapely.buffer(shapely.make_valid(way.contour.polygon), -_ON_RING_MM)
    metal = area if way.contour.kind == "outer" else shapely.difference(shapely.buffer(area, 9 * lean.half_mm), area)
    by_mm, length_mm = lean.half_mm, segment.length_mm
    into_mm = lean.slope * (lean.root_mm if lean.tilt_deg > 0 else lean.root_mm - way.thickness_mm)
    if segment.is_arc and (segment.sweep_rad > 0) == way.waste_on_right:  # deep in the part arcs are shorter
        by_mm *= segment.radius_mm / max(segment.radius_mm - into_mm - lean.half_mm, _ON_RING_MM)
    shift = lean.half_mm - way.lean.half_mm
    while by_mm < length_mm:
        share = 1 - by_mm / length_mm if at_end else by_mm / length_mm
        angle, (x, y) = way.direction_rad(segment.tangent_at(share)), segment.point_at(share)
        disc = shapely.buffer(shapely.Point(x + shift * math.cos(angle), y + shift * math.sin(angle)), lean.half_mm)
        if not shapely.intersects(disc, metal):
            return by_mm
        by_mm += lean.half_mm / 4
    raise ValueError("the edge is too short for its bevel")


class _Walk:
    """The steps so far; `angle` is the direction of the jet, rad, counted on as the torch turns, `lean` its angle."""

    def __init__(self, way: Round, ring: Curve, at_mm: float) -> None:
        self.way, self.angle = way, way.direction_rad(ring.tangent_at(at_mm))
        self.lean = way.lean_of(ring.segments[ring.locate(at_mm)[0]])
        self.steps: list[Step] = []

    def _add(
        self,
        start: Point,
        end: Point,
        bulge: float,
        turn: float,
        along: bool,
        to: Lean | None = None,
        till: float | None = None,
    ) -> None:
        """A step; the torch leans as it does, or as far as `to`, `till` how many degrees."""
        begin, self.angle = self.angle, self.angle + turn
        tilt = self.steps[-1].end_tilt_deg if to is not None and self.steps else self.lean.tilt_deg
        end_tilt = tilt if till is None else till
        half_mm = self.lean.half_mm if to is None else max(self.lean.half_mm, to.half_mm)
        if (
            self.steps
            and (last := self.steps[-1]).upright
            and abs(last.end_deg - math.degrees(begin)) > math.degrees(_SAME_RAD)
        ):
            self.steps[-1] = replace(last, end_deg=math.degrees(begin))  # the head turns on the way: it stands upright
        ends = math.degrees(begin), math.degrees(self.angle)
        self.steps.append(Step(Segment(start, end, bulge), *ends, along, tilt, end_tilt, half_mm))

    def _at_top(self, at: Point, angle: float) -> Point:
        return self.way.at_top(at, angle, self.lean)

    def lead(self, path: Curve) -> None:
        """Follow a lead, the torch leaning as where it joins."""
        for segment in path.segments:
            start, end = (self._at_top(at, self.angle) for at in (segment.start, segment.end))
            self._add(start, end, segment.bulge, 0.0, along=False)

    def round(self, path: Curve) -> None:
        """Follow an open stretch of the ring."""
        segments = path.segments
        corners = [self.way.corner_of(segment) for segment in segments]
        for n, (segment, corner) in enumerate(zip(segments, corners, strict=True)):
            if n:
                self._pivot(segment.start, _turn(segments[n - 1].tangent_at(1.0), segment.tangent_at(0.0)))
            if corner is None:
                begins = "on" if n == 0 else self._joint(segments, corners, n - 1 if corners[n - 1] is None else n - 2)
                ends = self._joint(segments, corners, n)
                self._along(segment, begins, ends)
            elif (run_mm := self._run_mm(corner)) is not None:
                to = self.way.lean_of(segments[n + 1]) if n + 1 < len(segments) else self.lean
                self._loop(segment, run_mm, to)
            else:
                self._turned(segment)

    def _joint(self, segments: tuple[Segment, ...], corners: list[Point | None], n: int) -> Joint:
        """How an edge of the path, whose number is told, ends."""
        corner = corners[n + 1] if n + 1 < len(segments) else None
        after = n + 1 if corner is None else n + 2
        if n < 0 or after >= len(segments):
            return "on"
        if corner is not None and self._run_mm(corner) is not None:
            return "loop"
        turn = self.way.turn_between(segments[n], segments[after])
        same = self.way.lean_of(segments[n]) == self.way.lean_of(segments[after])
        if same and (not self.way.leans or turn > -SHARP_RAD or self.way.lean_of(segments[n]).tilt_deg == 0):
            return "on"
        return "through" if turn >= SHARP_RAD else "short"

    def _along(self, segment: Segment, begins: Joint, ends: Joint) -> None:
        """A piece of the ring along an edge."""
        lean, upright = self.way.lean_of(segment), self.way.lean
        if lean.tilt_deg == 0 or (begins in ("on", "loop") and ends in ("on", "loop")):
            self._turned(segment)
            return
        low = _clip_mm(self.way, segment, at_end=False) / segment.length_mm if begins == "short" else 0.0
        high = 1 - _clip_mm(self.way, segment, at_end=True) / segment.length_mm if ends == "short" else 1.0
        if (high - low) * segment.length_mm < _LEAST_EDGE_MM:
            raise ValueError("the edge is too short for its bevel")
        if low > 0:
            self._turned(segment.between(0.0, low))
        if self.lean != lean:
            self._lean(segment.point_at(low), lean)
        self._turned(segment.between(low, high) if high - low < 1 else segment)
        if ends in ("through", "short"):
            self._lean(segment.point_at(high), upright)
        if high < 1:
            self._turned(segment.between(high, 1.0))

    def _lean(self, at: Point, to: Lean) -> None:
        """Lean otherwise, beside a place of the ring where the jet's root stays."""
        start = self.lean
        count = math.ceil(abs(to.tilt_deg - start.tilt_deg) / _LEAN_DEG)
        for k in range(1, count + 1):
            tilt = start.tilt_deg + (to.tilt_deg - start.tilt_deg) * k / count
            root_mm = to.root_mm if to.tilt_deg else start.root_mm
            half_mm = start.half_mm + (to.half_mm - start.half_mm) * k / count
            now = Lean(tilt, root_mm, half_mm)
            begin = self._at_top(at, self.angle)
            before, self.lean = self.lean, now
            self._lean_step(begin, self._at_top(at, self.angle), before)
        self.lean = to

    def _lean_step(self, start: Point, end: Point, before: Lean) -> None:
        if self.steps and (last := self.steps[-1]).upright:
            self.steps[-1] = replace(last, end_deg=math.degrees(self.angle))
        degrees, half_mm = math.degrees(self.angle), max(before.half_mm, self.lean.half_mm)
        segment = Segment(start, start if math.dist(start, end) < _SAME_MM else end)
        self.steps.append(Step(segment, degrees, degrees, True, before.tilt_deg, self.lean.tilt_deg, half_mm))

    def _turned(self, segment: Segment) -> None:
        """A piece of the ring; where it is an arc its way at the top goes about the same middle."""
        turn = segment.sweep_rad
        start, end = self._at_top(segment.start, self.angle), self._at_top(segment.end, self.angle + turn)
        still = math.dist(start, end) < _SAME_MM
        bulge = 0.0 if still or not segment.is_arc else math.tan(turn / 4)
        self._add(start, start if still else end, bulge, turn, along=True)

    def _pivot(self, at: Point, turn: float) -> None:
        """Turn about a place at the root, where two edges meet."""
        if abs(turn) < _SAME_RAD:
            return
        start, end = self._at_top(at, self.angle), self._at_top(at, self.angle + turn)
        still = math.dist(start, end) < _SAME_MM
        if still and self.way.leans and self.lean.tilt_deg == 0:
            self.angle += turn
            return
        self._add(start, start if still else end, 0.0 if still else math.tan(turn / 4), turn, along=True)

    def _run_mm(self, corner: Point) -> float | None:
        near = (run for at, run in self.way.loops if math.dist(at, corner) < _ON_RING_MM)
        return next(near, None)

    def _loop(self, segment: Segment, run_mm: float, to: Lean) -> None:
        """Go on past a corner, back in an arc outside it, and on along the other edge, leaning as that wants."""
        turn, before = segment.sweep_rad, self.lean
        (ux, uy), (vx, vy) = segment.tangent_at(0.0), segment.tangent_at(1.0)
        (ax, ay), (bx, by) = (
            self.way.at_top(segment.start, self.angle, before),
            self.way.at_top(segment.end, self.angle + turn, to),
        )
        cross = ux * vy - uy * vx
        to_meet = ((bx - ax) * vy - (by - ay) * vx) / cross  # along the first edge to where both meet
        reach = run_mm - to_meet
        run_out = run_in = run_mm
        if to != before:
            from_meet = ((bx - ax) * uy - (by - ay) * ux) / cross  # along the other, from there
            reach = max(reach, run_mm + from_meet)
            run_out, run_in = reach + to_meet, reach - from_meet
        radius = reach / math.tan(abs(turn) / 2)
        if min(reach, radius) < LEAST_LOOP_MM:
            raise ValueError("the run past a corner is too short for a loop")
        first, last = (ax + run_out * ux, ay + run_out * uy), (bx - run_in * vx, by - run_in * vy)
        side = -1.0 if turn > 0 else 1.0  # the loop goes the other way round
        cx, cy = first[0] - side * uy * radius, first[1] + side * ux * radius
        sweep = side * (math.tau - abs(turn))
        half = math.atan2(first[1] - cy, first[0] - cx) + sweep / 2
        middle = cx + radius * math.cos(half), cy + radius * math.sin(half)
        halfway = (before.tilt_deg + to.tilt_deg) / 2
        self._add((ax, ay), first, 0.0, 0.0, along=False)
        self._add(first, middle, math.tan(sweep / 8), turn / 2, along=False, to=to, till=halfway)
        self._add(middle, last, math.tan(sweep / 8), turn / 2, along=False, to=to, till=to.tilt_deg)
        self.lean = to
        self._add(last, (bx, by), 0.0, 0.0, along=False)


def _turn(before: Point, after: Point) -> float:
    """How far the direction turns from one tangent to the next, rad."""
    (ax, ay), (bx, by) = before, after
    return math.atan2(ax * by - ay * bx, ax * bx + ay * by)


def _at_corner(way: Round, ring: Curve, at_mm: float) -> bool:
    """Whether a place on the ring is a corner, or lies on the arc round one, or where the torch changes its angle."""
    k, share = ring.locate(at_mm)
    segments = ring.segments
    around = [segments[k]]
    near_mm = _ON_RING_MM
    if way.leans and (lean := way.lean_of(segments[k])).tilt_deg:
        near_mm = 3 * lean.half_mm
    if share * segments[k].length_mm < near_mm:
        around.append(segments[k - 1])
    if (1 - share) * segments[k].length_mm < near_mm:
        around.append(segments[(k + 1) % len(segments)])
    if any(way.corner_of(one) is not None for one in around) or (len(around) > 1 and near_mm > _ON_RING_MM):
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
