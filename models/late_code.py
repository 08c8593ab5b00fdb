"""Code whose machine code is made late: functions that only kernels call become code of those, and none of their own.

Numba optimises every function by itself and makes machine code of it, and does all of that again within each function
that calls it. Here a function is kept as it was translated until somebody asks for its machine code, which is asked for
kernels that Python calls alone: what these call is optimised with them, once.

All this stands on numba's internals: `kernel_code` says for which versions, and imports this for them alone.
"""

from __future__ import annotations

from typing import Any

from numba.core import codegen

_NumbasOwn: Any = codegen.JITCodeLibrary


class Code(_NumbasOwn):  # type: ignore[misc]
    """Numba's code of one function and of all that it calls; machine code is made when it is first asked for."""

    _made = False

    def finalize(self) -> None:
        """Link what is called."""
        self._raise_if_finalized()
        for called in dict.fromkeys(self._linking_libraries):
            self._reload_init.update(called._reload_init)
            self._final_module.link_in(called._get_module_for_linking(), preserve=True)
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> Any:
        """Where the machine code of a function begins; 0 where this has no such function."""
        self._ensure_finalized()
        if not self._made and self._has(name):
            self._optimize_final_module()
            self._final_module.verify()
            self._finalize_final_module()
        return super().get_pointer_to_function(name)

    def _finalize_final_module(self) -> None:
        self._made = True
        super()._finalize_final_module()

    def _has(self, name: str) -> bool:
        try:
            return not self._final_module.get_function(name).is_declaration
        except NameError:
            return False

    @property
    def codegen(self) -> Any:
        """Who makes machine code; where none was made, nothing has to be told of it."""
        return super().codegen if self._made else _Nobody()


class _Nobody:
    def set_env(self, *_: object) -> None:
        """A function without machine code has no place for its surroundings.

        So it cannot print, nor raise an error with values that it computes: numba says that an environment is missing.
        """
