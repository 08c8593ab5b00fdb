"""A route of candidates as a timed path: what a simulation needs, without a plan or a program having been made."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from kerfwise.arrays import Floats
from kerfwise.encoder.candidates.candidate import Candidate
from kerfwise.encoder.compensation import compensated
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.torch_way import torch_way
from kerfwise.models.physics.timing.constant import Feeds

from .timed_path import TimedPath, TorchOn, in_order, torch_on

CHORD_MM = 0.2


class RoutePaths:
    """The torch's paths of the candidates of a nest; each is made once.

    Parameters
    ----------
    facts
        The nest and its candidates.
    kerf_mm
        Width of the kerf.
    feeds
        How fast everything goes.
    home
        Where the torch starts.
    """

    def __init__(self, facts: Facts, kerf_mm: float, feeds: Feeds, home: Point) -> None:
        self._facts, self._kerf_mm, self._feeds, self._home = facts, kerf_mm, feeds, home
        self._made: dict[int, Floats] = {}

    def of(self, route: Sequence[int]) -> TimedPath:
        """The path of candidates cut in this order."""
        now_s, at = 0.0, self._home
        burns = []
        for number in route:
            burn, now_s = self.burn(number, now_s, at)
            at = self._facts.candidates[number].end
            if burn is not None:
                burns.append(burn)
        return in_order(burns, now_s)

    def burn(self, number: int, now_s: float, at: Point) -> tuple[TorchOn | None, float]:
        """One candidate cut next, the torch being at a point at a time; None for a mark. And when it is done."""
        candidate, feeds = self._facts.candidates[number], self._feeds
        begin_s = now_s + math.dist(at, candidate.pierce) / feeds.travel_mm_s
        contour = self._facts.nest.contours[candidate.contour]
        if contour.kind == "mark":
            return None, begin_s + feeds.mark_start_s + candidate.cut_mm / feeds.mark_mm_s
        pierce_s = feeds.edge_s if candidate.unpierced else feeds.pierce_s
        run_mm = candidate.cut_mm + candidate.at_corners_mm(contour)
        end_s = begin_s + pierce_s + run_mm / (feeds.cut_mm_s * contour.feed_share)
        return torch_on(contour.id, self._points(number, candidate), begin_s, end_s, pierce_s), end_s

    def _points(self, number: int, candidate: Candidate) -> Floats:
        if number not in self._made:
            contour = self._facts.nest.contours[candidate.contour]
            if contour.curve.closed:
                ring = compensated(contour, self._kerf_mm).towards(candidate.direction)
                joins = candidate.pierce if candidate.lead_in is None else candidate.lead_in.vertices[-1, :2].tolist()
                x, y = joins
                way, _ = torch_way(ring, (x, y), candidate.span, candidate.tabs, self._kerf_mm)
            else:
                way = contour.curve if candidate.direction == "ccw" else contour.curve.reversed()
            paths = (candidate.lead_in, way, candidate.lead_out)
            self._made[number] = np.concatenate([path.flatten(CHORD_MM) for path in paths if path is not None])
        return self._made[number]
