"""CP-SAT: carries every statement, improves on a known route and proves bounds.

It is imported when it is first asked for: OR-Tools takes longer to load than a small nest to plan.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .model import CpsatOutcome, solve_cpsat

__all__ = ["CpsatOutcome", "solve_cpsat"]


def __getattr__(name: str) -> object:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from . import model

    return getattr(model, name)
