"""The engines by the names that the command line knows them by."""

from __future__ import annotations

from typing import Literal

Engine = Literal["cp-sat", "search", "ideals", "beam", "cp-sat-alone", "minizinc"]
Member = Literal["search", "ideals", "beam", "cp-sat"]

ENGINES: dict[Engine, str] = {
    "cp-sat": "built in: a portfolio of the next four, chosen by size and statements",
    "search": "ruin and recreate with swaps of stretches: good plans, nothing proven",
    "ideals": "dynamic programming over the sets that can occur: exact where they are few",
    "beam": "the same, cut short: keeps the most promising sets, twice as many each time",
    "cp-sat-alone": "constraint programming on the full model: plans and bounds",
    "minizinc": "the rules as a rule author reads them, solved by what MiniZinc has installed",
}

BUILT_IN: tuple[Engine, ...] = tuple(engine for engine in ENGINES if engine != "minizinc")
_ALONE: dict[Engine, Member] = {"search": "search", "ideals": "ideals", "beam": "beam", "cp-sat-alone": "cp-sat"}


def member_of(engine: Engine) -> Member | None:
    """The one member of the portfolio that an engine stands for; None for all of them.

    Examples
    --------
    >>> member_of("cp-sat-alone"), member_of("cp-sat")
    ('cp-sat', None)
    """
    return _ALONE.get(engine)
