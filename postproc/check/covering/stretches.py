"""Stretches of burns that run along rings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kerfwise.arrays import Floats

from .chords import Chords
from .intervals import both, minus, total_mm, union
from .near import near

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
    found = near(burns, rings, within_mm)
    found = found.only(np.abs(found.along) > _ALONG)
    order = np.lexsort((found.low_mm, found.other, found.line))
    found = found.only(order)
    made: dict[int, list[Stretch]] = {}
    if not len(found):
        return made
    edges = np.flatnonzero((np.diff(found.line) != 0) | (np.diff(found.other) != 0)) + 1
    for rows in np.split(np.arange(len(found)), edges):
        line, ring = int(found.line[rows[0]]), int(found.other[rows[0]])
        low, high = found.low_mm[rows], found.high_mm[rows]
        least_mm = min(LEAST_MM, float(lengths_mm[ring]) / 4)
        for a, b in union(np.stack([low, high], axis=1), within_mm).tolist():
            if b - a >= least_mm:
                own = rows[(low >= a) & (high <= b)]
                ends = np.sort(np.stack([found.other_low_mm[own], found.other_high_mm[own]], axis=1), axis=1)
                made.setdefault(line, []).append(Stretch(ring, a, b, union(ends)))
    for row in made.values():
        row.sort(key=lambda s: (s.low_mm, s.high_mm, s.ring))
    return made


def beside_own_mm(row: Sequence[Stretch], own: int | None) -> dict[int, float]:
    """How far a burn runs along each other ring where it does not run along its own, mm.

    Two rings may share a line, where parts stand a kerf apart: who follows the one is along the other too.
    """
    along = [(s.low_mm, s.high_mm) for s in row if s.ring == own]
    mine = union(np.array(along).reshape(-1, 2))
    found: dict[int, float] = {}
    for s in row:
        if s.ring != own:
            more_mm = total_mm(minus(np.array([[s.low_mm, s.high_mm]]), mine))
            found[s.ring] = found.get(s.ring, 0.0) + more_mm
    return found


def adds_mm(stretch: Stretch, new: Floats) -> float:
    """How much of what is newly covered of a ring a stretch covers, mm."""
    return total_mm(both(stretch.on_ring, new))
