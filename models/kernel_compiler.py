"""How numba compiles kernels here: in fewer passes than its own, with named tuples of arrays as one pointer.

Most of what numba takes to compile a kernel is its own Python, for each function that the kernel calls, and not machine
code. Three things of it are left out:

- passes for what kernels do not use: closures, comprehensions, sums of whole arrays, functions put into others;
- of a function that only kernels call, its own machine code: it becomes part of the kernels, and is optimised with
  those alone;
- the search through dozens of templates, a function compiled for some of them, for every operator on numbers and arrays
  whose kinds have been met before.

It is a pipeline of passes as numba lets one define; the library that holds the code, and where operators are looked up,
are numba's own.
"""

from __future__ import annotations

from functools import cache
from typing import Any, cast

import numba
import numpy as np
from numba import extending
from numba.core import cgutils, codegen, compiler, compiler_machinery, targetconfig, typed_passes, types, untyped_passes
from numba.core.typing.templates import AttributeTemplate
from numba.np.numpy_support import from_dtype

from .kernel_struct import Struct, StructKind

_Compiler: Any = compiler.CompilerBase
_Lowering: Any = typed_passes.NativeLowering
_Library: Any = codegen.JITCodeLibrary
_Passes: Any = compiler_machinery.PassManager
_register: Any = compiler_machinery.register_pass
_make_function: Any = cast(Any, numba)._dynfunc.make_function
_Untyped: Any = untyped_passes
_Typed: Any = typed_passes


class PartCode(_Library):  # type: ignore[misc]
    """Code of a function and of all that it calls, as it was translated; there is no machine code of it."""

    def finalize(self) -> None:
        """Link what is called."""
        self._raise_if_finalized()
        for called in dict.fromkeys(self._linking_libraries):
            self._final_module.link_in(called._get_module_for_linking(), preserve=True)
        self._finalized = True


@_register(mutates_CFG=True, analysis_only=False)
class PartLowering(_Lowering):  # type: ignore[misc]
    """Translate a function to `PartCode`."""

    _name = "part_lowering"

    def run_pass(self, state: Any) -> bool:
        """See `Lowering`."""
        context = state.targetctx
        state.library = PartCode(context.codegen(), state.func_id.func_qualname)
        state.flags.no_compile = True
        super().run_pass(state)
        lowered, no_code = state.cr, 0
        called = _make_function(lowered.fndesc.lookup_module(), "part", "", no_code, lowered.env, (state.library,))
        context.insert_user_function(called, lowered.fndesc, [state.library])
        state.cr = lowered._replace(cfunc=called)
        return True


class KernelCompiler(_Compiler):  # type: ignore[misc]
    """The passes that a kernel needs, of those that numba has."""

    lowering: Any = _Lowering

    def define_pipelines(self) -> list[Any]:
        """The passes."""
        passes = _Passes("kernel")
        for kind in (
            _Untyped.TranslateByteCode,
            _Untyped.FixupArgs,
            _Untyped.IRProcessing,
            _Untyped.GenericRewrites,
            _Untyped.ReconstructSSA,
            _Typed.NopythonTypeInference,
            _Typed.PreLowerStripPhis,
            _Typed.IRLegalization,
            _Typed.AnnotateTypes,
            self.lowering,
            _Typed.NoPythonBackend,
        ):
            passes.add_pass(kind, kind.__name__)
        passes.finalize()
        return [passes]


class PartCompiler(KernelCompiler):
    """The same for a function that only kernels call."""

    lowering = PartLowering


# Signatures of operators, kept once they are found.

_Function: Any = types.functions.BaseFunction
_find: Any = _Function.get_call_type
_PLAIN: Any = (types.Number, types.Boolean, types.Array, types.UniTuple)
_signatures: dict[object, Any] = {}


def _known_signature(self: Any, context: Any, args: tuple[Any, ...], kws: dict[str, Any]) -> Any:
    """The signature of a function or operator for kinds of arguments, under the same options found once."""
    if kws or not all(isinstance(kind, _PLAIN) for kind in args):
        return _find(self, context, args, kws)
    flags: Any = targetconfig.ConfigStack.top_or_none()  # type: ignore[no-untyped-call]
    key = (self, args) if flags is None else (self, args, flags.nrt, flags.error_model)
    found = _signatures.get(key)
    if found is None:
        found = _signatures[key] = _find(self, context, args, kws)
    return found


_Function.get_call_type = _known_signature


# What numba has to know of a `Struct`: its type, and how its fields are loaded.


class StructType(types.Type):
    """The numba type of a `Struct`: its fields by name, each with its type and its place, in bytes."""

    def __init__(self, kind: StructKind) -> None:
        self.fields = {name: (_type_of(field), at) for name, field, at in kind.fields}
        super().__init__(name=f"{kind.label}_{kind.digest}")


@cache
def _type_of(kind: Any) -> types.Type:
    if isinstance(kind, StructKind):
        return StructType(kind)
    if isinstance(kind, tuple):
        dtype, dimensions = kind
        return types.Array(from_dtype(dtype), dimensions, "C")
    return {int: types.int64, np.float64: types.float64, np.float32: types.float32}[kind]


def _type_of_struct(value: Struct, _: object) -> types.Type:
    return _type_of(value.kind)


def _type_of_field(_: object, struct: StructType, name: str) -> types.Type | None:
    return struct.fields[name][0] if name in struct.fields else None


def _unbox(_: StructType, value: Any, c: Any) -> Any:
    """The pointer that stands for a `Struct` in a kernel."""
    address = c.pyapi.object_getattr_string(value, "address")
    pointer = c.pyapi.long_as_voidptr(address)
    c.pyapi.decref(address)
    return _numba.NativeValue(pointer)


def _load(context: Any, builder: Any, struct: StructType, pointer: Any, name: str) -> Any:
    """Load a field. Its words never change, so the compiler may load them when it likes and keep them."""
    kind, offset = struct.fields[name]
    shape = context.get_value_type(kind).as_pointer()
    field = builder.load(_code.pointer_add(builder, pointer, offset, return_type=shape))
    field.set_metadata("invariant.load", builder.module.add_metadata([]))
    return field


_numba: Any = extending
_code: Any = cgutils
_numba.register_model(StructType)(_numba.models.OpaqueModel)
_numba.unbox(StructType)(_unbox)
_numba.typeof_impl.register(Struct)(_type_of_struct)
_numba.infer_getattr(type("Fields", (AttributeTemplate,), {"key": StructType, "generic_resolve": _type_of_field}))
_numba.lower_getattr_generic(StructType)(_load)
