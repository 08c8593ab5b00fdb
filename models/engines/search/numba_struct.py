"""What numba has to know of a `Struct`: its type, and how its fields are loaded."""

from __future__ import annotations

import hashlib
from functools import cache
from typing import Any

from numba import extending
from numba.core import cgutils, types
from numba.core.typing.templates import AttributeTemplate
from numba.np.numpy_support import from_dtype

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
