"""Bounds on what every plan costs, from a state on or from the start.

They are imported when they are first asked for: their linear programs bring scipy along, which most runs do without.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .completion import Completion, TooMuch, complete
    from .excuses import excused_um, fewest_excuses, without_excuses
    from .flow import FlowBound, flow_bound

__all__ = [
    "Completion",
    "FlowBound",
    "TooMuch",
    "complete",
    "excused_um",
    "fewest_excuses",
    "flow_bound",
    "without_excuses",
]
_HOME = {
    "Completion": "completion",
    "TooMuch": "completion",
    "complete": "completion",
    "excused_um": "excuses",
    "fewest_excuses": "excuses",
    "without_excuses": "excuses",
}


def __getattr__(name: str) -> object:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f".{_HOME.get(name, 'flow')}", __name__), name)
