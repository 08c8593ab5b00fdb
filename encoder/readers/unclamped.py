"""Splines whose knots go on beyond their ends, as CAD systems write closed ones."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from ezdxf.math import BSpline, Vec3

_DEEPEST = 16


@dataclass(frozen=True, slots=True)
class Unclamped:
    """A spline that is no curve over its first and last knots, as many as its degree; ezdxf would draw it there too."""

    spline: BSpline

    def flattening(self, distance: float, segments: int = 4) -> Iterator[Vec3]:
        """Points along the curve, no chord between them further off it than about `distance`."""
        knots, degree = self.spline.knots(), self.spline.order - 1
        ends = np.unique(knots[degree : self.spline.count + 1])
        times = np.unique(np.concatenate([np.linspace(a, b, segments + 1) for a, b in pairwise(ends)]))
        points = [self._at(t) for t in times]
        yield points[0]
        for k in range(len(times) - 1):
            yield from self._finer(times[k], points[k], times[k + 1], points[k + 1], distance, _DEEPEST)

    def _at(self, time: float) -> Vec3:
        return self.spline.evaluator.point(float(time))

    def _finer(self, t0: float, start: Vec3, t1: float, end: Vec3, distance: float, depth: int) -> Iterator[Vec3]:
        middle = self._at((t0 + t1) / 2)
        # the middle of a short piece of a smooth curve lies beside that of its chord
        if depth == 0 or middle.distance(start.lerp(end)) <= distance:
            yield end
        else:
            yield from self._finer(t0, start, (t0 + t1) / 2, middle, distance, depth - 1)
            yield from self._finer((t0 + t1) / 2, middle, t1, end, distance, depth - 1)
