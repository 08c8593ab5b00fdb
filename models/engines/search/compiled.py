"""How kernels are compiled: to machine code that is kept on disk between runs and runs without the GIL."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba

from kerfwise.models.kernels import kept

F = TypeVar("F", bound=Callable[..., object])


# Kernels hold no arrays of their own, so that none need be counted (`_nrt`); they are called from kernels alone or
# from Python alone.
_OPTIONS: dict[str, Any] = {"nogil": True, "error_model": "numpy", "no_cfunc_wrapper": True, "_nrt": False}
_INNER: dict[str, Any] = {**_OPTIONS, "no_cpython_wrapper": True}
_HERE = Path(__file__).parent
_DIGEST = hashlib.sha256(b"".join(path.read_bytes() for path in sorted(_HERE.glob("*.py")))).hexdigest()[:16]


def compiled(function: F) -> F:
    """Compile a function of numbers, arrays and structs that other compiled functions call."""
    return cast(F, numba.njit(**_INNER)(function))


def entry(function: F) -> F:
    """Compile a function that Python calls, and keep the machine code, with that of all it calls, on disk.

    Numba compiles it anew only when its own file changes, not when those of the functions it calls do; so it is kept
    in a folder named after the text of all kernels.
    """
    config: Any = numba.config
    given = config.CACHE_DIR
    config.CACHE_DIR = str(Path(given or _HERE / "__pycache__") / f"kernels-{_DIGEST}")
    try:
        return kept(**_OPTIONS)(function)
    finally:
        config.CACHE_DIR = given
