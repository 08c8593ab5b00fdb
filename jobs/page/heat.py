"""Temperatures of the sheet over the program, as few numbers as a screen can show."""

from __future__ import annotations

import base64
import zlib

import numpy as np

from kerfwise.arrays import Float32s
from kerfwise.encoder.errors import InputError
from kerfwise.jobs.given import Given
from kerfwise.models.physics.heat import simulate
from kerfwise.models.physics.heat.grid import MOST_POINTS, make_grid
from kerfwise.models.physics.heat.physical import point_steps
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.clock.heat_path import path_of_plan
from kerfwise.postproc.report.page_data import Data, short

FRAMES = 60
SQUARES = 160
"""Squares of a frame along its longer side, at the most."""
OVER = 2.0
"""The numbers reach so many times as far above the air as the limit does."""
_QUICK = 5e9
"""Points times steps that are simulated unasked: some ten seconds."""


def heat_data(given: Given, plan: Plan, wanted: bool | None = None) -> Data | None:
    """Frames of the sheet, evenly over the program: a byte a square, 0 as warm as the air, 255 the hottest.

    All frames follow each other, rows from the bottom up, deflated and in base64. None where heat is not `wanted`, the
    plan states no times, or nobody asked (None) and it would take long.
    """
    nest, heat = given.nest, given.profile.heat
    timed = any(planned.cut.end_s for planned in plan.cuts)
    if wanted is False or not timed or plan.already or not heat.absorbed_power_w:
        return None
    area_mm2 = nest.sheet.polygon.area
    long = point_steps(area_mm2, plan.totals.time_s, heat) > _QUICK or area_mm2 / heat.grid_mm**2 > MOST_POINTS
    if wanted is None and long:
        return None
    try:
        path = path_of_plan(plan, nest, given.profile)
        grid = make_grid(nest, heat.grid_mm)
        step = max(1, -(-max(grid.shape) // SQUARES))
        top_c = heat.ambient_c + OVER * (heat.limit_c - heat.ambient_c)
        frames: list[bytes] = []
        at_s: list[float] = []

        def look(now_s: float, field: Float32s) -> None:
            if len(frames) < FRAMES:
                frames.append(_squares(field, step, heat.ambient_c, top_c))
                at_s.append(short(now_s, 2))

        thickness_mm = given.profile.material.thickness_mm
        found = simulate(nest, path, heat, thickness_mm, (path.end_s / FRAMES, look), grid)
    except InputError:
        if wanted:
            raise
        return None
    wide, high = (-(-count // step) for count in grid.shape)
    return {
        "model": found.model,
        "at_s": at_s,
        "wide": wide,
        "high": high,
        "left_mm": short(grid.x0_mm - grid.step_mm / 2),
        "bottom_mm": short(grid.y0_mm - grid.step_mm / 2),
        "square_mm": short(grid.step_mm * step),
        "ambient_c": heat.ambient_c,
        "limit_c": heat.limit_c,
        "top_c": top_c,
        "peak_c": round(found.peak_c, 1),
        "overheats": found.overheats,
        "frames": base64.b64encode(zlib.compress(b"".join(frames), 9)).decode(),
    }


def _squares(field: Float32s, step: int, ambient_c: float, top_c: float) -> bytes:
    """The hottest point of each square, as bytes, row by row."""
    wide, high = (-(-count // step) * step for count in field.shape)
    padded = np.full((wide, high), ambient_c, dtype=np.float32)
    padded[: field.shape[0], : field.shape[1]] = field
    hottest = padded.reshape(wide // step, step, high // step, step).max(axis=(1, 3))
    scaled = np.clip((hottest - ambient_c) / (top_c - ambient_c), 0, 1) * 255
    return bytes(np.round(scaled).astype(np.uint8).T.tobytes())
