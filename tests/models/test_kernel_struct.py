"""Kernels that take named tuples: as plain Python reads them, one kernel for each kind."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import numba
import numpy as np
import pytest
from numpy.typing import NDArray

from kerfwise.models.jit import KERNEL
from kerfwise.models.jit import jit as jit_kernels
from kerfwise.models.kernel_struct import kernel_argument


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "kept"))
    return tmp_path / "kept"


class _Within(NamedTuple):
    numbers: NDArray[np.float64]
    factor: float


class _Fields(NamedTuple):
    within: _Within
    small: np.float32
    size: int
    written: NDArray[np.int32]


def struct_read(fields: Any, more: int) -> float:
    total = 0.0
    for k in range(fields.size):
        fields.written[k] = k + more
        total += fields.within.numbers[k] * fields.within.factor
    return total + fields.small


def test_a_kernel_reads_named_tuples_as_plain_python_does(folder: Path) -> None:
    def fields() -> _Fields:
        inside = _Within(np.array([1.5, -2.0, 4.0]), -0.5)
        return _Fields(inside, np.float32(-0.25), 3, np.zeros(3, dtype=np.int32))

    kernel: Any = jit_kernels(**KERNEL)(struct_read)
    expected, compiled, kept = fields(), fields(), kernel_argument(fields())
    assert kernel(compiled, 7) == kernel(kept, 7) == struct_read(expected, 7) == -2.0
    assert compiled.written.tolist() == kept.written.tolist() == expected.written.tolist() == [7, 8, 9]
    assert len(list(folder.rglob("*.kernel"))) == 1, "one kernel for both ways to hand it on"


def test_structs_of_other_kinds_have_kernels_of_their_own(folder: Path) -> None:
    kernel: Any = jit_kernels(**KERNEL)(struct_read)
    for kind in (np.int32, np.int64):
        written = np.zeros(1, dtype=kind)
        kernel(_Fields(_Within(np.ones(1), 1.0), np.float32(0), 1, written), 5)
        assert written.tolist() == [5]
    assert len(list(folder.rglob("*.kernel"))) == 2
