"""What a profile says of prices: the machine, gas, power, consumables, the sheet, and what a remnant is worth."""

from __future__ import annotations

from dataclasses import dataclass, field

from kerfwise.rules.options.members import Members
from kerfwise.rules.options.option import option
from kerfwise.rules.options.plain_values import Number, Text

_PRICE = Number(0)


@dataclass(frozen=True, slots=True)
class Consumables:
    """Electrodes, nozzles and the like: the price of a set, and how long one lasts."""

    set_price: float = field(default=0.0, metadata=option(_PRICE, "price of a set of them"))
    pierces: float = field(default=0.0, metadata=option(_PRICE, "pierces that wear a set out (0: they do not)"))
    torch_hours: float = field(
        default=0.0, metadata=option(_PRICE, "hours with the torch on that wear a set out (0: they do not)")
    )


@dataclass(frozen=True, slots=True)
class Prices:
    """What cutting and the sheet cost; without any price no cost is told."""

    machine_hour: float = field(default=0.0, metadata=option(_PRICE, "price of an hour of the machine"))
    gas_hour: float = field(
        default=0.0, metadata=option(_PRICE, "price of the gas of an hour with the torch on, piercing included")
    )
    gas_m3: float = field(
        default=0.0, metadata=option(_PRICE, "price of a cubic metre of gas; material.gas_flow says how much flows")
    )
    kwh: float = field(default=0.0, metadata=option(_PRICE, "price of a kilowatt-hour"))
    torch_kw: float = field(default=0.0, metadata=option(_PRICE, "kW drawn with the torch on, piercing included"))
    standby_kw: float = field(default=0.0, metadata=option(_PRICE, "kW drawn all the time"))
    consumables: Consumables = field(
        default=Consumables(), metadata=option(Members(Consumables), "electrodes, nozzles and the like")
    )
    sheet_kg: float = field(default=0.0, metadata=option(_PRICE, "price of a kilogram of the sheet"))
    sheet_each: float = field(default=0.0, metadata=option(_PRICE, "price of a whole sheet, instead of sheet_kg"))
    remnant_share: float = field(
        default=0.0,
        metadata=option(Number(0, 1), "share of the sheet's price that a saved remnant is still worth, by area"),
    )
    currency: str = field(default="EUR", metadata=option(Text(), "what prices are in, a word such as EUR"))

    @property
    def given(self) -> bool:
        """Whether there is any price at all."""
        worn = self.consumables.set_price
        return any((self.machine_hour, self.gas_hour, self.gas_m3, self.kwh, worn, self.sheet_kg, self.sheet_each))
