"""What a profile says of the machine, the material, heat in it, and prices."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from typing import Any, Literal

import yaml

from kerfwise.encoder.geometry.segment import Point
from kerfwise.rules.charts.chart import ROW_CHOICE, RowChoice
from kerfwise.rules.charts.read_chart import ChartUnits
from kerfwise.rules.options.kind import Choice, Flag, Number, Text, TextOrWord
from kerfwise.rules.options.option import Members, options_of, setting
from kerfwise.rules.options.quantities import (
    AMPS,
    CUT_FEED,
    DURATION,
    FLOW,
    KERF,
    LENGTH,
    MARK_FEED,
    PIERCE_TIME,
    SHARE_OF_POWER,
    SPEED,
    THICKNESS,
    TORCH_HEIGHT,
    VOLTS,
    LengthSpan,
    OrWord,
    PointXY,
    likely,
    positive,
)

# The name of an NC dialect, or the file of a plant's own.

ENDINGS = (".yaml", ".yml")


def is_own_dialect(name: str) -> bool:
    """Whether a profile names a dialect file of its own."""
    return name.endswith(ENDINGS)


@dataclass(frozen=True, slots=True)
class DialectName(Choice):
    """A dialect that comes with kerfwise, or a path that ends in .yaml, as seen from here or from the profile."""

    def read(self, node: yaml.Node) -> str | None:
        if isinstance(node, yaml.ScalarNode) and str(node.value).endswith(ENDINGS):
            return str(node.value)
        return Choice.read(self, node)

    def schema(self) -> dict[str, Any]:
        return {"anyOf": [Choice.schema(self), {"type": "string", "pattern": r"\.ya?ml$"}]}

    def expected(self) -> str:
        return f"{Choice.expected(self)}, or a dialect file of your own that ends in .yaml"


# What a profile says of the machine: what it can do, how far it reaches, and the language its control speaks.

Process = Literal["plasma", "oxyfuel", "laser", "water-jet"]
PROCESSES: tuple[Process, ...] = ("plasma", "oxyfuel", "laser", "water-jet")
DIALECTS = (
    "burny", "eia", "essi", "fanuc", "grbl", "hpgl", "linuxcnc", "linuxcnc-qtplasmac", "mach", "marlin", "sinumerik",
)  # fmt: skip
Origin = Literal["drawing", "sheet-corner"]
ORIGINS: tuple[Origin, ...] = ("drawing", "sheet-corner")
PierceDwell = Literal["machine", "program"]
MACHINE_WAITS = (
    "a control that holds the pierce delay itself probes for the sheet and waits at every start, also beside the "
    "sheet: say false, or machine.pierce_dwell: program where the control does neither"
)
"""Why edge starts, and starts in kerfs, do not go with a pierce delay in the machine."""
_SPAN = LengthSpan(none="unknown")
Axis = Literal["x", "y"]


@dataclass(frozen=True, slots=True)
class Torches:
    """Torches on one gantry, which follow the same path side by side."""

    count: int = setting(1, Number(1, 8, whole=True), "torches on the gantry")
    spacing_mm: float = setting(0.0, likely(LENGTH, 0.0, 20_000.0), "from each torch to the next")
    axis: Axis = setting("y", Choice(("x", "y")), "the axis along which they stand, upwards")
    up_to_mm: float | None = setting(
        None,
        OrWord(likely(positive(LENGTH), 1.0, 20_000.0), "spacing"),
        "where torches can be moved: the greatest spacing, spacing the least",
    )

    @property
    def apart(self) -> str:
        """How far they stand apart, as a person says it, and along which axis."""
        most = "" if self.up_to_mm is None else f" to {self.up_to_mm:g}"
        return f"{self.spacing_mm:g}{most} mm apart along {self.axis.upper()}"

    @property
    def several(self) -> bool:
        """Whether there are more than one."""
        return self.count > 1

    @property
    def step(self) -> Point:
        """From each torch to the next, mm."""
        return (self.spacing_mm, 0.0) if self.axis == "x" else (0.0, self.spacing_mm)

    def shift(self, torch: int) -> Point:
        """From torch 1 to another, mm.

        Examples
        --------
        >>> Torches(3, 200.0, "x").shift(3)
        (400.0, 0.0)
        """
        x, y = self.step
        return x * (torch - 1), y * (torch - 1)


@dataclass(frozen=True, slots=True)
class Machine:
    """What the machine can do, and the language its control speaks."""

    process: Process = setting("plasma", Choice(PROCESSES), "what cuts")
    dialect: str = setting("linuxcnc-qtplasmac", DialectName(DIALECTS), "language of the NC program")
    accept_dialect: bool = setting(
        False, Flag(), "write in this dialect, though for another process, or with words of its builder's choice"
    )
    home: Point = setting((0.0, 0.0), PointXY(), "where the torch starts and returns to, in machine coordinates")
    origin: Origin = setting(
        "drawing", Choice(ORIGINS), "the machine's zero: that of the drawing, or the sheet's corner"
    )
    travel_x_mm: Point | None = setting(None, _SPAN, "least and most X that the torch can go to")
    travel_y_mm: Point | None = setting(None, _SPAN, "least and most Y that the torch can go to")
    cut_feed_mm_s: float = setting(2500 / 60, CUT_FEED, "speed while cutting")
    mark_feed_mm_s: float = setting(100.0, MARK_FEED, "speed while marking")
    travel_mm_s: float = setting(250.0, likely(SPEED, 1.0, 10_000.0), "speed of idle travel")
    pierce_time_s: float = setting(0.5, PIERCE_TIME, "time to pierce")
    pierce_dwell: PierceDwell | None = setting(
        None,
        Choice(("dialect", "machine", "program"), none="dialect"),
        "who waits for the pierce (dialect: as it says)",
    )
    edge_preheat_s: float = setting(
        0.0, likely(DURATION, 0.0, 600.0), "time to preheat the sheet's edge before an edge start"
    )
    kerf_start: bool = setting(
        True, Flag(), "begin in an old kerf as at the sheet's edge; false: wait as long as for a pierce"
    )
    torches: Torches = setting(Torches(), Members(Torches), "torches side by side, for nests of copies")
    mark_time_s: float = setting(0.2, likely(DURATION, 0.0, 120.0), "time to start marking")
    head: str = setting("up", Choice(("up", "down")), "whether the head is lifted on idle travel")

    @property
    def unpierced_s(self) -> float:
        """How long the torch stands, lit, where a cut begins without a pierce: at the sheet's edge, or in an old kerf.

        A flame cuts no cold metal: where the profile has no preheat of its own it takes as long as for a pierce.
        """
        if self.process == "oxyfuel" and self.edge_preheat_s <= 0:
            return self.pierce_time_s
        return self.edge_preheat_s

    @property
    def at_hole_s(self) -> float:
        """How long it stands at a hole that was pierced before: a flame has to heat its edge again."""
        return self.unpierced_s if self.process == "oxyfuel" else 0.0


# What a profile says of the sheet, of how the machine is set for it, and of the chart that knows more.

_HEIGHT = OrWord(TORCH_HEIGHT, none="unknown")
_POWER = OrWord(SHARE_OF_POWER, none="unknown")


@dataclass(frozen=True, slots=True)
class Material:
    """What is cut."""

    name: str = setting("S235", Text(), "grade of the sheet")
    thickness_mm: float = setting(6.0, THICKNESS, "thickness of the sheet")
    kerf_mm: float = setting(1.5, KERF, "width that the cut burns away")
    chart: str | None = setting(None, TextOrWord("none"), "file of the chart that has what is not said here")
    row: RowChoice | None = setting(
        None, ROW_CHOICE, "the chart's row: its name, or columns of it (auto: by name and thickness)"
    )
    interpolate: bool = setting(False, Flag(), "whether what lies between two rows of the chart may be taken")
    chart_units: ChartUnits = setting(
        "mm", Choice(("mm", "inch")), "units of a chart of QtPlasmaC, which does not say them"
    )
    pierce_height_mm: float | None = setting(
        None, _HEIGHT, "height of the torch while it pierces; the program tells the operator"
    )
    cut_height_mm: float | None = setting(
        None, _HEIGHT, "height of the torch while it cuts; the program tells the operator"
    )
    amps: float | None = setting(None, OrWord(AMPS, none="unknown"), "current; the program tells the operator")
    volts: float | None = setting(None, OrWord(VOLTS, none="unknown"), "arc voltage; the program tells the operator")
    power: float | None = setting(None, _POWER, "power while cutting, of full power; GRBL's S words say it")
    pierce_power: float | None = setting(None, _POWER, "power while piercing (unknown: that of cutting)")
    mark_power: float | None = setting(None, _POWER, "power while marking")
    gas: str | None = setting(None, TextOrWord("unknown"), "gas, or gases; the program tells the operator")
    gas_flow_m3_h: float | None = setting(
        None, OrWord(FLOW, none="unknown"), "gas that flows with the torch on, for its price"
    )
    process: str | None = setting(
        None,
        TextOrWord("unknown"),
        "what the control calls it: a number, or blocks with ; between, for a dialect's {process}",
    )


BY_THICKNESS = ("material.kerf", "machine.cut_feed", "machine.pierce_time")
"""Values that another thickness of the same sheet needs otherwise."""


@dataclass(frozen=True, slots=True)
class KeptOfThickness:
    """Values that are still those of the thickness that a profile was made for, though the sheet has another."""

    made_for_mm: float
    keys: tuple[str, ...]

    def told(self, machine: Machine, material: Material) -> str:
        """That they stay as they are, for a planner.

        Examples
        --------
        >>> kept = KeptOfThickness(6.0, ("material.kerf", "machine.pierce_time"))
        >>> kept.told(Machine(), Material(thickness_mm=12.0)).partition(":")[0]
        'material.thickness is 12 mm, and kerf 1.5 mm and pierce_time 0.5 s stay as they are for 6 mm'
        """
        values = {
            f"{section}.{o.key}": f"{o.key} {o.kind.write(getattr(owner, o.name))}"
            for section, owner in (("machine", machine), ("material", material))
            for o in options_of(owner)
        }
        words = [values[key] for key in self.keys]
        listed = ", ".join(words[:-1]) + (" and " if words[1:] else "") + words[-1]
        verb, them = ("stay as they are", "them") if words[1:] else ("stays as it is", "it")
        return (
            f"material.thickness is {material.thickness_mm:g} mm, and {listed} {verb} for {self.made_for_mm:g} mm: say "
            f"{them} for this sheet too ({', '.join(self.keys)}), or name a material chart"
        )


def kept_of_thickness(base_mm: float, values: Mapping[str, Any], texts: Mapping[str, str]) -> KeptOfThickness | None:
    """Which values are still those of another thickness, in a profile over one for `base_mm`.

    `texts` has the keys that it states itself. What its chart gives it is for its thickness.
    """
    thickness_mm, chart, before = values["material"].thickness_mm, values["chart"], values["kept"]
    made_for_mm = base_mm if before is None else before.made_for_mm
    if math.isclose(thickness_mm, made_for_mm, rel_tol=1e-6) or chart is not None:
        return None
    left = BY_THICKNESS if before is None else before.keys
    keys = tuple(key for key in left if key not in texts)
    return KeptOfThickness(made_for_mm, keys) if keys else None


# What a sheet is made of: the shipped table of thermal data, `materials.yaml`, sources and all.


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


# What a profile says of heat: how much the cut leaves in the sheet, and what the simulation takes for too hot.

HeatModel = Literal["physical", "logical"]


@dataclass(frozen=True, slots=True)
class Heat:
    """How heat is simulated, and what counts as too hot."""

    model: HeatModel = setting(
        "physical", Choice(("physical", "logical")), "heat equation, or the scheme of Verkhoturov et al."
    )
    material: str = setting("carbon-steel", Choice(tuple(MATERIALS)), "thermal data, of the shipped table")
    absorbed_power_w: float = setting(
        1300.0, Number(0, 1e6), "W that stay in the sheet while the torch is on, piercing included"
    )
    ambient_c: float = setting(20.0, Number(-50, 200), "temperature of the air and sheet, °C")
    limit_c: float = setting(115.0, Number(-50, 3000), "a point hotter than this is an overheat, °C")
    kerf_band_mm: float = setting(
        10.0, likely(LENGTH, 0.0, 1000.0), "metal this near to the cut is hot anyway and not counted"
    )
    loss_w_m2k: float = setting(
        15.0, Number(0, 1e5), "W per m² and kelvin that each face of the sheet gives to the air"
    )
    grid_mm: float = setting(5.0, likely(positive(LENGTH), 0.05, 1000.0), "distance between points of the grid")
    logical_conduction: float = setting(
        0.1, Number(0, 1), "share that each of 8 neighbours is given a step, scheme logical"
    )
    logical_retention: float = setting(0.9998, Number(0, 1), "share that the air leaves, scheme logical")
    logical_step_s: float = setting(
        1.0, likely(positive(DURATION), 1e-3, 3600.0), "time between two steps of the scheme logical"
    )


# What a profile says of prices: the machine, gas, power, consumables, the sheet, and what a remnant is worth.

_PRICE = Number(0)


@dataclass(frozen=True, slots=True)
class Consumables:
    """Electrodes, nozzles and the like: the price of a set, and how long one lasts."""

    set_price: float = setting(0.0, _PRICE, "price of a set of them")
    pierces: float = setting(0.0, _PRICE, "pierces that wear a set out (0: they do not)")
    torch_hours: float = setting(0.0, _PRICE, "hours with the torch on that wear a set out (0: they do not)")


@dataclass(frozen=True, slots=True)
class Prices:
    """What cutting and the sheet cost; without any price no cost is told."""

    machine_hour: float = setting(0.0, _PRICE, "price of an hour of the machine")
    gas_hour: float = setting(0.0, _PRICE, "price of the gas of an hour with the torch on, piercing included")
    gas_m3: float = setting(0.0, _PRICE, "price of a cubic metre of gas; material.gas_flow says how much flows")
    kwh: float = setting(0.0, _PRICE, "price of a kilowatt-hour")
    torch_kw: float = setting(0.0, _PRICE, "kW drawn with the torch on, piercing included")
    standby_kw: float = setting(0.0, _PRICE, "kW drawn all the time")
    consumables: Consumables = setting(Consumables(), Members(Consumables), "electrodes, nozzles and the like")
    sheet_kg: float = setting(0.0, _PRICE, "price of a kilogram of the sheet")
    sheet_each: float = setting(0.0, _PRICE, "price of a whole sheet, instead of sheet_kg")
    remnant_share: float = setting(
        0.0, Number(0, 1), "share of the sheet's price that a saved remnant is still worth, by area"
    )
    currency: str = setting("EUR", Text(), "what prices are in, a word such as EUR")

    @property
    def given(self) -> bool:
        """Whether there is any price at all."""
        worn = self.consumables.set_price
        return any((self.machine_hour, self.gas_hour, self.gas_m3, self.kwh, worn, self.sheet_kg, self.sheet_each))

    def half_given(self, gas_flow_m3_h: float | None) -> Iterator[str]:
        """A sentence for each thing that is said in part, so that the cost leaves it out.

        `gas_flow_m3_h` is how much gas flows, None where nobody says so.

        Examples
        --------
        >>> list(Prices(machine_hour=80, torch_kw=40).half_given(None))
        ['prices.torch_kw is given without prices.kwh: the cost leaves out the power']
        """
        worn = self.consumables
        lasts = [f"prices.consumables.{key}" for key in ("pierces", "torch_hours") if getattr(worn, key)]
        drawn = [f"prices.{key}" for key in ("torch_kw", "standby_kw") if getattr(self, key)]
        if lasts and not worn.set_price:
            yield _left_out(lasts, "prices.consumables.set_price", "consumables")
        if drawn and not self.kwh:
            yield _left_out(drawn, "prices.kwh", "the power")
        if self.given and gas_flow_m3_h and not (self.gas_m3 or self.gas_hour):
            yield _left_out(["material.gas_flow"], "prices.gas_m3 or gas_hour", "the gas")
        if self.remnant_share and not (self.sheet_kg or self.sheet_each):
            yield _left_out(["prices.remnant_share"], "prices.sheet_kg or sheet_each", "sheet and remnant")


def _left_out(names: Sequence[str], missing: str, what: str) -> str:
    text = f"{' and '.join(names)} {'is' if len(names) == 1 else 'are'} given"
    return f"{text} without {missing}: the cost leaves out {what}"


# Prices of an overheat that plans are made at where nobody names others.

PRICES_MM = (0.0, 10.0, 30.0, 100.0, 300.0)
"""In mm of idle travel."""
