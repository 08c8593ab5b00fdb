"""What functions that only kernels call are compiled to: no machine code of their own, and the same answers."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numba
import numpy as np
import pytest
from numba.core import registry
from numba.core.codegen import JITCodeLibrary
from numba.core.errors import TypingError
from numba.misc.init_utils import generate_version_info

from kerfwise.models.kernel_code import known
from kerfwise.models.kernels import Kernel, inner, kept

swapped = pytest.mark.skipif(not known(), reason="numba is of a version that code made late is not known for")


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


def made_late(code: Any) -> bool:
    from kerfwise.models.late_code import Code

    return isinstance(code, Code)


def symbol_of(kernel: Any) -> str:
    (made,) = kernel.dispatcher.overloads.values()
    return str(made.fndesc.llvm_func_name)


@swapped
def test_only_what_python_calls_has_machine_code_of_its_own() -> None:
    def both(n: int) -> int:
        return summed(n) + thrice(n)

    outer: Any = kept(nogil=True)(both)
    assert outer(5) == 3 * (0 + 1 + 2 + 3 + 4) + 15
    assert made_late(code_of(outer))
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
    assert maker._library_class is JITCodeLibrary
    kept(nogil=True)(lambda n: summed(n))(3)  # numba's own function for zeros is compiled within a kernel first

    @numba.njit
    def zeros(n: int) -> int:
        return len(np.zeros(n, np.int64))

    assert zeros(4) == 4
    (made,) = zeros.overloads.values()
    assert type(made.library) is JITCodeLibrary


@swapped
def test_the_comparison_can_fail() -> None:
    """An inner function of which Python asks the machine code has it from then on."""
    alone: Any = Kernel(lambda n: thrice(n) + 2, {"nogil": True}, keep=False)
    assert alone(2) == 8
    assert code_of(alone)._made


VERSIONS = {
    "0.60.0": False,
    "0.62.1": False,
    "0.63.0": True,
    "0.66.0": True,
    "0.68.1": True,
    "0.69.0dev0+12.g1a2b": False,
    "0.100.0": False,
    "1.0": False,
    "1": False,
    "0+unknown": False,
    "unknown": False,
}


@pytest.mark.parametrize("version", VERSIONS)
def test_numbas_internals_are_used_in_versions_that_were_tried(version: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(numba, "version_info", generate_version_info(version))
    assert known() is VERSIONS[version]


@pytest.mark.parametrize("version", ["0.62.1", "0.69.0"])
def test_with_another_version_numba_compiles_as_ever(version: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(numba, "version_info", generate_version_info(version))

    @inner(nogil=True)
    def root(n: int) -> float:
        return float(np.sqrt(n) / 3)

    @inner(nogil=True)
    def roots(n: int) -> float:
        total = 0.0
        for k in range(n):
            total += root(k)
        return total

    outer: Any = kept(nogil=True)(lambda n: roots(n) - root(n))
    usual = [outer(k) for k in range(9)]
    libraries = [code_of(kernel) for kernel in (outer, roots, root)]
    assert all(type(one) is JITCodeLibrary for one in libraries)
    monkeypatch.undo()
    assert usual == [outer.plainly(k) for k in range(9)]
