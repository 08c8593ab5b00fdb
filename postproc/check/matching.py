"""Which contour of the nest a torch-on path cuts, found by geometry."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.cut import Cut, Tab
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.measures import beyond_mm
from kerfwise.encoder.geometry.segment import Box
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.torch_path import LONGEST_MM
from kerfwise.postproc.check.reader.program import Burn
from kerfwise.rules.judging.violation import Violation

from .contour_following import surely_cover
from .torch_run import Side, TorchRun, line_of, rings_of, step_mm, tolerance_mm, torch_rings

NEAR_MM = 2.0
"""A path further than this from every contour's ring cuts something that is not in the nest."""
_SAMPLES = 24
_AT_ONCE = 256
_RIGHT: tuple[Side, ...] = ("right",)
_OTHER: tuple[Side, ...] = ("wrong", "on")


@dataclass(frozen=True, eq=False, slots=True)
class Match:
    """The contour a path cuts (its index in the nest), the ring it follows there, and how far off the ring is, mm.

    `deviation_mm` is 0 where the path is off by no more than it may be.
    """

    contour: int
    side: Side
    ring: shapely.LineString
    deviation_mm: float


class Matcher:
    """The rings of one nest, to match paths against."""

    def __init__(self, nest: Nest, kerf_mm: float) -> None:
        self.nest, self.kerf_mm = nest, kerf_mm
        self.rings = rings_of(nest, kerf_mm)
        self._lines = np.array([r if r is not None else shapely.LineString() for r in self.rings], dtype=object)
        self._tree = shapely.STRtree(self._lines)

    def match(
        self, lines: Sequence[shapely.LineString], marks: Sequence[bool], named: Sequence[int | None]
    ) -> list[Match | None]:
        """One match a path, None where no contour's ring lies along it.

        `marks` says that the path was made by another tool than the torch, `named` the contour that a comment before
        it names: that decides only between rings that the path follows equally well.
        """
        found = self._as_named(lines, marks, named)
        left = [k for k, known in enumerate(found) if known is None]
        voted = self._by_votes([lines[k] for k in left], [marks[k] for k in left], [named[k] for k in left])
        for k, match in zip(left, voted, strict=True):
            found[k] = match
        return found

    def _as_named(
        self, lines: Sequence[shapely.LineString], marks: Sequence[bool], named: Sequence[int | None]
    ) -> list[Match | None]:
        """The match of each path that surely goes along all of the ring that is named; None elsewhere.

        Of rings that a path comes near the named one is tried first: votes would find the same.
        """
        found: list[Match | None] = [None] * len(lines)
        queries = [
            (k, name, ring)
            for k, (line, marked, name) in enumerate(zip(lines, marks, named, strict=True))
            if name is not None and (self.nest.contours[name].kind == "mark") == marked
            if (ring := self._ring_for(line, name, "right")) is not None
        ]
        along, rings = [lines[k] for k, _, _ in queries], [ring for _, _, ring in queries]
        middles = shapely.line_interpolate_point(along, _SAMPLES // 2 / _SAMPLES, normalized=True)
        sure = surely_cover(along, rings, tolerance_mm(self.kerf_mm))
        sure &= shapely.dwithin(middles, rings, self._reach_mm)
        for known, (k, name, ring) in zip(sure.tolist(), queries, strict=True):
            if known:
                found[k] = Match(name, "right", ring, 0.0)
        return found

    @property
    def _reach_mm(self) -> float:
        """A path that comes no nearer to a ring than this has nothing to do with it."""
        return self.kerf_mm + NEAR_MM

    def _by_votes(
        self, lines: Sequence[shapely.LineString], marks: Sequence[bool], named: Sequence[int | None]
    ) -> list[Match | None]:
        """See `match`: rings are tried in the order of how many points of a path they are near to."""
        votes: list[Counter[int]] = [Counter() for _ in lines]
        shares = np.tile(np.arange(_SAMPLES) / _SAMPLES, len(lines))
        if lines:
            points = shapely.line_interpolate_point(np.repeat(np.array(lines), _SAMPLES), shares, normalized=True)
            samples, contours = self._tree.query(points, predicate="dwithin", distance=self._reach_mm)
            for sample, contour in zip(samples.tolist(), contours.tolist(), strict=True):
                votes[sample // _SAMPLES][contour] += 1
        ranked = [sorted(of, key=lambda c: (c != name, -of[c], c)) for of, name in zip(votes, named, strict=True)]
        suited = [
            [c for c in of if (self.nest.contours[c].kind == "mark") == marked]
            for of, marked in zip(ranked, marks, strict=True)
        ]
        at_once = self._at_once(lines, [of[0] if of else None for of in suited])
        rows = zip(lines, ranked, suited, at_once, strict=True)
        return [self._best(line, of, own) if known is None else known for line, of, own, known in rows]

    def _at_once(self, lines: Sequence[shapely.LineString], likeliest: Sequence[int | None]) -> list[Match | None]:
        """The match of each path that goes along all of the ring that is likeliest, on its right side; None elsewhere.

        That is what `_best` tries first. So many paths are looked at together that their points take little memory.
        """
        found: list[Match | None] = [None] * len(lines)
        queries = [
            (k, contour, ring)
            for k, (line, contour) in enumerate(zip(lines, likeliest, strict=True))
            if contour is not None and (ring := self._ring_for(line, contour, "right")) is not None
        ]
        sure = surely_cover(
            [lines[k] for k, _, _ in queries], [ring for _, _, ring in queries], tolerance_mm(self.kerf_mm)
        )
        for known, (k, contour, ring) in zip(sure.tolist(), queries, strict=True):
            if known:
                found[k] = Match(contour, "right", ring, 0.0)
        queries = [row for known, row in zip(sure.tolist(), queries, strict=True) if not known]
        for begin in range(0, len(queries), _AT_ONCE):
            some = queries[begin : begin + _AT_ONCE]
            paths = np.array([lines[k] for k, _, _ in some], dtype=object)
            shapely.prepare(paths)
            points, of = shapely.get_coordinates(
                np.array([ring for _, _, ring in some], dtype=object), return_index=True
            )
            near = shapely.dwithin(paths[of], shapely.points(points), tolerance_mm(self.kerf_mm))
            astray = np.bincount(of, weights=~near, minlength=len(some))
            for (k, contour, ring), off in zip(some, astray.tolist(), strict=True):
                if not off:
                    found[k] = Match(contour, "right", ring, 0.0)
        return found

    def _best(self, line: shapely.LineString, ranked: Sequence[int], suited: Sequence[int]) -> Match | None:
        shapely.prepare(line)
        tried: list[Match] = []
        for group, sides in ((suited, _RIGHT), (suited, _OTHER), (ranked, _RIGHT + _OTHER)):
            for found in (self._against(line, contour, side) for contour in group for side in sides):
                if found is None:
                    continue
                if found.deviation_mm <= tolerance_mm(self.kerf_mm):
                    return found
                tried.append(found)
        best = min(tried, key=lambda m: m.deviation_mm, default=None)
        if best is not None and best.deviation_mm <= NEAR_MM:
            return best
        return next((m for m in map(partial(self._part_of, line), suited) if m is not None), None)

    def _part_of(self, line: shapely.LineString, contour: int) -> Match | None:
        """The match with a ring that most of the path follows, though it does not go all the way round."""
        ring = self.rings[contour]
        points = shapely.line_interpolate_point(line, np.arange(_SAMPLES) / _SAMPLES, normalized=True)
        if ring is None or np.mean(shapely.distance(ring, points) <= tolerance_mm(self.kerf_mm)) < 0.5:
            return None
        return Match(contour, "right", ring, float(shapely.hausdorff_distance(ring, line)))

    def _against(self, line: shapely.LineString, contour: int, side: Side) -> Match | None:
        """How far a ring strays from the path at most: a path that goes all the way round covers its ring."""
        ring = self._ring_for(line, contour, side)
        if ring is None:
            return None
        off_mm = beyond_mm(line, shapely.get_coordinates(ring), tolerance_mm(self.kerf_mm))
        return Match(contour, side, ring, off_mm)

    def _ring_for(self, line: shapely.LineString, contour: int, side: Side) -> shapely.LineString | None:
        """The ring of a contour, where it may be one that a path follows.

        A scrap line has no leads: a path that goes on beyond it cuts something else.
        """
        ring = self.rings[contour]
        if self.nest.contours[contour].kind == "scrap" and ring is not None and line.length > ring.length + NEAR_MM:
            return None
        if side != "right":
            ring = torch_rings([self.nest.contours[contour]], self.kerf_mm, side)[0]
        return ring if ring is not None and _within(ring.bounds, line.bounds) else None


def _within(inner: Box, outer: Box) -> bool:
    low = inner[0] > outer[0] - NEAR_MM and inner[1] > outer[1] - NEAR_MM
    return low and inner[2] < outer[2] + NEAR_MM and inner[3] < outer[3] + NEAR_MM


# Tabs as burns leave them: stretches that the torch goes unlit, and the one that a cut stops short of.

_MOST = 0.25
"""What is left of a ring at the most, that it still counts as cut but for a tab."""


def extend_to_tabs(burns: Sequence[Burn], nest: Nest, matcher: Matcher) -> tuple[Burn, ...]:
    """The burns, those that stop short of where they joined an outer contour led on to there, unlit."""
    lines = [line_of(burn.path) for burn in burns]
    rows = [k for k, burn in enumerate(burns) if burn.tool == 0 and lines[k] is not None]
    found = matcher.match([line for k in rows if (line := lines[k])], [False] * len(rows), [None] * len(rows))
    extended = list(burns)
    for k, match in zip(rows, found, strict=True):
        if match is None or nest.contours[match.contour].kind != "outer":
            continue
        if (rest := _rest(burns[k].path, match.ring, tolerance_mm(matcher.kerf_mm))) is not None:
            path, lit_mm = burns[k].path, burns[k].path.length_mm
            led_on = Curve(np.vstack([path.vertices[:-1], rest]), closed=False)
            extended[k] = replace(burns[k], path=led_on, unlit=((lit_mm, led_on.length_mm),))
    return tuple(extended)


def _rest(path: Curve, ring: shapely.LineString, within_mm: float) -> Floats | None:
    """The vertices along a ring from the end of a path to where it joined; None where it ends elsewhere, or far off."""
    points = shapely.points(path.vertices[:, :2])
    on = shapely.distance(ring, points) <= within_mm
    if not on[-1] or int(on.sum()) < 3:
        return None
    join = int(np.argmax(on))
    at_mm = shapely.line_locate_point(ring, points)
    around_mm = float(ring.length)
    lit = Curve(path.vertices[join:], closed=False)
    begun_mm = shapely.line_locate_point(ring, shapely.Point(lit.point_at(min(1.0, lit.length_mm / 4))))
    ahead_mm = (begun_mm - at_mm[join] + around_mm / 2) % around_mm - around_mm / 2
    onwards = (
        lit.is_ccw == bool(shapely.is_ccw(shapely.LinearRing(ring.coords))) if len(lit.segments) > 2 else ahead_mm > 0
    )
    gap_mm = float((at_mm[join] - at_mm[-1]) % around_mm if onwards else (at_mm[-1] - at_mm[join]) % around_mm)
    if not within_mm < gap_mm <= min(LONGEST_MM, _MOST * around_mm):
        return None
    steps = np.linspace(0.0, gap_mm, max(2, int(gap_mm / 0.5) + 2))
    along = shapely.line_interpolate_point(ring, (at_mm[-1] + (steps if onwards else -steps)) % around_mm)
    xy = shapely.get_coordinates(along)
    xy[0], xy[-1] = path.vertices[-1, :2], path.vertices[join, :2]
    return np.column_stack([xy, np.zeros(len(xy))])


def with_tabs(
    cut: Cut, run: TorchRun, burn: Burn, kerf_mm: float, widths_mm: Collection[float] = ()
) -> tuple[Cut, TorchRun, list[Violation]]:
    """A cut, and its run, with the tabs that its burn leaves, and what is wrong with where these are.

    A control that counts in steps makes tabs of the widths that are asked for to two steps.
    """
    assert run.contour is not None
    curve, wrong = run.contour.curve, []
    tabs, off = [], []
    for low, high in burn.unlit:
        middle = burn.path.point_at((low + high) / 2)
        at = curve.nearest(middle)
        width_mm = high - low - kerf_mm
        nearest_mm = min(widths_mm, key=lambda asked_mm: abs(asked_mm - width_mm), default=width_mm)
        tabs.append(Tab(at, nearest_mm if abs(nearest_mm - width_mm) <= 2 * step_mm() else width_mm))
        off.append(Tab(middle, high - low))
        away_mm = run.loop.distance(shapely.Point(middle))
        if away_mm > tolerance_mm(kerf_mm):
            text = f"the torch goes off for {high - low:.2f} mm beside {cut.contour}, where no tab can be"
            wrong.append(run.wrong("contour-geometry", text))
    lead_out = cut.lead_out
    if burn.unlit[-1][1] >= burn.path.length_mm - 1e-6:
        lead_out = Curve.of([burn.path.point_at(burn.unlit[-1][0])], closed=False)
    return replace(cut, tabs=tuple(tabs), lead_out=lead_out), replace(run, unlit=tuple(off)), wrong
