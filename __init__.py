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
        Conflict,
        Explanation,
        InputError,
        Job,
        KerfwiseError,
        Lock,
        Nest,
        NoPlan,
        Picture,
        Plan,
        Profile,
        Questions,
        Reached,
        Result,
        RulesConflict,
        Times,
        check,
        conflict,
        draw,
        explain,
        facts,
        load_profile,
        read_job,
        read_nest,
        read_plan,
        solve,
        times,
    )
    from .apps.distortion.api import distort
    from .apps.edit.api import edit
    from .apps.edit.edited_nest import EditedNest
    from .apps.heat.api import simulate
    from .apps.heat.simulation import Simulation
    from .apps.nesting.api import make, nest
    from .apps.nesting.nest_list import Nests
    from .apps.pareto.api import trade_off
    from .apps.pareto.pareto import Offer
    from .apps.resequence.api import resequence
    from .apps.resequence.result import Resequenced
    from .apps.viewer.compare.api import compare
    from .apps.viewer.compare.comparison import Comparison

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
    from importlib import import_module

    from .app_modules import interface_names

    found = globals()[name] = getattr(import_module(interface_names().get(name, "kerfwise.api")), name)
    return found


def __dir__() -> list[str]:
    return sorted(__all__)
