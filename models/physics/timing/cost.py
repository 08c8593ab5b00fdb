"""What a sheet costs to cut: the machine by the hour, its gas by the hour that the torch is on."""

from __future__ import annotations

from dataclasses import dataclass

from kerfwise.rules.profile.time_section import Prices

from .clock import RunTimes

_HOUR_S = 3600.0


@dataclass(frozen=True, slots=True)
class Cost:
    """Price of the machine's time and of the gas, in `currency`."""

    machine: float
    gas: float
    currency: str

    @property
    def total(self) -> float:
        """Both together."""
        return self.machine + self.gas


def cost_of(times: RunTimes, prices: Prices) -> Cost | None:
    """The cost of one sheet; None where the profile has no prices.

    Examples
    --------
    >>> cost_of(RunTimes((), cut_s=1700.0, idle_s=1800.0, pierce_s=100.0), Prices(80.0, 12.0))
    Cost(machine=80.0, gas=6.0, currency='EUR')
    """
    if not prices.machine_hour and not prices.gas_hour:
        return None
    gas_s = times.cut_s + times.pierce_s
    return Cost(times.total_s / _HOUR_S * prices.machine_hour, gas_s / _HOUR_S * prices.gas_hour, prices.currency)
