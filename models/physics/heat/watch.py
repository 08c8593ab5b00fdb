"""A sheet while it is cut, one burn after the other, and how hot its metal gets meanwhile, outside the kerf's band."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kerfwise.arrays import Bools
from kerfwise.encoder.cut import HotSpot
from kerfwise.encoder.nest import Nest
from kerfwise.rules.profile.heat_section import Heat

from .bounds import expect_bounded
from .events import Events, events_of
from .grid import Grid, make_grid
from .physical import SheetSimulation, settling_s
from .simulate import counted_points
from .timed_path import TimedPath, TorchOn


@dataclass(frozen=True, eq=False, slots=True)
class WatchedSheet:
    """A nest's sheet, and the points whose temperature counts while a program runs.

    `counted` are those of parts and of the skeleton outside the kerf's band of the whole program.
    """

    nest: Nest
    grid: Grid
    heat: Heat
    thickness_mm: float
    counted: Bools

    def sheet(self) -> SheetSimulation:
        """The sheet as warm as the air, uncut; with the limit that the heat section has."""
        return SheetSimulation(self.grid, self.heat, self.thickness_mm)

    def events(self, *burns: TorchOn) -> Events:
        """What these burns do to the grid."""
        return events_of(TimedPath(burns, float(burns[-1].at_s[-1])), self.grid)

    def hottest(self, peak_c: np.ndarray, at_s: float, among: Bools | None = None) -> HotSpot:
        """The hottest of the counted points (or of those among them) on a map of temperatures."""
        counted = self.counted if among is None else self.counted & among
        masked = np.where(counted, peak_c, -np.inf)
        i, j = np.unravel_index(int(masked.argmax()), masked.shape)
        grid = self.grid
        if not counted.any():
            return HotSpot(self.heat.ambient_c, (grid.x0_mm, grid.y0_mm), at_s)
        part = int(grid.part[i, j])
        place = (grid.x0_mm + float(i) * grid.step_mm, grid.y0_mm + float(j) * grid.step_mm)
        return HotSpot(float(masked[i, j]), place, at_s, self.nest.parts[part].id if part >= 0 else "")


def watch_of(nest: Nest, path: TimedPath, heat: Heat, thickness_mm: float, grid: Grid | None = None) -> WatchedSheet:
    """What has to be watched while a program runs."""
    grid = make_grid(nest, heat.grid_mm) if grid is None else grid
    expect_bounded(int(grid.metal.sum()), path, heat)
    return WatchedSheet(nest, grid, heat, thickness_mm, counted_points(grid, path, heat))


def hot_spots(nest: Nest, path: TimedPath, heat: Heat, thickness_mm: float, limit_c: float) -> tuple[HotSpot, ...]:
    """The hottest place of each burn, from when it begins until the next one does, or the last one's heat has spread.

    A place that has passed the limit is told once: afterwards it is not looked at any more.
    """
    watch = watch_of(nest, path, heat, thickness_mm)
    sheet, found = watch.sheet(), []
    fresh = np.ones(watch.grid.shape, dtype=np.bool_)
    events = events_of(path, watch.grid)
    begins = [float(burn.at_s[0]) for burn in path.burns]
    ends = [*begins[1:], max(path.end_s, float(path.burns[-1].at_s[-1])) + settling_s(heat)] if begins else []
    for begin_s, end_s in zip(begins, ends, strict=True):
        sheet.forget_peaks()
        sheet.run(events, end_s)
        peak_c = sheet.peak_c()
        found.append(watch.hottest(peak_c, begin_s, fresh))
        fresh &= peak_c <= limit_c
    return tuple(found)
