"""Engines: what turns a problem into a route; here the names that the command line knows them by."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

Engine = Literal["portfolio", "search", "ideals", "cp-sat-alone", "minizinc"]
Member = Literal["search", "ideals", "cp-sat"]

ENGINES: dict[Engine, str] = {
    "portfolio": "built in: runs the next three, chosen by size and statements (its old name cp-sat still works)",
    "search": "ruin and recreate with swaps of stretches: good plans, nothing proven",
    "ideals": "dynamic programming over the sets that can occur: exact where they are few",
    "cp-sat-alone": "constraint programming (CP-SAT) on the full model: plans and bounds",
    "minizinc": "the rules as a rule author reads them, solved by what MiniZinc has installed",
}

OLD_NAMES: dict[str, Engine] = {"cp-sat": "portfolio", "beam": "portfolio"}
"""Earlier names, which the command line still takes; earlier plans bear them."""

BUILT_IN: tuple[Engine, ...] = tuple(engine for engine in ENGINES if engine != "minizinc")
_ALONE: dict[Engine, Member] = {"search": "search", "ideals": "ideals", "cp-sat-alone": "cp-sat"}


def member_of(engine: Engine) -> Member | None:
    """The one member of the portfolio that an engine stands for; None for all of them.

    Examples
    --------
    >>> member_of("cp-sat-alone"), member_of("portfolio")
    ('cp-sat', None)
    """
    return _ALONE.get(engine)


# Plain ways to choose an order, for comparison: at random, and by the temperature of the sheet at that moment.

Strategy = Literal["ours", "shortest", "random", "realtime"]
STRATEGIES: Mapping[Strategy, str] = {
    "ours": "everything the profile asks, as cheap as can be found",
    "shortest": "the shortest idle travel that keeps the hard rules",
    "random": "any order that keeps the hard rules",
    "realtime": "each next contour by the temperature of the sheet at that moment (Verkhoturov et al.)",
}
"""Name of a strategy → what it does."""
