"""The sheet as points on a square grid, and what a simulation found there."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import shapely

from kerfwise.arrays import Bools, Float32s, Int32s, Ints
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.rules.profile.plant_sections import Heat, HeatModel

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
    """The grid over a nest's sheet. Raises InputError if it would have more points than fit in memory."""
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


# What a simulation of heat found: peaks, points too hot, and for how long, in all and part by part.


@dataclass(frozen=True, eq=False, slots=True)
class HeatRun:
    """Maps (nx, ny) of the highest temperature, °C, and of the seconds above the limit; energies in J.

    `put_in` is what the torch left in the sheet, `lost` what the air took, `stored` what is in the sheet at the end.
    All three are 0 for a model that knows no energy.
    """

    peak_c: Float32s
    above_s: Float32s
    put_in_j: float = 0.0
    lost_j: float = 0.0
    stored_j: float = 0.0


@dataclass(frozen=True, slots=True)
class PartHeat:
    """One part, outside the kerf's band: its highest temperature, points too hot, the longest that one stayed so.

    `peak_c` is None for a part that lies in the band with all its points: nothing is known of it.
    """

    part: str
    peak_c: float | None
    overheats: int
    above_s: float


@dataclass(frozen=True, eq=False, slots=True)
class HeatResult:
    """What `simulate` answers.

    An overheat is a point of the grid on a part or on the skeleton, outside the kerf's band, that was hotter than the
    limit. `counted` says which points these may be; scrap in holes is none of them. `peak_c` is the highest temperature
    among them. `energy_error` is the share of the energy put in that is neither in the sheet nor in the air at the end,
    None for a model without energies.
    """

    model: HeatModel
    grid: Grid
    limit_c: float
    run: HeatRun
    counted: Bools
    overheats: int
    peak_c: float
    above_s: float
    parts: tuple[PartHeat, ...]
    energy_error: float | None


def made_result(model: HeatModel, nest: Nest, grid: Grid, heat: Heat, run: HeatRun, counted: Bools) -> HeatResult:
    """Count what a run has found, among the points that are counted."""
    hot = counted & (run.peak_c > heat.limit_c)
    put_in = run.put_in_j
    return HeatResult(
        model,
        grid,
        heat.limit_c,
        run,
        counted,
        int(hot.sum()),
        _highest(run.peak_c, counted, heat.ambient_c),
        _highest(run.above_s, counted, 0.0),
        _by_part(nest, grid, heat, run, counted, hot),
        None if model == "logical" else abs(put_in - run.lost_j - run.stored_j) / put_in if put_in else 0.0,
    )


def _by_part(nest: Nest, grid: Grid, heat: Heat, run: HeatRun, counted: Bools, hot: Bools) -> tuple[PartHeat, ...]:
    on_parts = counted & (grid.part >= 0)
    of = grid.part[on_parts]
    peak = np.full(len(nest.parts), heat.ambient_c, dtype=np.float32)
    longest = np.zeros(len(nest.parts), dtype=np.float32)
    np.maximum.at(peak, of, run.peak_c[on_parts])
    np.maximum.at(longest, of, run.above_s[on_parts])
    count = np.bincount(of[hot[on_parts]], minlength=len(nest.parts))
    seen = np.bincount(of, minlength=len(nest.parts)) > 0
    return tuple(
        PartHeat(part.id, float(peak[k]) if seen[k] else None, int(count[k]), float(longest[k]))
        for k, part in enumerate(nest.parts)
    )


def _highest(values: Float32s, counted: Bools, none: float) -> float:
    return float(values[counted].max()) if counted.any() else none


# The sheet by the contour that lies nearest: where an overheat is says whose order it has to do with.


def hot_contours(nest: Nest) -> Ints:
    """Numbers of the contours that heat the sheet: all but marks."""
    return np.array([k for k, contour in enumerate(nest.contours) if contour.kind != "mark"], dtype=np.int64)


class Regions:
    """Points of a grid by the nearest contour that is no mark.

    Parameters
    ----------
    nest
        Sheet and parts.
    grid
        That of `make_grid`.
    """

    def __init__(self, nest: Nest, grid: Grid) -> None:
        self._hot, self._n, self._grid = hot_contours(nest), len(nest.contours), grid
        self._tree = shapely.STRtree([nest.contours[k].line for k in self._hot])

    def count(self, found: HeatResult) -> Ints:
        """Overheats near each contour, (n,), by contour number."""
        grid = self._grid
        i, j = np.nonzero(found.counted & (found.run.peak_c > found.limit_c))
        if not len(i):
            return np.zeros(self._n, dtype=np.int64)
        points = shapely.points(grid.x0_mm + grid.step_mm * i, grid.y0_mm + grid.step_mm * j)
        return np.bincount(self._hot[self._tree.nearest(points)], minlength=self._n).astype(np.int64)
