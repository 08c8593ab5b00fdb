"""From a timed torch path to temperatures: the one way in to both models."""

from __future__ import annotations

import shapely

from kerfwise.arrays import Bools
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.rules.profile.heat_section import Heat

from .bounds import expect_bounded
from .grid import SCRAP, Grid, make_grid
from .logical import run_logical
from .physical import Look, run_physical
from .result import HeatResult, made_result
from .timed_path import TimedPath

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

    Raises
    ------
    InputError
        If the grid is too fine for the sheet or too coarse for its parts, the program takes over a week or too many
        steps, or the logical scheme would not be stable.
    """
    grid = make_grid(nest, heat.grid_mm) if grid is None else grid
    expect_bounded(int(grid.metal.sum()), path, heat)
    counted = counted_points(grid, path, heat)
    runner = run_logical if heat.model == "logical" else run_physical
    run = runner(grid, path, heat, thickness_mm, look)
    return made_result(heat.model, nest, grid, heat, run, counted)


def counted_points(grid: Grid, path: TimedPath, heat: Heat) -> Bools:
    """The points whose temperature counts: of parts and of the skeleton, not too near to the torch's path.

    Raises
    ------
    InputError
        If there are none, though the torch heats the sheet.
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
