"""What a sheet is made of: the shipped table of thermal data, `materials.yaml`, sources and all."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources

import yaml


@dataclass(frozen=True, slots=True)
class ThermalData:
    """Conductivity W/(m·K), density kg/m³, heat capacity J/(kg·K), melting point °C, and where they come from."""

    title: str
    conductivity: float
    density: float
    heat_capacity: float
    melting_c: float
    source: str

    @property
    def diffusivity_mm2_s(self) -> float:
        """How fast temperature spreads: conductivity / (density · heat capacity), mm²/s."""
        return self.conductivity / (self.density * self.heat_capacity) * 1e6

    @property
    def capacity_j_mm3(self) -> float:
        """What a cubic millimetre takes to warm by a kelvin, J/(mm³·K)."""
        return self.density * self.heat_capacity * 1e-9


def _read() -> Mapping[str, ThermalData]:
    text = (resources.files(__package__) / "materials.yaml").read_text(encoding="utf-8")
    return {name: ThermalData(**row) for name, row in yaml.safe_load(text).items()}


MATERIALS: Mapping[str, ThermalData] = _read()
"""Name in a profile → thermal data.

Examples
--------
>>> round(MATERIALS["carbon-steel"].diffusivity_mm2_s, 1)
13.2
"""
