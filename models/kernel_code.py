"""What numba compiles a kernel to: `late_code.Code` for the versions of numba it is known for, else numba's own.

`Code` is a class between numba's internals, which no version promises. It was tried with numba 0.63.1, 0.65.1, 0.66.0
and 0.68.1. Before 0.63 numba lacks what it needs; of what comes after 0.68 nobody can know. Outside these, and where a
version is not told in numbers, kernels are compiled as numba always does: slower, with the same answers.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numba

FIRST, LAST = (0, 63), (0, 68)
"""The versions of numba, major and minor, that `Code` is known for."""


def known() -> bool:
    """Whether `Code` is known for the numba that is installed."""
    major, minor = numba.version_info.short
    return isinstance(major, int) and isinstance(minor, int) and FIRST <= (major, minor) <= LAST


@contextmanager
def code_of_kernels() -> Iterator[None]:
    """What numba compiles here becomes `Code`, where that is known, and no other thread compiles meanwhile."""
    if not known():
        yield
        return
    from numba.core import registry
    from numba.core.compiler_lock import global_compiler_lock

    from .late_code import Code

    maker: Any = registry.cpu_target.target_context.codegen()
    with global_compiler_lock:
        usual = maker._library_class
        maker._library_class = Code
        try:
            yield
        finally:
            maker._library_class = usual
