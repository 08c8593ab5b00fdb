"""Compiled kernels kept on disk between runs, in files that cannot hurt: what is broken, foreign or old is not run.

Numba's own cache fails for ever on a file that is empty or cut short, runs one that is damaged, mixes up kernels where
two runs write at once, and refuses to start where nothing may be written. Only who compiles or loads a kernel imports
this, and numba with it.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import pickle
import sys
import time
import warnings
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager
from functools import cache, cached_property
from pathlib import Path
from typing import Any, cast

import numba
import numpy as np
from numba import extending
from numba.core import caching, runtime, serialize, types

from kerfwise.encoder.errors import Advice
from kerfwise.encoder.files import DamagedFile, only_ours, read_sealed, write_sealed

from .kernel_compiler import KernelCompiler, PartCompiler


def _without_blas() -> None:
    """Have numba load what compiling takes, but not scipy, where it looks for products of matrices: that takes as long.

    No kernel here has such; one of somebody else finds them when it is compiled.
    """
    name = "scipy.linalg.cython_blas"
    if name in sys.modules or "numba.np.arraymath" in sys.modules:
        return
    sys.modules[name] = cast(Any, None)  # as Python says that there is none
    try:
        from numba.np import arraymath
    finally:
        del sys.modules[name]
    arraymath._HAVE_BLAS = True


_caching, _serialize, _numba = cast(Any, caching), cast(Any, serialize), cast(Any, extending)
_runtime = cast(Any, runtime)
_told: set[str] = set()
_made: list[Any] = []
"""What Python calls, of this process."""


def dispatcher_of(
    function: Callable[..., object],
    options: Mapping[str, Any],
    keep: bool,
    kernel: type,
    compiling: Callable[[], AbstractContextManager[None]],
    note_compiled: Callable[[], None],
) -> Any:
    """What numba makes of a function: it compiles for each kind of arguments, or loads what is kept for it.

    Where nothing can be kept, it is compiled in each run anew, and that is said once. It is done within `compiling`,
    and `note_compiled` is called where something was compiled. Functions that it calls may be of the class `kernel`.
    """
    _take(kernel)
    dispatcher: Any = numba.njit(pipeline_class=KernelCompiler if keep else PartCompiler, **options)(function)
    if keep:
        dispatcher._cache = _cache_of(function)
        _made.append(dispatcher)
    make = dispatcher._compile_for_args

    def make_off_the_clock(*given: Any, **named: Any) -> Any:
        with compiling():
            not_kept = sum(dispatcher.stats.cache_misses.values())
            try:
                return make(*given, **named)
            finally:
                if sum(dispatcher.stats.cache_misses.values()) > not_kept:
                    note_compiled()

    dispatcher._compile_for_args = make_off_the_clock
    return dispatcher


@cache
def _take(kernel: type) -> None:
    """Have numba take objects of a class for the dispatcher that they have, where a kernel calls them."""
    _numba.typeof_impl.register(kernel)(lambda value, _: cast(Any, types).Dispatcher(value.dispatcher))


def _cache_of(function: Any) -> Any:
    try:
        kept = Kept(function)
        if only_ours(kept._cache_path):
            return kept
        _tell(
            f"kernels kept in {kept._cache_path} are not run, for others may write there; NUMBA_CACHE_DIR names a "
            "place of your own"
        )
    except (OSError, RuntimeError):  # numba found no place
        _tell("compiled kernels cannot be kept here and are compiled anew each time; NUMBA_CACHE_DIR names a place")
    _without_blas()
    return _caching.NullCache()


def _tell(text: str) -> None:
    """Say something once."""
    if text not in _told:
        _told.add(text)
        warnings.warn(text, Advice, stacklevel=2)


# What other processes compile, and what is kept where.

_beside: dict[object, Callable[[], bool]] = {}
"""Functions that another process compiles now, each with whether it still does."""
LOOK_S = 0.05
"""Between two looks at whether it has."""


def compiled_beside(function: object, runs: Callable[[], bool]) -> None:
    """Wait for what another process compiles of a function, as long as that `runs`, before it is compiled here."""
    _beside[function] = runs


def is_kept(dispatcher: Any) -> bool:
    """Whether a kernel of today's source is kept, for whatever kinds of arguments; so, too, where none can be."""
    cache = dispatcher._cache
    return not isinstance(cache, Kept) or cache._cache_file.any_kept()


def compiled_and_kept() -> tuple[int, str]:
    """How many kernels this process has compiled, and the folder of folders that they are kept in, "" for none."""
    folders = {str(one._cache._cache_file.folder) for one in _made if isinstance(one._cache, Kept)}
    compiled = sum(sum(one.stats.cache_misses.values()) for one in _made)
    return compiled, os.path.commonpath(folders) if folders else ""


class Files:
    """The kept kernels of one function: a sealed file for each kind of arguments, by numba and source.

    `stamp` tells the source; it is asked when the first kernel is looked for, once all that it calls is defined.
    """

    def __init__(self, folder: str, name: str, stamp: Callable[[], object]) -> None:
        self.folder, self.name, self._stamp = Path(folder), name, stamp

    @cached_property
    def made_by(self) -> bytes:
        """Which numba and which source a kernel has to be compiled by."""
        return hashlib.sha256(repr((numba.__version__, self._stamp())).encode()).digest()

    def any_kept(self) -> bool:
        """Whether there is a file that today's numba and source have made."""
        for path in self.folder.glob(f"{self.name}.*.kernel"):
            with contextlib.suppress(DamagedFile):
                if read_sealed(path, self.made_by) is not None:
                    return True
        return False

    def load(self, key: object) -> Any:
        """What is kept for a key; None where nothing is, or nothing that may be run."""
        try:
            content = read_sealed(self.path(key), self.made_by)
        except DamagedFile:
            _tell("kept kernels are damaged, and are compiled anew")
            return None
        return None if content is None else pickle.loads(content)

    def save(self, key: object, kernel: object) -> None:
        """Keep a kernel, in place of what was kept for the key.

        Raises OSError if it cannot be written.
        """
        write_sealed(self.path(key), self.made_by, _serialize.dumps(kernel))

    def flush(self) -> None:
        """Forget all."""
        for path in self.folder.glob(f"{self.name}.*.kernel"):
            with contextlib.suppress(OSError):
                path.unlink()

    def path(self, key: object) -> Path:
        """The file for a key."""
        return self.folder / f"{self.name}.{hashlib.sha256(repr(key).encode()).hexdigest()[:16]}.kernel"


def source_of(function: Any) -> tuple[list[str], list[str]]:
    """All that a kernel is compiled from: digests of the files that it and the kernels it calls stand in, and numbers.

    Numba itself looks at the kernel's own file alone, and runs on with what it has kept where another has changed.
    """
    files: set[str] = set()
    numbers: set[str] = set()
    seen, waiting = {function}, [function]
    while waiting:
        one = waiting.pop()
        files.add(one.__code__.co_filename)
        for name in one.__code__.co_names:
            value = one.__globals__.get(name)
            called = getattr(value, "py_func", None)
            if called is not None and called not in seen:
                seen.add(called)
                waiting.append(called)
            elif isinstance(value, int | float | complex | tuple | np.generic):
                numbers.add(f"{name} = {value!r}")
    return sorted(map(_digest, files)), sorted(numbers)


@cache
def _digest(file: str) -> str:
    return hashlib.sha256(Path(file).read_bytes()).hexdigest()


_NumbasOwn: Any = _caching.FunctionCache


class Kept(_NumbasOwn):  # type: ignore[misc]
    """Numba's cache of a function, over `Files`; what cannot be read or written is done without."""

    def __init__(self, function: Any) -> None:
        super().__init__(function)
        self._cache_file = Files(self._cache_path, self._impl.filename_base, lambda: source_of(function))

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """The kernel kept for a signature, or None.

        Numba's own would first make ready what compiling takes, which is 60 modules and four fifths of the time. Arrays
        that kernels make and pass on are counted by numba's runtime: without it they crash.
        """
        try:
            _runtime.rtsys.initialize(target_context)
            found = self._load_overload(sig, target_context)
            while found is None and self._is_made_beside():
                time.sleep(LOOK_S)
                found = self._load_overload(sig, target_context)
            if found is not None:
                return found
        except Exception:  # whatever numba and LLVM say of it, it can be compiled
            _tell("kept kernels cannot be read, and are compiled anew")
        _without_blas()
        return None

    def _is_made_beside(self) -> bool:
        """Whether another process may yet keep what is looked for; one last look is due when that has ended."""
        runs = _beside.get(self._py_func)
        if runs is not None and not runs():
            del _beside[self._py_func]
        return runs is not None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep a kernel, where that can be done."""
        try:
            super().save_overload(sig, data)
        except Exception as error:
            why = getattr(error, "strerror", None) or type(error).__name__
            _tell(f"compiled kernels cannot be kept ({why}) and are compiled anew each time")
            self.disable()
