"""The one way kernels are compiled here: to machine code that is kept on disk between runs and runs without the GIL."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar, cast

import numba

F = TypeVar("F", bound=Callable[..., object])


def compiled(function: F) -> F:
    """Compile a function of numbers, arrays and named tuples of them with numba."""
    return cast(F, numba.njit(cache=True, nogil=True, error_model="numpy")(function))
