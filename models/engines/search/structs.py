"""Named tuples of arrays as what a compiled kernel takes: a pointer to where its arrays are.

Numba hands a named tuple on by copying, and counting the references to, each of its arrays at every call: half a
microsecond for the arrays of a search, dozens of times an iteration. Here it is one pointer to a block of words that
stays as it is, from which the compiler takes what it needs when it needs it: ten to twenty times as fast.
"""

from __future__ import annotations

import hashlib
from typing import Any, TypeVar, cast

import numpy as np
from numba import extending
from numba.core import cgutils, types
from numba.core.typing.templates import AttributeTemplate
from numba.np.numpy_support import from_dtype

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
        words: list[int] = []
        kinds: list[tuple[str, types.Type, int]] = []
        self._inner: list[Struct] = []
        for name, value in zip(fields._fields, fields, strict=True):
            kind, more = self._words(value)
            kinds.append((name, kind, len(words) * WORD))
            words += more
        self._block = np.array(words, dtype=np.int64)
        self.kind = StructType(type(fields).__name__, tuple(kinds))
        self.address = self._block.ctypes.data

    def _words(self, value: Any) -> tuple[types.Type, list[int]]:
        """The numba type of a field, and its words as numba lays them out."""
        match value:
            case np.ndarray():
                assert value.flags.c_contiguous
                kind = types.Array(from_dtype(value.dtype), value.ndim, "C")
                return kind, [0, 0, value.size, value.itemsize, value.ctypes.data, *value.shape, *value.strides]
            case int():
                return types.int64, [value]
            case float():
                return types.float64, [int(np.float64(value).view(np.int64))]
            case _:
                inner = Struct(value)
                self._inner.append(inner)
                return inner.kind, [inner.address]


class StructType(types.Type):
    """The numba type of a `Struct`; `fields` are names, types and offsets in bytes."""

    def __init__(self, label: str, fields: tuple[tuple[str, types.Type, int], ...]) -> None:
        self.fields = fields
        digest = hashlib.sha256(repr(fields).encode()).hexdigest()[:8]
        super().__init__(name=f"{label}_{digest}")


def _type_of_field(_: object, struct: StructType, name: str) -> types.Type | None:
    return next((kind for field, kind, _ in struct.fields if field == name), None)


def _unbox(_: StructType, value: Any, c: Any) -> Any:
    """The pointer that stands for a `Struct` in a kernel."""
    address = c.pyapi.object_getattr_string(value, "address")
    pointer = c.pyapi.long_as_voidptr(address)
    c.pyapi.decref(address)
    return _compiler.NativeValue(pointer)


def _load(context: Any, builder: Any, struct: StructType, pointer: Any, name: str) -> Any:
    """Load a field. Its words never change, so the compiler may load them when it likes and keep them."""
    kind, offset = next((kind, offset) for field, kind, offset in struct.fields if field == name)
    shape = context.get_value_type(kind).as_pointer()
    field = builder.load(_compiler_tools.pointer_add(builder, pointer, offset, return_type=shape))
    field.set_metadata("invariant.load", builder.module.add_metadata([]))
    return field


_compiler: Any = extending
_compiler_tools: Any = cgutils
_compiler.register_model(StructType)(_compiler.models.OpaqueModel)
_compiler.typeof_impl.register(Struct)(lambda value, _: value.kind)
_compiler.unbox(StructType)(_unbox)
_compiler.infer_getattr(type("Fields", (AttributeTemplate,), {"key": StructType, "generic_resolve": _type_of_field}))
_compiler.lower_getattr_generic(StructType)(_load)
