"""The heat equation in a thin sheet: ρ c g ∂T/∂t = ∇·(k g ∇T) - 2 h T + q, with T the excess over the air.

The kerf conducts nothing once it is cut, so that what is cut free keeps its heat. Explicit in time, central in space:
stable while α Δt / Δx² is at most 1/4. Rows of points as cold as the air, with no warm neighbour, are skipped.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from copy import copy
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Bools, Float32s
from kerfwise.rules.profile.plant_sections import MATERIALS, Heat

from .timed_path import Events, Grid, HeatRun, TimedPath, compiled, entry, events_of

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
    longest_step_s
        The longest step in time; shorter ones where the grid asks for it.
    """

    def __init__(self, grid: Grid, heat: Heat, thickness_mm: float, longest_step_s: float = LONGEST_STEP_S) -> None:
        data = MATERIALS[heat.material]
        point_mm2 = heat.grid_mm**2
        point_j_k = data.capacity_j_mm3 * thickness_mm * point_mm2
        cooling_1_s = 2 * heat.loss_w_m2k * 1e-6 * point_mm2 / point_j_k
        step_s = min(longest_step_s, time_step_s(heat))
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
                self._plate = swap_temperatures(self._plate)
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


# The kernel of the physical model: explicit steps of the heat equation over the points of a sheet.

COLD_K = np.float32(1e-7)
"""What is warmer than the air by less is taken for as cold as the air."""


class Plate(NamedTuple):
    """Arrays of (nx + 2, ny + 2), a rim of no metal around them: what the kernel reads and writes.

    `link_x[i, j]` is 1 while heat passes from (i, j) to (i + 1, j), `link_y` the same along y. `now` and `following`
    change places every step, as do `warm` and `warm_next`, which say of each row whether any point of it is warm.
    `above` counts the steps above the limit. `energy` is what was put in and what the air took, J.
    """

    metal: Bools
    link_x: Float32s
    link_y: Float32s
    now: Float32s
    following: Float32s
    peak: Float32s
    above: NDArray[np.int32]
    warm: Bools
    warm_next: Bools
    energy: NDArray[np.float64]


class Law(NamedTuple):
    """Length of a step, s; power that stays in the sheet, W; what warms a point by a kelvin, J.

    `spread` is α Δt / Δx², `keep` the share of its excess that a point keeps in a step, the air taking the rest.
    """

    step_s: float
    power_w: float
    point_j_k: float
    spread: np.float32
    keep: np.float32
    limit_k: np.float32


def new_plate(metal: Bools) -> Plate:
    """A sheet as warm as the air, uncut."""
    whole = np.pad(metal, 1)

    def zeros() -> Float32s:
        return np.zeros(whole.shape, dtype=np.float32)

    def row() -> Bools:
        return np.zeros(len(whole), dtype=np.bool_)

    above = np.zeros(whole.shape, dtype=np.int32)
    plate = Plate(whole, zeros(), zeros(), zeros(), zeros(), zeros(), above, row(), row(), np.zeros(2))
    plate.link_x[:-1] = whole[:-1] & whole[1:]
    plate.link_y[:, :-1] = whole[:, :-1] & whole[:, 1:]
    return plate


def swap_temperatures(plate: Plate) -> Plate:
    """The plate with the temperatures of now and of the next step in each other's place."""
    return plate._replace(now=plate.following, following=plate.now, warm=plate.warm_next, warm_next=plate.warm)


@entry
def run_steps(plate: Plate, law: Law, events: Events, steps: int, begin_s: float) -> bool:
    """So many steps from a time on; True if the temperatures are in `following` afterwards."""
    nx, ny = plate.now.shape[0] - 2, plate.now.shape[1] - 2
    dose, cut = np.searchsorted(events.dose_s, begin_s), np.searchsorted(events.cut_s, begin_s)
    a, b, warm, warm_next = plate.now, plate.following, plate.warm, plate.warm_next
    spread, keep = law.spread, law.keep
    for step in range(steps):
        until_s = begin_s + (step + 1) * law.step_s
        # A step ahead of the torch, so that no heat passes the kerf between a dose and the cut beside it.
        while cut < len(events.cut_s) and events.cut_s[cut] < until_s + law.step_s:
            i, j = events.link[cut] // ny + 1, events.link[cut] % ny + 1
            if events.along_y[cut]:
                plate.link_y[i, j] = 0
            else:
                plate.link_x[i, j] = 0
            cut += 1
        while dose < len(events.dose_s) and events.dose_s[dose] < until_s:
            _put_in(plate, law, a, warm, events.left[dose], events.right[dose], events.seconds[dose])
            dose += 1
        total_k = 0.0
        for i in range(1, nx + 1):
            if not (warm[i - 1] or warm[i] or warm[i + 1]):
                if warm_next[i]:
                    b[i] = 0
                    warm_next[i] = False
                continue
            row_k, hottest = np.float32(0), np.float32(0)
            for j in range(1, ny + 1):
                t = a[i, j]
                t += spread * (
                    plate.link_x[i, j] * (a[i + 1, j] - t)
                    + plate.link_x[i - 1, j] * (a[i - 1, j] - t)
                    + plate.link_y[i, j] * (a[i, j + 1] - t)
                    + plate.link_y[i, j - 1] * (a[i, j - 1] - t)
                )
                row_k += t
                t = t * keep if t > COLD_K else np.float32(0)
                b[i, j] = t
                plate.peak[i, j] = max(plate.peak[i, j], t)
                hottest = max(hottest, t)
            total_k += float(row_k)
            warm_next[i] = hottest > 0
            if hottest > law.limit_k:
                for j in range(1, ny + 1):
                    plate.above[i, j] += b[i, j] > law.limit_k
        plate.energy[1] += total_k * (1.0 - keep) * law.point_j_k
        a, b = b, a
        warm, warm_next = warm_next, warm
    return steps % 2 == 1


@compiled
def _put_in(plate: Plate, law: Law, a: Float32s, warm: Bools, left: int, right: int, seconds: float) -> None:
    """Half of the energy to each side of the kerf, all to the one that is metal."""
    ny = a.shape[1] - 2
    left_i, left_j, right_i, right_j = left // ny + 1, left % ny + 1, right // ny + 1, right % ny + 1
    on_left = left >= 0 and plate.metal[left_i, left_j]
    on_right = right >= 0 and plate.metal[right_i, right_j]
    joules = law.power_w * seconds
    each = np.float32(joules / law.point_j_k * (0.5 if on_left and on_right else 1.0))
    if on_left:
        a[left_i, left_j] += each
        warm[left_i] = True
    if on_right:
        a[right_i, right_j] += each
        warm[right_i] = True
    if on_left or on_right:
        plate.energy[0] += joules
