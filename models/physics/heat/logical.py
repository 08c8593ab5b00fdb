"""The discrete-logical scheme of Verkhoturov et al. (2019): points pass heat on to their eight neighbours.

A point under the torch is at the melting temperature. Once a step each point, from the hottest to the coolest, gives
each of its neighbours on the sheet ΔT = T · K_c and keeps (T - ΔT · count) · K_l; a neighbour S becomes
(S + ΔT) · K_l. T is the excess over the air's temperature, since at that nothing is lost. The scheme knows neither
the sheet's thickness nor the kerf: heat passes a cut as if it were metal.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from kerfwise.arrays import Bools, Float32s
from kerfwise.encoder.errors import InputError
from kerfwise.rules.profile.heat_section import Heat
from kerfwise.rules.profile.materials import MATERIALS

from .compiled import entry
from .grid import Grid
from .physical import Look
from .result import HeatRun
from .timed_path import TimedPath

NEIGHBOURS = 8
COLD_K = 0.01
"""Points that are warmer than the air by less pass nothing on."""


class LogicalSheet:
    """A sheet in the scheme, as far as it has come.

    Raises
    ------
    InputError
        If K_c · 8 is over 1: a point would give more than it has, and temperatures would swing without end.
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
    return np.concatenate(times), np.concatenate(points)


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
