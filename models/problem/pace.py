"""How long cuts and moves take, in whole milliseconds, for statements that count seconds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.encoder.facts.facts import Facts
from kerfwise.models.physics.timing.constant import Feeds


@dataclass(frozen=True, eq=False, slots=True)
class Pace:
    """`cut_ms` (m,) is the time of every site's cut, piercing included; a move of d µm takes d · `ms_per_um`, rounded.

    An empty `cut_ms` says that cuts and moves take no time.
    """

    cut_ms: Ints = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    ms_per_um: float = 0.0

    @staticmethod
    def of(facts: Facts, representatives: Sequence[int], feeds: Feeds) -> Pace:
        """The pace of a machine, for the candidates that the sites stand for."""
        times = []
        for number in representatives:
            candidate = facts.candidates[number]
            contour = facts.nest.contours[candidate.contour]
            if contour.kind == "mark":
                times.append(feeds.mark_start_s + candidate.cut_mm / feeds.mark_mm_s)
            else:
                pierce = feeds.edge_s if candidate.unpierced else feeds.pierce_s
                run_mm = candidate.cut_mm + candidate.at_corners_mm(contour)
                times.append(pierce + run_mm / (feeds.cut_mm_s * contour.feed_share))
        return Pace(np.asarray(np.rint(np.array(times) * 1000), dtype=np.int64), 1.0 / feeds.travel_mm_s)

    def move_ms(self, from_um: Ints, to_um: Ints) -> Ints:
        """Time of the moves between points (k, 2), ms."""
        gap = np.sqrt(((from_um.astype(np.float64) - to_um) ** 2).sum(axis=-1))
        return np.asarray(np.rint(gap * self.ms_per_um), dtype=np.int64)
