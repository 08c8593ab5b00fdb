"""What the torch does to the grid, in order of time: energy put in on both sides of the kerf, and links cut."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Floats, Ints

from .compiled import compiled, entry
from .grid import Grid
from .timed_path import TimedPath

SIDE = 0.7072
"""How far beside the kerf its heat goes in, grid steps: just over half a diagonal, so that it stays on its side."""
SPACING = 0.25
"""Longest stretch of path, grid steps, whose heat goes in at one point."""


class Events(NamedTuple):
    """Sorted by time. Of every dose: when, its two points (flat index, -1 for none) and share of the power's time, s.

    Of every link cut: when, its lower point (flat index), and whether it runs along y.
    """

    dose_s: Floats
    left: Ints
    right: Ints
    seconds: Floats
    cut_s: Floats
    link: Ints
    along_y: NDArray[np.bool_]


def events_of(path: TimedPath, grid: Grid) -> Events:
    """The events of a path on a grid.

    A link between two neighbouring points is cut when the torch crosses the line between them. A closed contour
    crosses every way from inside to outside, so that no heat passes it afterwards.
    """
    rows = [_of_burn(burn.xy, burn.at_s, grid) for burn in path.burns]
    columns = [np.concatenate(c) for c in zip(*rows, strict=True)] if rows else [np.zeros(0)] * 7
    dose = np.argsort(columns[0], kind="stable")
    cut = np.argsort(columns[4], kind="stable")
    left, right, link = (columns[k].astype(np.int64) for k in (1, 2, 5))
    return Events(
        columns[0][dose], left[dose], right[dose], columns[3][dose], columns[4][cut], link[cut],
        columns[6][cut].astype(np.bool_),
    )  # fmt: skip


def _of_burn(xy: Floats, at_s: Floats, grid: Grid) -> tuple[NDArray[np.generic], ...]:
    nx, ny = grid.shape
    scaled = np.ascontiguousarray((xy - (grid.x0_mm, grid.y0_mm)) / grid.step_mm)
    steps = np.abs(np.diff(scaled, axis=0))
    doses = int(np.ceil(np.hypot(steps[:, 0], steps[:, 1]) / SPACING).sum()) + 4 * len(xy)
    cuts = int(np.ceil(steps.sum())) + 2 * len(xy)
    dose, point = np.zeros((doses, 2)), np.full((doses, 2), -1, dtype=np.int64)
    cut, link = np.zeros(cuts), np.zeros((cuts, 2), dtype=np.int64)
    made, broken = _fill(scaled, at_s, nx, ny, dose, point, cut, link)
    return (
        dose[:made, 0], point[:made, 0], point[:made, 1], dose[:made, 1], cut[:broken], link[:broken, 0],
        link[:broken, 1],
    )  # fmt: skip


@compiled
def _flat(x: float, y: float, nx: int, ny: int) -> int:
    i, j = int(np.floor(x + 0.5)), int(np.floor(y + 0.5))
    return i * ny + j if 0 <= i < nx and 0 <= j < ny else -1


@compiled
def _stand(
    x: float, y: float, when_s: float, took_s: float, nx: int, ny: int, dose: Floats, point: Ints, made: int
) -> int:
    """A torch that stands heats the four points around it, the nearer the more: a pierce has no sides yet."""
    i, j = int(np.floor(x)), int(np.floor(y))
    for di in range(2):
        for dj in range(2):
            share = (x - i if di else 1 - x + i) * (y - j if dj else 1 - y + j)
            dose[made, 0], dose[made, 1] = when_s, took_s * share
            point[made, 0] = _flat(float(i + di), float(j + dj), nx, ny)
            made += 1
    return made


@entry
def _fill(
    xy: Floats, at_s: Floats, nx: int, ny: int, dose: Floats, point: Ints, cut: Floats, link: Ints
) -> tuple[int, int]:
    """Fill in the doses and the cuts of one burn; `xy` in grid steps from the first point."""
    made, broken = 0, 0
    tx, ty = 1.0, 0.0
    for k in range(len(xy) - 1):
        x0, y0, x1, y1 = xy[k, 0], xy[k, 1], xy[k + 1, 0], xy[k + 1, 1]
        dx, dy, took = x1 - x0, y1 - y0, at_s[k + 1] - at_s[k]
        length = np.sqrt(dx * dx + dy * dy)
        if length > 0:
            tx, ty = dx / length, dy / length
        pieces = max(1, int(np.ceil(length / SPACING)))
        if took > 0 and length == 0:
            made = _stand(x0, y0, at_s[k] + 0.5 * took, took, nx, ny, dose, point, made)
        elif took > 0:
            for p in range(pieces):
                f = (p + 0.5) / pieces
                x, y = x0 + f * dx, y0 + f * dy
                dose[made, 0], dose[made, 1] = at_s[k] + f * took, took / pieces
                point[made, 0] = _flat(x - SIDE * ty, y + SIDE * tx, nx, ny)
                point[made, 1] = _flat(x + SIDE * ty, y - SIDE * tx, nx, ny)
                made += 1
        # Lines through the points, at whole numbers: a line is crossed if the ends lie on different sides of it.
        low, high = min(x0, x1), max(x0, x1)
        for i in range(max(0, int(np.floor(low)) + 1), min(nx - 1, int(np.floor(high))) + 1):
            if (x0 < i) != (x1 < i):
                f = (i - x0) / dx
                j = int(np.floor(y0 + f * dy))
                if 0 <= j < ny - 1:
                    cut[broken], link[broken, 0], link[broken, 1] = at_s[k] + f * took, i * ny + j, 1
                    broken += 1
        low, high = min(y0, y1), max(y0, y1)
        for j in range(max(0, int(np.floor(low)) + 1), min(ny - 1, int(np.floor(high))) + 1):
            if (y0 < j) != (y1 < j):
                f = (j - y0) / dy
                i = int(np.floor(x0 + f * dx))
                if 0 <= i < nx - 1:
                    cut[broken], link[broken, 0], link[broken, 1] = at_s[k] + f * took, i * ny + j, 0
                    broken += 1
    return made, broken
