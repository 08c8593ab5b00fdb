"""What a sheet costs: the machine, gas and power by the hour, consumables by pierces and hours, the sheet itself."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields
from typing import Any, Protocol

from kerfwise.rules.profile.prices_section import Prices

_HOUR_S = 3600.0


class Spent(Protocol):
    """Seconds that a program spends: `RunTimes`, or the `TimeReport` of a plan."""

    @property
    def cut_s(self) -> float:
        """With the torch on and moving."""
        ...

    @property
    def pierce_s(self) -> float:
        """Piercing."""
        ...

    @property
    def total_s(self) -> float:
        """The whole program."""
        ...


@dataclass(frozen=True, slots=True)
class Cost:
    """What one sheet of a nest costs, in `currency`: of each thing, and in all.

    `machine` is the machine's time, `sheet` the stock, and `remnant` what is saved of it: it counts against the rest.

    Examples
    --------
    >>> cost = Cost(machine=40.0, gas=6.0, sheet=70.0, remnant=10.0)
    >>> cost.total, str(cost)
    (106.0, '106.00 EUR: machine 40.00, gas 6.00, sheet 70.00, remnant -10.00')
    """

    machine: float = 0.0
    gas: float = 0.0
    power: float = 0.0
    consumables: float = 0.0
    sheet: float = 0.0
    remnant: float = 0.0
    currency: str = "EUR"

    @property
    def total(self) -> float:
        """All together, less the remnant."""
        return self.machine + self.gas + self.power + self.consumables + self.sheet - self.remnant

    @property
    def parts(self) -> Iterator[tuple[str, float]]:
        """What each thing costs, by name, where it costs anything; a remnant is negative."""
        signs = {"remnant": -1}
        amounts = ((f.name, getattr(self, f.name)) for f in fields(self) if f.name != "currency")
        return ((name, signs.get(name, 1) * amount) for name, amount in amounts if amount)

    def as_json(self) -> dict[str, Any]:
        """The cost as plans and `kerfwise time --json` have it."""
        amounts = {f.name: round(getattr(self, f.name), 4) for f in fields(self) if f.name != "currency"}
        return {**amounts, "total": round(self.total, 4), "currency": self.currency}

    @staticmethod
    def of_json(data: Mapping[str, Any]) -> Cost:
        """The same, read back; of plans of before, which knew fewer things that cost."""
        return Cost(**{f.name: data[f.name] for f in fields(Cost) if f.name in data})

    def __str__(self) -> str:
        told = ", ".join(f"{name} {amount:.2f}" for name, amount in self.parts)
        return f"{self.total:.2f} {self.currency}" + (f": {told}" if told else "")


def cost_of(
    spent: Spent, prices: Prices, pierces: int = 0, gas_m3_hour: float = 0.0, sheet: float = 0.0, remnant: float = 0.0
) -> Cost | None:
    """The cost of one sheet; None where the profile has no prices.

    Gas and the torch's power are paid while it is on, piercing included. Consumables wear by both: a set is worn out
    when its share of pierces and its share of hours add up to one.

    Parameters
    ----------
    spent
        Seconds of the program.
    prices
        The profile's.
    pierces
        How many the program makes.
    gas_m3_hour
        Gas that flows while the torch is on, m³/h.
    sheet, remnant
        What the sheet costs, and what is saved of it.

    Examples
    --------
    >>> from kerfwise.models.physics.timing.clock import RunTimes
    >>> times = RunTimes((), cut_s=1700.0, idle_s=1800.0, pierce_s=100.0)
    >>> str(cost_of(times, Prices(80.0, 12.0)))
    '86.00 EUR: machine 80.00, gas 6.00'
    """
    if not prices.given:
        return None
    hours, on_hours = spent.total_s / _HOUR_S, (spent.cut_s + spent.pierce_s) / _HOUR_S
    worn = prices.consumables
    sets = (pierces / worn.pierces if worn.pierces else 0.0) + (
        on_hours / worn.torch_hours if worn.torch_hours else 0.0
    )
    return Cost(
        machine=hours * prices.machine_hour,
        gas=on_hours * (prices.gas_hour + gas_m3_hour * prices.gas_m3),
        power=prices.kwh * (on_hours * prices.torch_kw + hours * prices.standby_kw),
        consumables=sets * worn.set_price,
        sheet=sheet,
        remnant=remnant,
        currency=prices.currency,
    )
