"""How the kernels of the simulation are compiled: machine code that is kept on disk between runs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from kerfwise.models.kernels import inner, kept

F = TypeVar("F", bound=Callable[..., object])

# Sums may be taken in any order, so that rows are added up several numbers at a time.
_OPTIONS: dict[str, Any] = {"nogil": True, "error_model": "numpy", "fastmath": {"reassoc", "contract", "nsz"}}


def compiled(function: F) -> F:
    """Compile a function that other compiled functions call."""
    return inner(**_OPTIONS)(function)


def entry(function: F) -> F:
    """Compile a function that Python calls, and keep the machine code beside its file."""
    return kept(**_OPTIONS)(function)
