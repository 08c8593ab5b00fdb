"""From a timed torch path to temperatures: the one way in to both models, within bounds."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import shapely
from numpy.typing import NDArray

from kerfwise.arrays import Bools, Float32s
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.rules.profile.plant_sections import MATERIALS, Heat

from .physical import Look, point_steps, run_physical
from .timed_path import SCRAP, Grid, HeatResult, HeatRun, TimedPath, entry, made_result, make_grid

LEAST_BAND_STEPS = 1.5
"""The torch heats points up to 1.42 grid steps beside its path: so far they say nothing of the metal around."""


def simulate(
    nest: Nest,
    path: TimedPath,
    heat: Heat,
    thickness_mm: float,
    look: tuple[float, Look] | None = None,
    grid: Grid | None = None,
) -> HeatResult:
    """Simulate a program and count what gets too hot.

    Parameters
    ----------
    nest
        Sheet and parts.
    path
        Where the torch burns, and when.
    heat
        The profile's section `heat`; its `model` decides which model runs.
    thickness_mm
        Of the sheet.
    look
        Seconds and a function: it is called with the time and the temperatures (nx, ny), °C, whenever so many seconds
        have passed.
    grid
        That of `make_grid`, where several programs of one nest are simulated: it is made once then, and may be shared
        by threads.

    Raises InputError if the grid is too fine for the sheet or too coarse for its parts, the program takes over a week
    or too many steps, or the logical scheme would not be stable.
    """
    grid = make_grid(nest, heat.grid_mm) if grid is None else grid
    expect_bounded(int(grid.metal.sum()), path, heat)
    counted = counted_points(grid, path, heat)
    runner = run_logical if heat.model == "logical" else run_physical
    run = runner(grid, path, heat, thickness_mm, look)
    return made_result(heat.model, nest, grid, heat, run, counted)


def counted_points(grid: Grid, path: TimedPath, heat: Heat) -> Bools:
    """The points whose temperature counts: of parts and of the skeleton, not too near to the torch's path.

    Raises InputError if there are none, though the torch heats the sheet.
    """
    within_mm = max(heat.kerf_band_mm, LEAST_BAND_STEPS * heat.grid_mm)
    band = grid.near((shapely.LineString(burn.xy) for burn in path.burns), within_mm)
    counted: Bools = grid.metal & ~band & (grid.part != SCRAP)
    if path.burns and heat.absorbed_power_w and not counted.any():
        raise InputError(
            f"no point of the grid counts: all lie within {within_mm:g} mm of a cut; give a finer heat.grid than "
            f"{heat.grid_mm:g} mm, or a narrower heat.kerf_band than {heat.kerf_band_mm:g} mm"
        )
    return counted


# The discrete-logical scheme of Verkhoturov et al. (2019): points pass heat on to their eight neighbours.
#
# A point under the torch is at the melting temperature. Once a step each point, from the hottest to the coolest,
# gives each of its neighbours on the sheet ΔT = T · K_c and keeps (T - ΔT · count) · K_l; a neighbour S becomes (S +
# ΔT) · K_l. T is the excess over the air's temperature, since at that nothing is lost. The scheme knows neither the
# sheet's thickness nor the kerf: heat passes a cut as if it were metal.

NEIGHBOURS = 8
COLD_K = 0.01
"""Points that are warmer than the air by less pass nothing on."""


class LogicalSheet:
    """A sheet in the scheme, as far as it has come.

    Raises InputError if K_c · 8 is over 1: a point would give more than it has, and temperatures would swing without
    end.
    """

    def __init__(self, grid: Grid, heat: Heat) -> None:
        if heat.logical_conduction * NEIGHBOURS > 1:
            raise InputError(
                f"heat.logical_conduction: {heat.logical_conduction:g} for each of {NEIGHBOURS} neighbours is more "
                f"than a point has; the scheme is stable up to {1 / NEIGHBOURS:g}"
            )
        self.grid, self.heat = grid, heat
        self.excess = np.zeros(grid.shape, dtype=np.float32)
        self.peak = np.zeros(grid.shape, dtype=np.float32)
        self.above = np.zeros(grid.shape, dtype=np.int32)

    def step(self, under_torch: NDArray[np.int64]) -> None:
        """One step: these points (flat indices) melt, then heat spreads."""
        heat = self.heat
        melting_k = MATERIALS[heat.material].melting_c - heat.ambient_c
        self.excess.reshape(-1)[under_torch] = melting_k
        np.maximum(self.peak, self.excess, out=self.peak)
        spread(self.excess, self.grid.metal, heat.logical_conduction, heat.logical_retention)
        np.maximum(self.peak, self.excess, out=self.peak)
        self.above += self.excess > heat.limit_c - heat.ambient_c

    def temperature_c(self) -> Float32s:
        """Temperatures now, (nx, ny), °C."""
        return self.excess + np.float32(self.heat.ambient_c)


def run_logical(
    grid: Grid, path: TimedPath, heat: Heat, thickness_mm: float, look: tuple[float, Look] | None
) -> HeatRun:
    """Simulate a whole program; `thickness_mm` means nothing to this scheme."""
    sheet = LogicalSheet(grid, heat)
    at_s, point = _visits(path, grid)
    every_s, told = look or (math.inf, None)
    shown = 0
    for k in range(math.ceil(path.end_s / heat.logical_step_s)):
        begin, end = np.searchsorted(at_s, (k * heat.logical_step_s, (k + 1) * heat.logical_step_s))
        sheet.step(point[begin:end])
        now_s = (k + 1) * heat.logical_step_s
        if told is not None and now_s >= (shown + 1) * every_s:
            shown = math.floor(now_s / every_s)
            told(now_s, sheet.temperature_c())
    ambient = np.float32(heat.ambient_c)
    return HeatRun(sheet.peak + ambient, (sheet.above * heat.logical_step_s).astype(np.float32))


def _visits(path: TimedPath, grid: Grid) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """When the torch is at which point of the sheet, in order of time."""
    times, points = [np.zeros(0)], [np.zeros(0, dtype=np.int64)]
    nx, ny = grid.shape
    for burn in path.burns:
        gaps = np.hypot(*np.diff(burn.xy, axis=0).T) / grid.step_mm
        along = np.concatenate([[0.0], np.cumsum(gaps + np.diff(burn.at_s))])  # grows while it moves or stands
        samples = np.linspace(0.0, along[-1], max(2, math.ceil(along[-1] * 4)))
        i, j = (
            np.floor((np.interp(samples, along, burn.xy[:, k]) - first) / grid.step_mm + 0.5).astype(np.int64)
            for k, first in ((0, grid.x0_mm), (1, grid.y0_mm))
        )
        inside = (i >= 0) & (i < nx) & (j >= 0) & (j < ny)
        inside[inside] = grid.metal[i[inside], j[inside]]
        times.append(np.interp(samples, along, burn.at_s)[inside])
        points.append((i * ny + j)[inside])
    at_s = np.concatenate(times)
    order = np.argsort(at_s, kind="stable")  # several torches burn at one time
    return at_s[order], np.concatenate(points)[order]


def spread(excess: Float32s, metal: Bools, conduction: float, retention: float) -> None:
    """One step of spreading, in place: points that are equally hot give in the order of their index.

    Examples
    --------
    >>> sheet = np.zeros((3, 3), dtype=np.float32)
    >>> sheet[1, 1] = 800
    >>> spread(sheet, np.ones((3, 3), dtype=np.bool_), 0.1, 1.0)
    >>> float(sheet.sum())
    800.0
    """
    warm = np.flatnonzero(excess > COLD_K)
    _pass_on(excess, metal, warm[np.argsort(-excess.reshape(-1)[warm], kind="stable")], conduction, retention)


@entry
def _pass_on(excess: Float32s, metal: Bools, order: NDArray[np.int64], conduction: float, retention: float) -> None:
    nx, ny = excess.shape
    for flat in order:
        i, j = flat // ny, flat % ny
        given, count = excess[i, j] * conduction, 0
        for u in range(max(0, i - 1), min(nx, i + 2)):
            for v in range(max(0, j - 1), min(ny, j + 2)):
                if (u != i or v != j) and metal[u, v]:
                    excess[u, v] = (excess[u, v] + given) * retention
                    count += 1
        excess[i, j] = (excess[i, j] - given * count) * retention


# How much a simulation may take: said before any memory is taken or any step is made.

MOST_S = 7 * 86400.0
"""The longest program that is simulated, s: a week."""
MOST_POINT_STEPS = 2e13
"""The most points times steps: half a day on a usual machine."""


def expect_bounded(metal_points: int, path: TimedPath, heat: Heat) -> None:
    """Refuse what would take days or all memory.

    Parameters
    ----------
    metal_points
        Points of the grid that are metal.
    path
        Where the torch burns, and when.
    heat
        The profile's section `heat`.

    Raises InputError if the program takes over a week, naming the contour that takes the longest; or if the grid's
    points times the steps in time are too many, naming the profile's key.
    """
    expect_short(path)
    if heat.model == "logical":
        steps, key = metal_points * path.end_s / heat.logical_step_s, "heat.logical_step"
        text = f"{heat.logical_step_s:g} s"
        least = f"{heat.logical_step_s * steps / MOST_POINT_STEPS:.2g} s"
    else:
        steps, key = point_steps(metal_points * heat.grid_mm**2, path.end_s, heat), "heat.grid"
        text = f"{heat.grid_mm:g} mm"
        least = f"{heat.grid_mm * (steps / MOST_POINT_STEPS) ** 0.25:.2g} mm"
    if steps > MOST_POINT_STEPS:
        raise InputError(
            f"{key}: {text} makes {steps:.1e} steps of points of this program, and {MOST_POINT_STEPS:.0e} is the "
            f"most; give about {least} or more"
        )


def expect_short(path: TimedPath, file: str | Path | None = None) -> None:
    """Refuse a path of more than a week. Raises InputError with the file, and the contour that takes the longest."""
    if not path.end_s <= MOST_S:
        contour, what, seconds = longest(path)
        raise InputError(
            f"the program takes {path.end_s / 3600:.4g} h, and heat is simulated for up to {MOST_S / 3600:g} h; the "
            f"longest is {contour}, {what} takes {seconds / 3600:.4g} h: correct its feeds and waits",
            file=file,
        )


def longest(path: TimedPath) -> tuple[str, str, float]:
    """The contour of the longest cut or wait of a path, which of them it is, in words, and how long it takes, s.

    Examples
    --------
    >>> import numpy as np
    >>> from .timed_path import in_order, torch_on
    >>> line = np.array([[0.0, 0.0], [9.0, 0.0]])
    >>> longest(in_order([torch_on("A", line, 0.0, 5.0), torch_on("B", line, 95.0, 99.0)], 99.0))
    ('B', 'whose way and wait before it', 90.0)
    """
    begins_s = [0.0, *(float(burn.at_s[-1]) for burn in path.burns)]
    found = [(burn.seconds, burn.contour, "whose cut") for burn in path.burns]
    found += [
        (float(burn.at_s[0]) - begin_s, burn.contour, "whose way and wait before it")
        for begin_s, burn in zip(begins_s, path.burns, strict=False)
    ]
    found.append((path.end_s - begins_s[-1], "the end", "whose way and wait"))
    seconds, contour, what = max(found)
    return contour, what, seconds
