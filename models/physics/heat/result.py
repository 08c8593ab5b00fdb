"""What a simulation of heat found: peaks, points too hot, and for how long, in all and part by part."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kerfwise.arrays import Bools, Float32s
from kerfwise.encoder.nest import Nest
from kerfwise.rules.profile.heat_section import Heat, HeatModel

from .grid import Grid


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
