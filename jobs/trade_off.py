"""The trade-off of idle travel and overheats: the best plan at each of several prices of an overheat, simulated."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from kerfwise.encoder.facts.facts import Facts
from kerfwise.models.engines.solution import Progress, SolveOptions
from kerfwise.models.physics.heat import simulate
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.clock.heat_path import path_of_plan
from kerfwise.rules.profile.profile import Profile

from .ask import ask
from .priced_heat import cooler_orders
from .produce import Produced, produce


@dataclass(frozen=True, eq=False, slots=True)
class Trade:
    """One plan: the price of an overheat that it was made at, mm of idle travel, what it has of both, and its peak."""

    price_mm: float
    made: Produced
    overheats: int
    peak_c: float

    @property
    def plan(self) -> Plan:
        """The plan itself."""
        return self.made.plan

    @property
    def idle_mm(self) -> float:
        """Its idle travel."""
        return self.plan.totals.idle_mm

    @property
    def lawful(self) -> bool:
        """Whether the check takes it."""
        return self.made.verdict.ok

    def beats(self, other: Trade) -> bool:
        """Whether it is no worse in either and better in one."""
        mine, theirs = (self.overheats, self.idle_mm), (other.overheats, other.idle_mm)
        return mine != theirs and mine[0] <= theirs[0] and mine[1] <= theirs[1]


class TradeOff:
    """Plans of one nest at prices of an overheat.

    Parameters
    ----------
    facts
        Of the nest.
    profile
        Its own price of an overheat is not looked at.
    limits
        Of each plan.

    Raises
    ------
    RulesConflict
        If hard orders contradict each other.
    """

    def __init__(self, facts: Facts, profile: Profile, limits: SolveOptions) -> None:
        self._facts, self._limits = facts, limits
        self._profile = replace(profile, objective=replace(profile.objective, heat=0.0))
        self._asked = ask(facts, self._profile)
        self._cooler = cooler_orders(facts, self._profile, self._asked.stated)

    def fit(self) -> None:
        """Find out which orders overheat metal: the nest is simulated many times over, once for all prices."""
        if self._profile.heat.absorbed_power_w:
            self._cooler.start()

    def at(self, price_mm: float, progress: Progress | None = None) -> Trade:
        """The plan at a price, simulated; what was simulated for other prices helps.

        Raises
        ------
        RulesConflict
            If no lawful plan exists, or none was found.
        """
        facts = self._facts
        profile = replace(self._profile, objective=replace(self._profile.objective, heat=price_mm))
        made = produce(self._asked, profile, self._limits, progress, cooler=self._cooler)
        path = path_of_plan(made.plan, facts.nest, profile)
        found = simulate(facts.nest, path, profile.heat, profile.material.thickness_mm)
        return Trade(price_mm, made, found.overheats, found.peak_c)


def front(trades: Sequence[Trade]) -> list[Trade]:
    """Those lawful ones that no other beats, by idle travel; of equal ones the first."""
    kept: list[Trade] = []
    lawful = [trade for trade in trades if trade.lawful]
    for trade in sorted(lawful, key=lambda t: (t.idle_mm, t.overheats, t.price_mm)):
        if not kept or trade.overheats < kept[-1].overheats:
            kept.append(trade)
    return kept
