"""What functions that only kernels call are compiled to: no machine code of their own, and the same answers."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numba
import numpy as np
import pytest
from numba.core import registry
from numba.core.errors import TypingError

from kerfwise.models.kernel_code import Code
from kerfwise.models.kernels import Kernel, inner, kept


@inner(nogil=True)
def thrice(x: int) -> int:
    return 3 * x


@inner(nogil=True)
def summed(n: int) -> int:
    held = np.zeros(n, np.int64)
    for k in range(n):
        held[k] = thrice(k)
    total = 0
    for x in held:
        total += x
    return total


@inner(nogil=True)
def factorial(n: int) -> int:
    return 1 if n < 2 else n * factorial(n - 1)


@inner(nogil=True)
def refuse(n: int) -> int:
    if n > 3:
        raise ValueError("more than three")
    return n


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "kept"))


def code_of(kernel: Any) -> Any:
    (made,) = kernel.dispatcher.overloads.values()
    return made.library


def has_machine_code(name: str) -> bool:
    engine: Any = registry.cpu_target.target_context.codegen()._engine
    return bool(engine.is_symbol_defined(name))


def symbol_of(kernel: Any) -> str:
    (made,) = kernel.dispatcher.overloads.values()
    return str(made.fndesc.llvm_func_name)


def test_only_what_python_calls_has_machine_code_of_its_own() -> None:
    def both(n: int) -> int:
        return summed(n) + thrice(n)

    outer: Any = kept(nogil=True)(both)
    assert outer(5) == 3 * (0 + 1 + 2 + 3 + 4) + 15
    assert isinstance(code_of(outer), Code)
    assert (code_of(outer)._made, code_of(summed)._made, code_of(thrice)._made) == (True, False, False)
    assert has_machine_code(symbol_of(outer))
    again: Any = kept(nogil=True)(both)  # loaded
    assert again(5) == outer(5)
    assert sum(again.dispatcher._cache_hits.values()) == 1


def test_a_kernel_may_be_called_by_another_and_by_python() -> None:
    shared: Any = kept(nogil=True)(lambda n: summed(n) + 1)
    other: Any = kept(nogil=True)(lambda n: shared(n) + thrice(n))
    assert [other(k) for k in range(4)] == [1, 4, 10, 19]
    assert [shared(k) for k in range(4)] == [1, 1, 4, 10]


def test_what_calls_itself_and_what_fails() -> None:
    whole: Any = kept(nogil=True)(lambda n: factorial(n))
    assert [whole(k) for k in range(6)] == [1, 1, 2, 6, 24, 120]
    strict: Any = kept(nogil=True)(lambda n: refuse(n))
    assert strict(3) == 3
    with pytest.raises(ValueError, match="more than three"):
        strict(4)


def test_others_compile_as_ever_also_after_a_kernel_that_does_not_compile() -> None:
    maker: Any = registry.cpu_target.target_context.codegen()
    wrong: Any = kept(nogil=True)(lambda n: n.not_there)
    with pytest.raises(TypingError):
        wrong(1)
    assert maker._library_class is not Code
    kept(nogil=True)(lambda n: summed(n))(3)  # numba's own function for zeros is compiled within a kernel first

    @numba.njit
    def zeros(n: int) -> int:
        return len(np.zeros(n, np.int64))

    assert zeros(4) == 4
    (made,) = zeros.overloads.values()
    assert not isinstance(made.library, Code)


def test_the_comparison_can_fail() -> None:
    """An inner function of which Python asks the machine code has it from then on."""
    alone: Any = Kernel(lambda n: thrice(n) + 2, {"nogil": True}, keep=False)
    assert alone(2) == 8
    assert code_of(alone)._made
