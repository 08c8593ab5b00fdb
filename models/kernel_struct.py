"""Named tuples of arrays as what a compiled kernel takes: a pointer to where its arrays are.

Numba hands a named tuple on by copying each of its arrays at every call: half a microsecond for those of a search,
dozens of times an iteration, and most of what a kernel takes to compile. Here it is one pointer to a block of words
that stays as it is, from which the compiler takes what it needs when it needs it: ten to twenty times as fast.
"""

from __future__ import annotations

import hashlib
import sys
import threading
from numbers import Integral
from typing import Any, NamedTuple, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

T = TypeVar("T")
_lock = threading.RLock()

WORD = 8  # bytes


def kernel_argument(fields: T) -> T:
    """A named tuple as kernels take it (see `Struct`); as plain Python takes it, it is still the same."""
    return cast(T, Struct(fields))


def as_struct(given: Any) -> Any:
    """A named tuple as a `Struct`; all else as it is."""
    return Struct(given) if isinstance(given, tuple) and hasattr(given, "_fields") else given


class StructKind(NamedTuple):
    """What distinguishes structs for a compiler: fields, each a name, a kind and its place in bytes.

    A kind is `int`, `np.float64`, `np.float32`, dtype and dimensions of an array in C order, or that of another struct.
    """

    label: str
    fields: tuple[tuple[str, object, int], ...]

    @property
    def digest(self) -> str:
        """A word for the fields."""
        return hashlib.sha256(repr(self.fields).encode()).hexdigest()[:8]


class Struct:
    """A named tuple of arrays (C order), whole numbers, floats and further named tuples; the arrays are not copied.

    Kernels read its fields by name and write to its arrays. `address` is where its words begin.
    """

    def __init__(self, fields: Any) -> None:
        self.fields = fields
        self._made: tuple[StructKind, int, NDArray[np.int64], list[Struct]] | None = None

    def __getattr__(self, name: str) -> Any:
        return getattr(self.fields, name)

    @property
    def kind(self) -> StructKind:
        """What a kernel is compiled for."""
        return self._words[0]

    @property
    def address(self) -> int:
        """Where its words begin."""
        return self._words[1]

    @property
    def _words(self) -> tuple[StructKind, int, NDArray[np.int64], list[Struct]]:
        """Its kind, where its words begin, they, as numba lays them out, and the structs within; made once."""
        with _lock:  # threads share a struct, and none may put words in the place of those that another reads
            if self._made is None:
                self._made = self._laid_out()
            return self._made

    def _laid_out(self) -> tuple[StructKind, int, NDArray[np.int64], list[Struct]]:
        words: list[int] = []
        kinds: list[tuple[str, object, int]] = []
        within: list[Struct] = []
        for name, value in zip(self.fields._fields, self.fields, strict=True):
            at, kind = len(words) * WORD, cast(object, int)
            if isinstance(value, np.ndarray):
                assert value.flags.c_contiguous, f"{name} is no array in C order"
                kind = (value.dtype, value.ndim)
                words += [0, 0, value.size, value.itemsize, value.ctypes.data, *value.shape, *value.strides]
            elif isinstance(value, float | np.float32):
                kind = np.float32 if isinstance(value, np.float32) else np.float64
                words.append(int.from_bytes(kind(value).tobytes(), sys.byteorder, signed=True))
            elif isinstance(value, Integral):
                words.append(int(value))
            else:
                inside = value if isinstance(value, Struct) else Struct(value)
                within.append(inside)
                kind = inside.kind
                words.append(inside.address)
            kinds.append((name, kind, at))
        kind = StructKind(type(self.fields).__name__, tuple(kinds))
        block = np.array(words, dtype=np.int64)
        return kind, int(block.ctypes.data), block, within
