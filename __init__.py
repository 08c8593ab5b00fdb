"""kerfwise: a declarative, constraint-programming sequencer for thermal sheet cutting.

Examples
--------
>>> import kerfwise
>>> kerfwise.load_profile("laser-wood").material.name
'plywood'
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .api import (
        CheckResult,
        Comparison,
        Conflict,
        EditedNest,
        Explanation,
        InputError,
        Job,
        KerfwiseError,
        Lock,
        Nest,
        Nests,
        NoPlan,
        Offer,
        Picture,
        Plan,
        Profile,
        Questions,
        Reached,
        Resequenced,
        Result,
        RulesConflict,
        Simulation,
        Times,
        check,
        compare,
        conflict,
        distort,
        draw,
        edit,
        explain,
        facts,
        load_profile,
        make,
        nest,
        read_job,
        read_nest,
        read_plan,
        resequence,
        simulate,
        solve,
        times,
        trade_off,
    )

__version__ = "0.1.0"
__all__ = [
    "CheckResult",
    "Comparison",
    "Conflict",
    "EditedNest",
    "Explanation",
    "InputError",
    "Job",
    "KerfwiseError",
    "Lock",
    "Nest",
    "Nests",
    "NoPlan",
    "Offer",
    "Picture",
    "Plan",
    "Profile",
    "Questions",
    "Reached",
    "Resequenced",
    "Result",
    "RulesConflict",
    "Simulation",
    "Times",
    "__version__",
    "check",
    "compare",
    "conflict",
    "distort",
    "draw",
    "edit",
    "explain",
    "facts",
    "load_profile",
    "make",
    "nest",
    "read_job",
    "read_nest",
    "read_plan",
    "resequence",
    "simulate",
    "solve",
    "times",
    "trade_off",
]


def __getattr__(name: str) -> object:
    """A name of the Python interface, imported when it is first used."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from . import api

    found = globals()[name] = getattr(api, name)
    return found


def __dir__() -> list[str]:
    return sorted(__all__)
