"""What a profile says of the sheet, of how the machine is set for it, and of the chart that knows more."""

from __future__ import annotations

from dataclasses import dataclass, field

from kerfwise.rules.charts.read import ChartUnits
from kerfwise.rules.charts.row_choice import ROW_CHOICE, RowChoice
from kerfwise.rules.options.option import option
from kerfwise.rules.options.plain_values import Choice, Flag, Text, TextOrWord
from kerfwise.rules.options.quantities import AMPS, FLOW, LENGTH, SHARE_OF_POWER, VOLTS, OrWord, over_zero

_HEIGHT = OrWord(LENGTH, none="unknown")
_POWER = OrWord(SHARE_OF_POWER, none="unknown")


@dataclass(frozen=True, slots=True)
class Material:
    """What is cut."""

    name: str = field(default="S235", metadata=option(Text(), "grade of the sheet"))
    thickness_mm: float = field(default=6.0, metadata=option(over_zero(LENGTH), "thickness of the sheet"))
    kerf_mm: float = field(default=1.5, metadata=option(LENGTH, "width that the cut burns away"))
    chart: str | None = field(
        default=None, metadata=option(TextOrWord("none"), "file of the chart that has what is not said here")
    )
    row: RowChoice | None = field(
        default=None,
        metadata=option(ROW_CHOICE, "the chart's row: its name, or columns of it (auto: by name and thickness)"),
    )
    interpolate: bool = field(
        default=False, metadata=option(Flag(), "whether what lies between two rows of the chart may be taken")
    )
    chart_units: ChartUnits = field(
        default="mm", metadata=option(Choice(("mm", "inch")), "units of a chart of QtPlasmaC, which does not say them")
    )
    pierce_height_mm: float | None = field(
        default=None, metadata=option(_HEIGHT, "height of the torch while it pierces; the program tells the operator")
    )
    cut_height_mm: float | None = field(
        default=None, metadata=option(_HEIGHT, "height of the torch while it cuts; the program tells the operator")
    )
    amps: float | None = field(
        default=None, metadata=option(OrWord(AMPS, none="unknown"), "current; the program tells the operator")
    )
    volts: float | None = field(
        default=None, metadata=option(OrWord(VOLTS, none="unknown"), "arc voltage; the program tells the operator")
    )
    power: float | None = field(
        default=None, metadata=option(_POWER, "power while cutting, of full power; GRBL's S words say it")
    )
    pierce_power: float | None = field(
        default=None, metadata=option(_POWER, "power while piercing (unknown: that of cutting)")
    )
    mark_power: float | None = field(default=None, metadata=option(_POWER, "power while marking"))
    gas: str | None = field(
        default=None, metadata=option(TextOrWord("unknown"), "gas, or gases; the program tells the operator")
    )
    gas_flow_m3_h: float | None = field(
        default=None, metadata=option(OrWord(FLOW, none="unknown"), "gas that flows with the torch on, for its price")
    )
