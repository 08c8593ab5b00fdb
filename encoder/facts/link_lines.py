"""Links as arrays: the places that they join, and the points of their ways."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from kerfwise.arrays import Bools, Floats, Ints

Lines = NDArray[np.object_]


@dataclass(frozen=True, eq=False, slots=True)
class Places:
    """Candidates that no link tells apart, k places: their contour, and where links begin or end, (k, 2).

    `leads` (k,) are those of the place's own contour that a link from or to it keeps off, as one shape each.
    """

    members: list[tuple[int, ...]]
    contour: Ints
    at: Floats
    leads: Lines


@dataclass(frozen=True, eq=False, slots=True)
class LinkLines:
    """k links from the places `one` (k,) to the places `other` (k,), each along `points` (k, p, 2), p 2 or 3."""

    one: Ints
    other: Ints
    points: Floats

    def __len__(self) -> int:
        return len(self.one)

    @staticmethod
    def straight(leave: Places, one: Ints, reach: Places, other: Ints) -> LinkLines:
        """Straight ones."""
        return LinkLines(one, other, np.stack([leave.at[one], reach.at[other]], axis=1))

    def round(self, corner: Floats) -> LinkLines:
        """The same by way of a corner each, (k, 2)."""
        return LinkLines(self.one, self.other, np.stack([self.points[:, 0], corner, self.points[:, -1]], axis=1))

    def take(self, rows: Ints | Bools) -> LinkLines:
        """Some of them."""
        return LinkLines(self.one[rows], self.other[rows], self.points[rows])

    @property
    def bent(self) -> bool:
        """Whether they have corners."""
        return bool(self.points.shape[1] > 2)

    @property
    def lines(self) -> Lines:
        """Each as a line."""
        return _lines(self.points)

    @property
    def length_mm(self) -> Floats:
        """How long each is."""
        steps = np.diff(self.points, axis=1)
        return np.asarray(np.hypot(steps[..., 0], steps[..., 1]).sum(axis=1))

    def onward(self, less_mm: float) -> Lines:
        """Each without its first `less_mm`: its first straight piece is shortened, to its very end at the most."""
        return _lines(_trimmed(self.points, less_mm))

    def inward(self, less_mm: float) -> Lines:
        """The same from the other end."""
        return _lines(_trimmed(self.points[:, ::-1], less_mm))


def _lines(points: Floats) -> Lines:
    lines: Lines = shapely.linestrings(points)
    return lines


def _trimmed(points: Floats, less_mm: float) -> Floats:
    begin, then = points[:, 0], points[:, 1]
    length_mm = np.hypot(*(then - begin).T)
    share = np.minimum(less_mm / np.maximum(length_mm, 1e-9), 1.0)[:, None]
    return np.concatenate([(begin + share * (then - begin))[:, None], points[:, 1:]], axis=1)
