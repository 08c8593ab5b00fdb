"""How kernels of the search are compiled, what they take, and their random numbers."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from functools import cache
from itertools import accumulate
from typing import Any, TypeVar, cast

import numpy as np
from numba import extending
from numba.core import cgutils, types
from numba.core.typing.templates import AttributeTemplate
from numba.np.numpy_support import from_dtype
from numpy.typing import NDArray

from kerfwise.arrays import Ints
from kerfwise.models.jit import compiling, inner, jit

# How kernels are compiled: to machine code that is kept on disk between runs and runs without the GIL.

F = TypeVar("F", bound=Callable[..., object])


# Kernels hold no arrays of their own, so that none need be counted (`_nrt`); they are called from kernels alone or
# from Python alone.
_OPTIONS: dict[str, Any] = {"nogil": True, "error_model": "numpy", "_nrt": False}


def compiled(function: F) -> F:
    """Compile a function of numbers, arrays and structs that other compiled functions call."""
    return inner(**_OPTIONS)(function)


def entry(function: F) -> F:
    """Compile a function that Python calls, and keep the machine code, with that of all it calls, on disk."""
    return jit(**_OPTIONS)(function)


# Named tuples of arrays as what a compiled kernel takes: a pointer to where its arrays are.
#
# Numba hands a named tuple on by copying, and counting the references to, each of its arrays at every call: half a
# microsecond for the arrays of a search, dozens of times an iteration. Here it is one pointer to a block of words
# that stays as it is, from which the compiler takes what it needs when it needs it: ten to twenty times as fast.

WORD = 8  # bytes


T = TypeVar("T")


def kernel_argument(fields: T) -> T:
    """A named tuple as kernels take it (see `Struct`)."""
    return cast(T, Struct(fields))


class Struct:
    """A named tuple of arrays (C order), whole numbers, floats and further named tuples; the arrays are not copied.

    Kernels read its fields by name and write to its arrays. `address` is where its words begin.
    """

    def __init__(self, fields: Any) -> None:
        self.fields = fields
        with compiling():
            from . import jit_tools as numba_struct

            take(Struct)

        self._types: Any = numba_struct
        words: list[int] = []
        kinds: list[tuple[str, Any, int]] = []
        self._inner: list[Struct] = []
        for name, value in zip(fields._fields, fields, strict=True):
            kind, more = self._words(value)
            kinds.append((name, kind, len(words) * WORD))
            words += more
        self._block = np.array(words, dtype=np.int64)
        self.kind: Any = StructType(type(fields).__name__, tuple(kinds))
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


# Lists of lists as two flat arrays: those of i lie at `flat[first[i]:first[i + 1]]`.


def ints(values: Sequence[int]) -> Ints:
    """An array of whole numbers, empty ones included."""
    return np.array(values, dtype=np.int64)


def flatten(rows: Sequence[Sequence[int]]) -> tuple[Ints, Ints]:
    """`first` and `flat`.

    Examples
    --------
    >>> [a.tolist() for a in flatten([[5, 6], [], [7]])]
    [[0, 2, 2, 3], [5, 6, 7]]
    """
    return ints([0, *accumulate(len(row) for row in rows)]), ints([x for row in rows for x in row])


# Random numbers whose state is an array of our own, so that a search can stop and go on the same way.


@compiled
def draw_number(random: NDArray[np.uint64]) -> np.uint64:
    """The next 64 random bits (xorshift64*, Vigna 2016)."""
    x = random[0]
    x ^= x >> np.uint64(12)
    x ^= x << np.uint64(25)
    x ^= x >> np.uint64(27)
    random[0] = x
    return np.uint64(x * np.uint64(2685821657736338717))


@compiled
def below(random: NDArray[np.uint64], bound: int) -> int:
    """A random whole number in 0 … bound - 1."""
    return int(np.int64((draw_number(random) >> np.uint64(33)) % np.uint64(bound)))


@compiled
def draw_share(random: NDArray[np.uint64]) -> float:
    """A random number in [0, 1)."""
    return np.float64(draw_number(random) >> np.uint64(11)) * (1.0 / 9007199254740992.0)


@compiled
def high(bits: np.uint64, bound: int) -> int:
    """A whole number in 0 … bound - 1 by the upper half of random bits; what follows takes other parts of them."""
    return int(np.int64((bits >> np.uint64(32)) * np.uint64(bound) >> np.uint64(32)))


@compiled
def low(bits: np.uint64, bound: int) -> int:
    """A whole number in 0 … bound - 1, at most 1 << 16, by the lowest sixteen of random bits."""
    return int(np.int64((bits & np.uint64(0xFFFF)) * np.uint64(bound) >> np.uint64(16)))


@compiled
def rather_low(bits: np.uint64, bound: int) -> int:
    """A whole number in 0 … bound - 1, at most 1 << 16, rather a small one, by the lowest sixteen of random bits."""
    by = bits & np.uint64(0xFFFF)
    return int(np.int64((by * by >> np.uint64(16)) * np.uint64(bound) >> np.uint64(16)))


@compiled
def short(bits: np.uint64) -> int:
    """1 … 16, rather small, by the lowest sixteen of random bits."""
    by = bits & np.uint64(0xFFFF)
    return int(np.int64(by * by >> np.uint64(28))) + 1


@compiled
def is_odd(bits: np.uint64) -> bool:
    """Heads or tails, by the seventeenth bit."""
    return bool(bits & np.uint64(0x10000))


@compiled
def chunk(bits: np.uint64) -> int:
    """0 … 4095, by the bits above the seventeenth."""
    return int(np.int64((bits >> np.uint64(17)) & np.uint64(0xFFF)))


# What numba has to know of a `Struct`: its type, and how its fields are loaded.

WHOLE, FLOAT = types.int64, types.float64


def array(value: Any) -> types.Type:
    """The numba type of an array in C order."""
    return types.Array(from_dtype(value.dtype), value.ndim, "C")


class StructType(types.Type):
    """The numba type of a `Struct`; `fields` are names, types and offsets in bytes."""

    def __init__(self, label: str, fields: tuple[tuple[str, types.Type, int], ...]) -> None:
        self.fields = fields
        digest = hashlib.sha256(repr(fields).encode()).hexdigest()[:8]
        super().__init__(name=f"{label}_{digest}")


@cache
def take(kind: type) -> None:
    """Have numba take objects of a class, a `Struct`, for what their `kind` says."""
    _compiler.typeof_impl.register(kind)(lambda value, _: value.kind)


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
_compiler.unbox(StructType)(_unbox)
_compiler.infer_getattr(type("Fields", (AttributeTemplate,), {"key": StructType, "generic_resolve": _type_of_field}))
_compiler.lower_getattr_generic(StructType)(_load)
