"""Bounds on what every plan costs, from a state on or from the start.

They are imported when they are first asked for: their linear programs bring scipy along, which most runs do without.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .completion import Completion, TooMuch, complete
    from .flow import FlowBound, flow_bound
    from .flow_work import MOST_SITES, SETTING_OUT, sets_out_s

__all__ = ["MOST_SITES", "SETTING_OUT", "Completion", "FlowBound", "TooMuch", "complete", "flow_bound", "sets_out_s"]
_HOME = {
    "Completion": "completion",
    "TooMuch": "completion",
    "complete": "completion",
    "MOST_SITES": "flow_work",
    "SETTING_OUT": "flow_work",
    "sets_out_s": "flow_work",
}


def __getattr__(name: str) -> object:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f".{_HOME.get(name, 'flow')}", __name__), name)
