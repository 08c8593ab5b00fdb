"""Named tuples of arrays as what a compiled kernel takes: a pointer to where its arrays are.

Numba hands a named tuple on by copying, and counting the references to, each of its arrays at every call: half a
microsecond for the arrays of a search, dozens of times an iteration. Here it is one pointer to a block of words that
stays as it is, from which the compiler takes what it needs when it needs it: ten to twenty times as fast.
"""

from __future__ import annotations

from typing import Any, TypeVar, cast

import numpy as np

from kerfwise.models.kernels import compiling

WORD = 8  # bytes


T = TypeVar("T")


def for_kernels(fields: T) -> T:
    """A named tuple as kernels take it (see `Struct`)."""
    return cast(T, Struct(fields))


class Struct:
    """A named tuple of arrays (C order), whole numbers, floats and further named tuples; the arrays are not copied.

    Kernels read its fields by name and write to its arrays. `address` is where its words begin.
    """

    def __init__(self, fields: Any) -> None:
        self.fields = fields
        with compiling():
            from . import struct_types

            struct_types.take(Struct)

        self._types: Any = struct_types
        words: list[int] = []
        kinds: list[tuple[str, Any, int]] = []
        self._inner: list[Struct] = []
        for name, value in zip(fields._fields, fields, strict=True):
            kind, more = self._words(value)
            kinds.append((name, kind, len(words) * WORD))
            words += more
        self._block = np.array(words, dtype=np.int64)
        self.kind: Any = struct_types.StructType(type(fields).__name__, tuple(kinds))
        self.address = self._block.ctypes.data

    def _words(self, value: Any) -> tuple[Any, list[int]]:
        """The numba type of a field, and its words as numba lays them out."""
        match value:
            case np.ndarray():
                assert value.flags.c_contiguous
                return self._types.array(value), [
                    0,
                    0,
                    value.size,
                    value.itemsize,
                    value.ctypes.data,
                    *value.shape,
                    *value.strides,
                ]
            case int():
                return self._types.WHOLE, [value]
            case float():
                return self._types.FLOAT, [int(np.float64(value).view(np.int64))]
            case _:
                inner = Struct(value)
                self._inner.append(inner)
                return inner.kind, [inner.address]
