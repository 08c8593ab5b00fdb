"""Kernels kept on disk between runs, in files that cannot hurt: what is broken, foreign or out of date is not run.

Numba's own cache fails for ever on a file that is empty or cut short, runs one that is damaged, mixes up kernels where
two runs write at once, and refuses to start where nothing may be written.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import pickle
import tempfile
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
from numba.core import caching, serialize

from kerfwise.encoder.errors import Advice

_DIGEST_BYTES = 32
_caching, _serialize = cast(Any, caching), cast(Any, serialize)
F = TypeVar("F", bound=Callable[..., object])
_told: set[str] = set()


def kept(**options: Any) -> Callable[[F], F]:
    """A decorator: compile a function with numba's `options`, once for each machine and kind of arguments.

    Where nothing can be kept, it is compiled in each run anew, and that is said once.
    """

    def compiled(function: F) -> F:
        dispatcher: Any = numba.njit(**options)(function)
        dispatcher._cache = _cache_of(function)
        return cast(F, dispatcher)

    return compiled


def _cache_of(function: Any) -> Any:
    try:
        return Kept(function)
    except (OSError, RuntimeError):  # numba found no place
        _tell("compiled kernels cannot be kept here and are compiled anew each time; NUMBA_CACHE_DIR names a place")
        return _caching.NullCache()


def _tell(text: str) -> None:
    """Say something once."""
    if text not in _told:
        _told.add(text)
        warnings.warn(text, Advice, stacklevel=2)


class Files:
    """The kept kernels of one function: a file for each kind of arguments, with a sum of its content before it.

    In front stands what numba and source it was compiled by (32 bytes), then the sum of the rest (32 bytes).
    """

    def __init__(self, folder: str, name: str, stamp: object) -> None:
        self.folder, self.name = Path(folder), name
        self.made_by = hashlib.sha256(repr((numba.__version__, stamp)).encode()).digest()

    def load(self, key: object) -> Any:
        """What is kept for a key; None where nothing is, or nothing that may be run."""
        try:
            data = self.path(key).read_bytes()
        except OSError:
            return None
        made_by, total = data[:_DIGEST_BYTES], data[_DIGEST_BYTES : 2 * _DIGEST_BYTES]
        content = data[2 * _DIGEST_BYTES :]
        if len(total) == _DIGEST_BYTES and made_by != self.made_by:
            return None
        if hashlib.sha256(content).digest() != total:
            _tell("kept kernels are damaged, and are compiled anew")
            return None
        return pickle.loads(content)

    def save(self, key: object, kernel: object) -> None:
        """Keep a kernel, in place of what was kept for the key.

        Raises
        ------
        OSError
            If it cannot be written.
        """
        content = _serialize.dumps(kernel)
        handle, beside = tempfile.mkstemp(prefix=".", dir=self.folder)
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(self.made_by + hashlib.sha256(content).digest() + content)
            os.chmod(beside, 0o644)
            os.replace(beside, self.path(key))
        except BaseException:
            with contextlib.suppress(OSError):
                os.unlink(beside)
            raise

    def flush(self) -> None:
        """Forget all."""
        for path in self.folder.glob(f"{self.name}.*.kernel"):
            with contextlib.suppress(OSError):
                path.unlink()

    def path(self, key: object) -> Path:
        """The file for a key."""
        return self.folder / f"{self.name}.{hashlib.sha256(repr(key).encode()).hexdigest()[:16]}.kernel"


_NumbasOwn: Any = _caching.FunctionCache


class Kept(_NumbasOwn):  # type: ignore[misc]
    """Numba's cache of a function, over `Files`; what cannot be read or written is done without."""

    def __init__(self, function: Any) -> None:
        super().__init__(function)
        stamp = self._impl.locator.get_source_stamp()
        self._cache_file = Files(self._cache_path, self._impl.filename_base, stamp)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """The kernel kept for a signature, or None."""
        try:
            return super().load_overload(sig, target_context)
        except Exception:  # whatever numba and LLVM say of it, it can be compiled
            _tell("kept kernels cannot be read, and are compiled anew")
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep a kernel, where that can be done."""
        try:
            super().save_overload(sig, data)
        except Exception as error:
            why = getattr(error, "strerror", None) or type(error).__name__
            _tell(f"compiled kernels cannot be kept ({why}) and are compiled anew each time")
            self.disable()
