"""The heat equation in a thin sheet: ρ c g ∂T/∂t = ∇·(k g ∇T) - 2 h T + q, with T the excess over the air.

The kerf conducts nothing once it is cut, so that what is cut free keeps its heat. Explicit in time, central in space:
stable while α Δt / Δx² is at most 1/4. Rows of points as cold as the air, with no warm neighbour, are skipped.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from copy import copy

import numpy as np

from kerfwise.arrays import Float32s
from kerfwise.rules.profile.heat_section import Heat
from kerfwise.rules.profile.materials import MATERIALS

from .events import Events, events_of
from .grid import Grid
from .result import HeatRun
from .stepping import Law, Plate, new_plate, run_steps, swapped
from .timed_path import TimedPath

Look = Callable[[float, Float32s], None]
"""Called with a time, s, and the temperatures (nx, ny), °C."""

RATIO = 0.2
"""α Δt / Δx²: up to 1/4 is stable, less is nearer to the solution right beside the torch."""
LONGEST_STEP_S = 1.0
MOST_AT_ONCE = 2_000_000_000
"""Points times steps in one call of the kernel, which Ctrl-C cannot interrupt: a second or two."""


def time_step_s(heat: Heat) -> float:
    """Length of a step, s."""
    return min(LONGEST_STEP_S, RATIO * heat.grid_mm**2 / MATERIALS[heat.material].diffusivity_mm2_s)


def settling_s(heat: Heat) -> float:
    """How long after the last cut its heat may still raise temperatures outside the kerf's band, s.

    The heat of a straight cut is felt most at a distance d after d² / 2α; four times that for good measure.
    """
    band_mm = max(heat.kerf_band_mm, 2 * heat.grid_mm)
    return 2 * band_mm**2 / MATERIALS[heat.material].diffusivity_mm2_s


def point_steps(sheet_mm2: float, end_s: float, heat: Heat) -> float:
    """Points times steps that a program takes at most, if every point of the sheet were warm all the time."""
    return sheet_mm2 / heat.grid_mm**2 * (end_s + settling_s(heat)) / time_step_s(heat)


class SheetSimulation:
    """A sheet that is being cut, as far as it has come.

    Parameters
    ----------
    grid
        Points of the sheet.
    heat
        Material, power, losses and the limit.
    thickness_mm
        Of the sheet.
    """

    def __init__(self, grid: Grid, heat: Heat, thickness_mm: float) -> None:
        data = MATERIALS[heat.material]
        point_mm2 = heat.grid_mm**2
        point_j_k = data.capacity_j_mm3 * thickness_mm * point_mm2
        cooling_1_s = 2 * heat.loss_w_m2k * 1e-6 * point_mm2 / point_j_k
        step_s = time_step_s(heat)
        self.now_s = 0.0
        self._ambient = np.float32(heat.ambient_c)
        self._plate = new_plate(grid.metal)
        self._law = Law(
            step_s,
            heat.absorbed_power_w,
            point_j_k,
            np.float32(data.diffusivity_mm2_s * step_s / point_mm2),
            np.float32(math.exp(-cooling_1_s * step_s)),
            np.float32(heat.limit_c - heat.ambient_c),
        )

    def run(self, events: Events, until_s: float) -> None:
        """Go on, in whole steps, to `until_s` or just after, with the events that lie between."""
        left = max(0, math.ceil((until_s - self.now_s) / self._law.step_s - 1e-9))
        at_once = max(1, MOST_AT_ONCE // self._plate.now.size)
        while left:
            steps = min(left, at_once)
            if run_steps(self._plate, self._law, events, steps, self.now_s):
                self._plate = swapped(self._plate)
            self.now_s += steps * self._law.step_s
            left -= steps

    def copy(self) -> SheetSimulation:
        """The same sheet once more: what is done to the one does nothing to the other."""
        other = copy(self)
        plate = self._plate
        other._plate = plate._replace(**{name: getattr(plate, name).copy() for name in Plate._fields})
        return other

    def cool_down(self) -> None:
        """Take all heat away, as an endless wait would; what is cut stays cut."""
        for array in (self._plate.now, self._plate.following, self._plate.warm, self._plate.warm_next):
            array[:] = 0

    def forget_peaks(self) -> None:
        """Peaks count from now on."""
        self._plate.peak[:] = self._plate.now

    def peak_c(self) -> Float32s:
        """The highest temperatures since `forget_peaks`, (nx, ny), °C."""
        return self._plate.peak[1:-1, 1:-1] + self._ambient

    def temperature_c(self) -> Float32s:
        """Temperatures now, (nx, ny), °C."""
        return self._plate.now[1:-1, 1:-1] + self._ambient

    def measured(self) -> HeatRun:
        """What has come of it so far."""
        plate, law = self._plate, self._law
        put_in, lost = plate.energy.tolist()
        stored = float(plate.now.sum(dtype=np.float64)) * law.point_j_k
        above_s = (plate.above[1:-1, 1:-1] * law.step_s).astype(np.float32)
        return HeatRun(plate.peak[1:-1, 1:-1] + self._ambient, above_s, put_in, lost, stored)


def run_physical(
    grid: Grid, path: TimedPath, heat: Heat, thickness_mm: float, look: tuple[float, Look] | None
) -> HeatRun:
    """Simulate a whole program; `look` is called every so many seconds, if given."""
    simulation, events = SheetSimulation(grid, heat, thickness_mm), events_of(path, grid)
    end_s = path.end_s + settling_s(heat)
    if look is not None:
        every_s, told = look
        for k in range(1, math.floor(end_s / every_s) + 1):
            simulation.run(events, k * every_s)
            told(simulation.now_s, simulation.temperature_c())
    simulation.run(events, end_s)
    return simulation.measured()
