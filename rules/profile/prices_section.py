"""What a profile says of prices: the machine, gas, power, consumables, the sheet, and what a remnant is worth."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
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


def _left_out(said: Sequence[str], missing: str, what: str) -> str:
    given = f"{' and '.join(said)} {'is' if len(said) == 1 else 'are'} given"
    return f"{given} without {missing}: the cost leaves out {what}"
