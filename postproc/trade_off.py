"""The trade-off of idle travel and overheats: the best plan at each of several prices of an overheat, simulated."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from ..encoder.facts.facts import Facts
from ..models.heat import simulate
from ..models.plan import Plan
from ..models.solution import Progress, SolveOptions
from ..rules.profile import Profile
from .heat_path import path_of_plan
from .heat_prices import pair_prices
from .produce import Asked, Produced, ask, produce


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

    def beats(self, other: Trade) -> bool:
        """Whether it is no worse in either and better in one."""
        mine, theirs = (self.overheats, self.idle_mm), (other.overheats, other.idle_mm)
        return mine != theirs and mine[0] <= theirs[0] and mine[1] <= theirs[1]


def trade_offs(
    facts: Facts, profile: Profile, prices_mm: Sequence[float], limits: SolveOptions, progress: Progress | None = None
) -> Iterator[Trade]:
    """A plan for each price, as it is found; the nest is simulated many times over first.

    Raises
    ------
    RulesConflict
        If no lawful plan exists, or none was found.
    """
    free = replace(profile, objective=replace(profile.objective, heat=0.0))
    stated = ask(facts, free).stated
    of_pairs = pair_prices(facts, profile, stated)
    for price_mm in prices_mm:
        statements = (*stated.statements, *of_pairs.statements(facts.nest, price_mm)) if price_mm else stated.statements
        made = produce(Asked(facts, replace(stated, statements=statements)), free, limits, progress)
        path = path_of_plan(made.plan, facts.nest, profile)
        found = simulate(facts.nest, path, profile.heat, profile.material.thickness_mm)
        yield Trade(price_mm, made, found.overheats, found.peak_c)


def front(trades: Sequence[Trade]) -> list[Trade]:
    """Those that no other beats, by idle travel; of equal ones the first."""
    kept: list[Trade] = []
    for trade in sorted(trades, key=lambda t: (t.idle_mm, t.overheats, t.price_mm)):
        if not kept or trade.overheats < kept[-1].overheats:
            kept.append(trade)
    return kept
