"""What a profile says of heat: how much the cut leaves in the sheet, and what the simulation takes for too hot."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from kerfwise.rules.options.option import option
from kerfwise.rules.options.plain_values import Choice, Number
from kerfwise.rules.options.quantities import DURATION, LENGTH, over_zero

from .materials import MATERIALS

HeatModel = Literal["physical", "logical"]


@dataclass(frozen=True, slots=True)
class Heat:
    """How heat is simulated, and what counts as too hot."""

    model: HeatModel = field(
        default="physical",
        metadata=option(Choice(("physical", "logical")), "heat equation, or the scheme of Verkhoturov et al."),
    )
    material: str = field(
        default="carbon-steel", metadata=option(Choice(tuple(MATERIALS)), "thermal data, of the shipped table")
    )
    absorbed_power_w: float = field(
        default=1300.0, metadata=option(Number(0), "W that stay in the sheet while the torch is on, piercing included")
    )
    ambient_c: float = field(default=20.0, metadata=option(Number(-50, 200), "temperature of the air and sheet, °C"))
    limit_c: float = field(default=115.0, metadata=option(Number(-50), "a point hotter than this is an overheat, °C"))
    kerf_band_mm: float = field(
        default=10.0, metadata=option(LENGTH, "metal this near to the cut is hot anyway and not counted")
    )
    loss_w_m2k: float = field(
        default=15.0, metadata=option(Number(0), "W per m² and kelvin that each face of the sheet gives to the air")
    )
    grid_mm: float = field(default=5.0, metadata=option(over_zero(LENGTH), "distance between points of the grid"))
    logical_conduction: float = field(
        default=0.1, metadata=option(Number(0, 1), "share that each of 8 neighbours is given a step, scheme logical")
    )
    logical_retention: float = field(
        default=0.9998, metadata=option(Number(0, 1), "share that the air leaves, scheme logical")
    )
    logical_step_s: float = field(
        default=1.0, metadata=option(over_zero(DURATION), "time between two steps of the scheme logical")
    )
