"""Which points of a contour to offer as entries: corners first, then middles of edges, well apart."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Floats

from .joints import Outline

CORNER_RAD = math.radians(30)
"""A contour that turns by no more has no corner there."""
TIED_MM, TIED_RAD = 1e-6, 1e-9
"""What differs by less is equal: where a drawing lies on the sheet must not tell which entry is better."""

CORNER, MIDDLE, ANYWHERE = 0, 1, 2
Ranks = NDArray[np.int64]


def places(outline: Outline, count: int) -> tuple[Floats, Ranks]:
    """Path lengths along the contour that could be entries, and the rank of each.

    Corners that stick out into the waste, where a scar matters least, rank before the middles of straight edges, and
    those before `4 * count` points spread evenly.
    """
    drawn = outline.drawn
    around_mm = float(drawn.starts_mm[-1])
    corners = np.flatnonzero(drawn.turn_rad * outline.right > CORNER_RAD + TIED_RAD)
    length_mm = np.diff(drawn.starts_mm)
    edges = np.flatnonzero((drawn.bulge == 0) & (length_mm > around_mm / (8 * count) + TIED_MM))
    groups = [
        drawn.starts_mm[corners + 1] % around_mm,
        drawn.starts_mm[edges] + length_mm[edges] / 2,
        around_mm * (np.arange(4 * count) + 0.5) / (4 * count),
    ]
    return np.concatenate(groups), np.repeat([CORNER, MIDDLE, ANYWHERE], [len(g) for g in groups])


def choose(at_mm: Floats, ranks: Ranks, around_mm: float, count: int, taken_mm: Floats) -> list[int]:
    """Up to `count` of the places, best rank first and each as far as can be from those before it and those taken.

    Places no farther than a quarter of an even share of the way round from another are passed over; of places that are
    equally far, the first is taken.

    Examples
    --------
    >>> choose(np.array([0.0, 1.0, 50.0, 55.0]), np.array([0, 0, 1, 2]), 100.0, 3, np.zeros(0))
    [0, 2]
    """
    apart_mm = np.full(len(at_mm), np.inf)
    for place_mm in taken_mm.tolist():
        apart_mm = np.minimum(apart_mm, shorter_way_mm(at_mm, place_mm, around_mm))
    chosen: list[int] = []
    for rank in (CORNER, MIDDLE, ANYWHERE):
        of_rank = ranks == rank
        while of_rank.any() and len(chosen) < count:
            farthest_mm = float(apart_mm[of_rank].max())
            if farthest_mm <= around_mm / (4 * count) + TIED_MM:
                break
            k = int(np.argmax(of_rank & (apart_mm >= farthest_mm - TIED_MM)))
            chosen.append(k)
            apart_mm = np.minimum(apart_mm, shorter_way_mm(at_mm, float(at_mm[k]), around_mm))
    return chosen


def shorter_way_mm(at_mm: Floats, place_mm: float, around_mm: float) -> Floats:
    """Shorter way round from a place to others."""
    ahead_mm = np.abs(at_mm - place_mm) % around_mm
    return np.minimum(ahead_mm, around_mm - ahead_mm)
