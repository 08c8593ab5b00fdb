"""The ways of a tilted torch: where it goes at the sheet's top face, how it leans there, and what it burns below."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point, Segment

from .bevel import BevelPass

_STEP_RAD = math.radians(3)
_CHORD_MM = 0.01


@dataclass(frozen=True, slots=True)
class Lean(BevelPass):
    """How a torch cuts along an edge: its angle, its root, and half the width of its cut, measured level, mm."""

    half_mm: float


@dataclass(frozen=True, slots=True)
class Step:
    """A line or an arc of the torch's point at the top face, and the direction in which its jet goes down, degrees.

    The direction turns evenly from `begin_deg` to `end_deg`, and the torch leans from `tilt_deg` to `end_tilt_deg`;
    where the segment has no length the torch turns, or leans, on the spot. `along` says that it cuts the contour; else
    it is a lead or a loop. Its cut is twice `half_mm` wide, level.
    """

    segment: Segment
    begin_deg: float
    end_deg: float
    along: bool
    tilt_deg: float
    end_tilt_deg: float
    half_mm: float

    @property
    def feed_share(self) -> float:
        """The share of the cut feed: the way through the metal is longer."""
        return math.cos(math.radians(max(abs(self.tilt_deg), abs(self.end_tilt_deg))))

    @property
    def upright(self) -> bool:
        """Whether the torch stands upright all the way."""
        return self.tilt_deg == self.end_tilt_deg == 0

    def swing_mm(self, thickness_mm: float) -> float:
        """How far the jet's end at the bottom face goes, at the most, where the torch turns or leans on the spot."""
        reach_mm = thickness_mm * math.tan(math.acos(self.feed_share))
        turned, leant = self.end_deg - self.begin_deg, self.end_tilt_deg - self.tilt_deg
        return math.radians(abs(turned)) * reach_mm + math.radians(abs(leant)) * thickness_mm / self.feed_share**2

    def moved(self, dx_mm: float, dy_mm: float) -> Step:
        """The same elsewhere."""
        (x0, y0), (x1, y1) = self.segment.start, self.segment.end
        return replace(self, segment=Segment((x0 + dx_mm, y0 + dy_mm), (x1 + dx_mm, y1 + dy_mm), self.segment.bulge))


@dataclass(frozen=True, eq=False, slots=True)
class TiltedPath:
    """One pass of a torch, from on to off, through a sheet.

    A torch of a block stands `aside_mm` of the point that the steps tell: so far to the left of the direction in which
    a jet leaves the part, and so far that way.
    """

    steps: tuple[Step, ...]
    thickness_mm: float = 0.0
    aside_mm: Point | None = None

    @property
    def tilt_deg(self) -> float:
        """How far it leans; where that changes, how far at the most."""
        return max((step.tilt_deg for step in self.steps), key=abs)

    @property
    def steady(self) -> bool:
        """Whether it leans alike all the way."""
        return len({tilt for step in self.steps for tilt in (step.tilt_deg, step.end_tilt_deg)}) == 1

    @property
    def half_mm(self) -> float:
        """Half the width of its cut, level, where that is widest."""
        return max(step.half_mm for step in self.steps)

    @property
    def feed_share(self) -> float:
        """The share of the cut feed that counts for its time as a whole."""
        if self.steady:
            return self.steps[0].feed_share
        slow_mm = ((s.segment.length_mm or s.swing_mm(self.thickness_mm)) / s.feed_share for s in self.steps)
        return self.length_mm / math.fsum(slow_mm)

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
        """As a plan has it: points at the top face, each with the bulge and the direction of the jet from there on.

        Where the torch does not lean alike all the way each has its angle, too.
        """
        rows = [[*s.segment.start, s.segment.bulge, s.begin_deg, float(s.along), s.tilt_deg] for s in self.steps]
        last = self.steps[-1]
        rows.append([*last.segment.end, 0.0, last.end_deg, float(last.along), last.end_tilt_deg])
        top = [[round(v, 6) + 0.0 for v in row[:4]] + [bool(row[4])] for row in rows]
        told = {"tilt": self.tilt_deg, "kerf": round(2 * self.half_mm, 6), "thickness": self.thickness_mm, "top": top}
        if not self.steady:
            told["tilts"] = [row[5] for row in rows]
        if self.aside_mm is not None:
            told["aside"] = [round(v, 6) for v in self.aside_mm]
        return told

    @staticmethod
    def of_json(data: Mapping[str, Any]) -> TiltedPath:
        """The same, read back."""
        rows, half_mm = data["top"], data["kerf"] / 2
        tilts = data.get("tilts", [data["tilt"]] * len(rows))
        steps = tuple(
            Step(Segment((a[0], a[1]), (b[0], b[1]), a[2]), a[3], b[3], a[4], tilt, end, half_mm)
            for (a, b), (tilt, end) in zip(pairwise(rows), pairwise(tilts), strict=True)
        )
        aside = data.get("aside")
        return TiltedPath(steps, data["thickness"], None if aside is None else (aside[0], aside[1]))

    def lines(self, depth_mm: float, along: bool | None = None) -> list[shapely.LineString]:
        """Its way at a depth: all of it in one line, or only the stretches that are, or are not, along the contour."""
        return [line for line, _ in self._ways(depth_mm, along, apart=False)]

    def burnt(self, depth_mm: float, along: bool | None = None) -> shapely.Geometry | None:
        """What it burns at a depth, of all of it or as `lines`; None for nothing."""
        ways: dict[float, list[shapely.LineString]] = {}
        for line, half_mm in self._ways(depth_mm, along, apart=True):
            ways.setdefault(half_mm, []).append(line)
        areas = [shapely.buffer(shapely.union_all(lines), half_mm) for half_mm, lines in ways.items()]
        return None if not areas else areas[0] if len(areas) == 1 else shapely.union_all(areas)

    def _ways(self, depth_mm: float, along: bool | None, apart: bool) -> Iterator[tuple[shapely.LineString, float]]:
        """Its stretches at a depth, each with half its width; `apart` where that changes."""
        points: list[tuple[float, float]] = []
        half_mm = self.steps[0].half_mm
        left_mm, out_mm = self.aside_mm or (0.0, 0.0)
        for step, rows in zip(self.steps, self._sampled(), strict=True):
            taken = along is None or step.along == along
            if points and (not taken or (apart and step.half_mm != half_mm)):
                yield shapely.LineString(points), half_mm
                points = []
            if taken:
                half_mm = step.half_mm
                out = out_mm + depth_mm * rows[:, 4:]
                below = rows[:, :2] + out * rows[:, 2:4] + left_mm * np.column_stack([-rows[:, 3], rows[:, 2]])
                points += [(x, y) for x, y in below[1 if points else 0 :].tolist()]
        if points:
            yield shapely.LineString(points), half_mm

    def _sampled(self) -> Iterator[Floats]:
        """Of each step points (m, 5): the torch's point, its jet's direction and slope; chords within 0.01 mm."""
        for step in self.steps:
            segment, turn = step.segment, math.radians(step.end_deg - step.begin_deg)
            leant = math.radians(step.end_tilt_deg - step.tilt_deg)
            widest = max(abs(turn), abs(leant))
            count = max(segment.chords_within(_CHORD_MM) if segment.is_arc else 1, math.ceil(widest / _STEP_RAD))
            share = np.linspace(0.0, 1.0, count + 1)
            points = np.array([segment.point_at(f) for f in share.tolist()])
            angle, tilt = math.radians(step.begin_deg) + turn * share, math.radians(step.tilt_deg) + leant * share
            yield np.column_stack([points, np.cos(angle), np.sin(angle), np.tan(tilt)])


def one_after_another(passes: Sequence[TiltedPath]) -> Sequence[TiltedPath]:
    """The passes that a torch goes along in turns: torches of a block go along the first of theirs together."""
    return passes[:1] if passes and passes[0].aside_mm is not None else passes


def within_turns(paths: Sequence[TiltedPath], most_deg: float) -> tuple[TiltedPath, ...] | None:
    """The paths with whole turns added, so that the head stays near its zero; None where that is beyond its end."""
    found = []
    for path in paths:
        angles = [angle for step in path.steps for angle in (step.begin_deg, step.end_deg)]
        low, high = min(angles), max(angles)
        turns = -round((low + high) / 2 / 360) * 360.0
        if max(high + turns, -low - turns) > most_deg + 1e-6:
            return None
        steps = tuple(replace(s, begin_deg=s.begin_deg + turns, end_deg=s.end_deg + turns) for s in path.steps)
        found.append(replace(path, steps=steps))
    return tuple(found)
