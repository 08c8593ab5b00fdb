"""How kernels are compiled: to machine code that is kept on disk between runs and runs without the GIL."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from kerfwise.models.kernels import inner, kept

F = TypeVar("F", bound=Callable[..., object])


# Kernels hold no arrays of their own, so that none need be counted (`_nrt`); they are called from kernels alone or
# from Python alone.
_OPTIONS: dict[str, Any] = {"nogil": True, "error_model": "numpy", "_nrt": False}


def compiled(function: F) -> F:
    """Compile a function of numbers, arrays and structs that other compiled functions call."""
    return inner(**_OPTIONS)(function)


def entry(function: F) -> F:
    """Compile a function that Python calls, and keep the machine code, with that of all it calls, on disk."""
    return kept(**_OPTIONS)(function)
