"""The sheet as points on a square grid: which of them are metal, and of which part."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import shapely

from kerfwise.arrays import Bools, Int32s
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest

MOST_POINTS = 30_000_000
NO_PART = -1
SCRAP = -2
SHIFT_X, SHIFT_Y = 0.1373, 0.2179
"""The grid begins that many steps outside the sheet: drawings lie on round numbers, and no cut should run exactly
along a row of points, where the last digit decides on which side of it they are."""


@dataclass(frozen=True, eq=False, slots=True)
class Grid:
    """Points at the middle of squares `step_mm` wide; index (i, j) counts along x and y.

    `x0_mm`, `y0_mm` is the first point. `metal` says which points lie on the sheet. `part` is the index of the part a
    point lies in, `NO_PART` outside all of them, `SCRAP` in a hole, what falls out of a part.
    """

    x0_mm: float
    y0_mm: float
    step_mm: float
    metal: Bools
    part: Int32s

    @property
    def shape(self) -> tuple[int, int]:
        """Points along x and along y."""
        return self.metal.shape[0], self.metal.shape[1]

    def near(self, lines: Iterable[shapely.LineString], within_mm: float) -> Bools:
        """Which points lie within a distance of any of the lines."""
        found = np.zeros(self.shape, dtype=np.bool_)
        for line in lines:
            self._mark(found, line.buffer(within_mm), True)
        return found

    def _mark(self, array: Bools | Int32s, polygon: shapely.Geometry, value: bool | int) -> None:
        """Set `array` where points lie in the polygon; only those in its bounding box are looked at."""
        x0, y0, x1, y1 = polygon.bounds
        along_x, along_y = self._span(x0, x1, self.x0_mm), self._span(y0, y1, self.y0_mm)
        window = array[along_x, along_y]
        if not window.size:
            return
        x = self.x0_mm + self.step_mm * np.arange(along_x.start, along_x.start + window.shape[0])
        y = self.y0_mm + self.step_mm * np.arange(along_y.start, along_y.start + window.shape[1])
        shapely.prepare(polygon)
        window[shapely.contains_xy(polygon, x[:, None], y[None, :])] = value

    def _span(self, low_mm: float, high_mm: float, first_mm: float) -> slice:
        """The points from `low_mm` to `high_mm`, and perhaps one more at either end."""
        begin, end = (low_mm - first_mm) / self.step_mm, (high_mm - first_mm) / self.step_mm
        return slice(max(0, math.floor(begin)), max(0, math.ceil(end) + 1))


def make_grid(nest: Nest, step_mm: float) -> Grid:
    """The grid over a nest's sheet.

    Raises
    ------
    InputError
        If it would have more points than fit in memory.
    """
    x0, y0, x1, y1 = nest.sheet.bounds
    nx, ny = math.ceil((x1 - x0) / step_mm + SHIFT_X), math.ceil((y1 - y0) / step_mm + SHIFT_Y)
    if nx * ny > MOST_POINTS:
        least_mm = 1.06 * math.sqrt((x1 - x0) * (y1 - y0) / MOST_POINTS)
        raise InputError(
            f"heat.grid: {step_mm:g} mm makes {nx} x {ny} points of this sheet, more than fit in memory: give a wider "
            f"grid, {least_mm:.2g} mm or more"
        )
    shape = (nx, ny)
    metal = np.zeros(shape, dtype=np.bool_)
    part = np.full(shape, NO_PART, dtype=np.int32)
    grid = Grid(x0 + (0.5 - SHIFT_X) * step_mm, y0 + (0.5 - SHIFT_Y) * step_mm, step_mm, metal, part)
    grid._mark(metal, nest.sheet.polygon, True)
    for hole in (hole for p in nest.parts for hole in p.holes):
        grid._mark(part, hole.polygon, SCRAP)
    for k, p in enumerate(nest.parts):
        grid._mark(part, p.polygon, k)
    return grid
