"""Leads as arrays: one line or arc each, from the pierce to where the torch joins."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Floats, Ints

from .joints import Joints

_POINTS = 17
"""Points that an arc is judged by: a quarter of a circle of 4 mm radius in chords within 0.005 mm."""


@dataclass(frozen=True, slots=True)
class LeadShape:
    """How a lead is tried.

    `shortened` runs from 0 (as long as it may be) to 1 (as short as it may be). A line is turned by `angle_rad` from
    straight into the waste towards where the torch comes from; an arc, tangent to the cut, sweeps `angle_rad`.
    """

    kind: Literal["line", "arc"]
    shortened: float
    angle_rad: float


@dataclass(frozen=True, eq=False, slots=True)
class Leads:
    """Parallel arrays: `pierce` and `join` (m, 2), the bulge from one to the other and the length, mm."""

    pierce: Floats
    join: Floats
    bulge: Floats
    length_mm: Floats

    def take(self, rows: NDArray[np.bool_] | Ints) -> Leads:
        """Some of the rows."""
        return Leads(self.pierce[rows], self.join[rows], self.bulge[rows], self.length_mm[rows])

    @staticmethod
    def joined(several: Sequence[Leads]) -> Leads:
        """All rows of several, in order."""
        return Leads(
            np.concatenate([a.pierce for a in several]),
            np.concatenate([a.join for a in several]),
            np.concatenate([a.bulge for a in several]),
            np.concatenate([a.length_mm for a in several]),
        )

    def points(self, left_out_mm: float = 0.0, most: float = 0.5) -> Floats:
        """Array (m, q, 2) of points along the leads, without the last `left_out_mm` before joining.

        No more than a share of `most` is left out of any lead.
        """
        until = 1 - np.minimum(left_out_mm / np.maximum(self.length_mm, 1e-9), most)
        if not self.bulge.any():
            last = self.pierce + until[:, None] * (self.join - self.pierce)
            return np.stack([self.pierce, last], axis=1)
        fraction = until[:, None] * np.linspace(0, 1, _POINTS)
        # On the circle through both ends the point a fraction f along lies, seen from the pierce, at
        # sin(f s / 2) / sin(s / 2) of the chord, turned by (f - 1) s / 2, where s is the sweep.
        half = 2 * np.arctan(self.bulge)[:, None]
        bent = np.abs(half) > 1e-9
        scale = np.where(bent, np.sin(half * fraction) / np.where(bent, np.sin(half), 1.0), fraction)
        turn = half * (fraction - 1)
        (dx, dy) = (self.join - self.pierce).T[:, :, None]
        x = self.pierce[:, :1] + scale * (np.cos(turn) * dx - np.sin(turn) * dy)
        y = self.pierce[:, 1:] + scale * (np.sin(turn) * dx + np.cos(turn) * dy)
        return np.stack([x, y], axis=2)


def shaped(shape: LeadShape, joints: Joints, along: Floats, longest_mm: Floats, shortest_mm: float) -> Leads:
    """Leads of one shape to all joints, where the torch then goes `along` (m, 2).

    Examples
    --------
    >>> at = Joints(*(np.array(a) for a in ([0], [0.0], [[0.0, 0.0]], [0.0], [[0.0, 0.0]], [[0.0, 1.0]])))
    >>> shaped(LeadShape("line", 0.0, 0.0), at, np.array([[1.0, 0.0]]), np.array([6.0]), 1.0).pierce.tolist()
    [[0.0, 6.0]]
    """
    length_mm = longest_mm * (shortest_mm / longest_mm) ** shape.shortened
    out, back = joints.out, -along
    if shape.kind == "line":
        ray = math.cos(shape.angle_rad) * out + math.sin(shape.angle_rad) * back
        return Leads(joints.join + length_mm[:, None] * ray, joints.join, np.zeros(len(joints)), length_mm)
    radius_mm = (length_mm / shape.angle_rad)[:, None]
    sideways, outwards = math.sin(shape.angle_rad), 1 - math.cos(shape.angle_rad)
    pierce = joints.join + radius_mm * (sideways * back + outwards * out)
    turn = np.sign(along[:, 0] * out[:, 1] - along[:, 1] * out[:, 0])
    return Leads(pierce, joints.join, turn * math.tan(shape.angle_rad / 4), length_mm)
