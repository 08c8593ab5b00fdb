"""Which contour of the nest a torch-on path cuts, found by geometry."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
import shapely

from kerfwise.encoder.geometry.distances import beyond_mm
from kerfwise.encoder.geometry.segment import Box
from kerfwise.encoder.nest import Nest

from .followed_rings import surely_cover
from .program_rules import tolerance_mm
from .rings import Side, rings_of, torch_rings

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
        asked = [
            (k, name, ring)
            for k, (line, marked, name) in enumerate(zip(lines, marks, named, strict=True))
            if name is not None and (self.nest.contours[name].kind == "mark") == marked
            if (ring := self._ring_for(line, name, "right")) is not None
        ]
        along, rings = [lines[k] for k, _, _ in asked], [ring for _, _, ring in asked]
        middles = shapely.line_interpolate_point(along, _SAMPLES // 2 / _SAMPLES, normalized=True)
        sure = surely_cover(along, rings, tolerance_mm(self.kerf_mm))
        sure &= shapely.dwithin(middles, rings, self._reach_mm)
        for known, (k, name, ring) in zip(sure.tolist(), asked, strict=True):
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
        asked = [
            (k, contour, ring)
            for k, (line, contour) in enumerate(zip(lines, likeliest, strict=True))
            if contour is not None and (ring := self._ring_for(line, contour, "right")) is not None
        ]
        sure = surely_cover([lines[k] for k, _, _ in asked], [ring for _, _, ring in asked], tolerance_mm(self.kerf_mm))
        for known, (k, contour, ring) in zip(sure.tolist(), asked, strict=True):
            if known:
                found[k] = Match(contour, "right", ring, 0.0)
        asked = [row for known, row in zip(sure.tolist(), asked, strict=True) if not known]
        for begin in range(0, len(asked), _AT_ONCE):
            some = asked[begin : begin + _AT_ONCE]
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
