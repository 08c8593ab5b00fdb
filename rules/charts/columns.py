"""The columns that a material chart may have: what each is, in which units, and which option of a profile it sets."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from kerfwise.rules.options.kind import OptionKind
from kerfwise.rules.options.plain_values import Number, Text
from kerfwise.rules.options.quantities import (
    AMPS,
    DURATION,
    FLOW,
    LENGTH,
    SHARE_OF_POWER,
    SPEED,
    VOLTS,
    Quantity,
    over_zero,
)


@dataclass(frozen=True, slots=True)
class Column:
    """One column. `section` and `option` are the key of a profile that it sets, "" for what only names a row.

    Numbers beyond `least` and `most`, in the profile's own units, are taken for another unit than was meant.
    """

    kind: OptionKind
    help: str
    section: str = ""
    option: str = ""
    least: float | None = None
    most: float | None = None

    @property
    def key(self) -> tuple[str, str]:
        """Section and option, as one."""
        return self.section, self.option

    @property
    def units(self) -> tuple[str, ...]:
        """The units that a number may have here; none for texts and plain numbers."""
        return tuple(self.kind.units) if isinstance(self.kind, Quantity) else ()

    @property
    def blends(self) -> bool:
        """Whether a value lies between two others: numbers do, texts do not."""
        return not isinstance(self.kind, Text)


COLUMNS: Mapping[str, Column] = {
    "name": Column(Text(), "what the row is called"),
    "material": Column(Text(), "grade of the sheet", "material", "name"),
    "thickness": Column(over_zero(LENGTH), "thickness of the sheet", "material", "thickness", 0.05, 500.0),
    "kerf": Column(LENGTH, "width that the cut burns away", "material", "kerf", 0.01, 20.0),
    "feed": Column(SPEED, "speed while cutting", "machine", "cut_feed", 0.05, 2000.0),
    "mark_feed": Column(SPEED, "speed while marking", "machine", "mark_feed", 0.05, 5000.0),
    "pierce_delay": Column(DURATION, "time to pierce", "machine", "pierce_time", 0.0, 120.0),
    "pierce_height": Column(LENGTH, "height of the torch while it pierces", "material", "pierce_height", 0.0, 100.0),
    "cut_height": Column(LENGTH, "height of the torch while it cuts", "material", "cut_height", 0.0, 100.0),
    "amps": Column(AMPS, "current of the arc", "material", "amps"),
    "volts": Column(VOLTS, "voltage of the arc", "material", "volts"),
    "power": Column(SHARE_OF_POWER, "power while cutting", "material", "power"),
    "pierce_power": Column(SHARE_OF_POWER, "power while piercing", "material", "pierce_power"),
    "mark_power": Column(SHARE_OF_POWER, "power while marking", "material", "mark_power"),
    "gas": Column(Text(), "gas, or gases", "material", "gas"),
    "gas_flow": Column(FLOW, "gas that flows with the torch on", "material", "gas_flow"),
    "small_hole_feed": Column(
        Number(0.05, 1), "share of the feed in the smallest holes", "small_holes", "small_hole_feed"
    ),
    "corner_feed": Column(Number(0.05, 1), "share of the feed at corners", "corners", "corner_feed"),
}
"""Column → what it is. A row has those that it knows."""
PROCESS = ("amps", "gas")
"""Rows that differ in these are other settings of the machine: nothing lies between them."""
