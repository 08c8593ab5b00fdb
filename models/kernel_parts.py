"""Functions that only kernels call: their code becomes part of the kernels, and is optimised with those alone.

Numba optimises every function by itself, makes machine code of it, and does both again within each function that calls
it, although nobody calls the first. A kernel of the search calls eighty functions: without this it takes twice as long
to compile. It is a pipeline of passes as numba lets one define; the library that holds the code is one of numba's own.
"""

from __future__ import annotations

from typing import Any

from numba import _dynfunc  # type: ignore[attr-defined]
from numba.core import codegen, compiler, compiler_machinery, typed_passes

_Compiler: Any = compiler.CompilerBase
_Lowering: Any = typed_passes.NativeLowering
_Library: Any = codegen.JITCodeLibrary
_Passes: Any = compiler_machinery.PassManager
_register: Any = compiler_machinery.register_pass
_make_function: Any = _dynfunc.make_function


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


class PartCompiler(_Compiler):  # type: ignore[misc]
    """Numba's passes, with `PartLowering` in the place of its lowering."""

    def define_pipelines(self) -> list[Any]:
        """The passes."""
        usual: Any = compiler.DefaultPassBuilder.define_nopython_pipeline(self.state)  # type: ignore[no-untyped-call]
        passes = _Passes("part of a kernel")
        for kind, name in usual.passes:
            passes.add_pass(PartLowering if kind is _Lowering else kind, name)
        passes.finalize()
        return [passes]
