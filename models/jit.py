"""Kernels: functions that numba compiles once they have much to do, and that run as plain Python where it is little.

To compile one takes seconds, once for each machine; to load numba and what is kept takes most of a second in each run.
So neither is done before a kernel needs it, and a run may first take some steps in plain Python: a small nest needs no
more. Some kernels have a twin that does whole arrays at once in numpy, which bears nests a good deal larger. All ways
compute the same. No engine's clock runs while something is compiled or loaded; that of a command's limit runs while
something is loaded.
"""

from __future__ import annotations

import gc
import os
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import cached_property, update_wrapper
from typing import Any, TypeVar, cast

from .kernel_struct import as_struct

F = TypeVar("F", bound=Callable[..., object])

PLAIN_STEPS = 400_000
"""Steps that a process takes in plain Python for one kernel, before that is compiled or loaded: about 0.4 s, as loading
takes."""
FEW_STEPS = 500
"""Steps that take less in plain Python than by arrays."""
ARRAY_STEPS = 4e8
"""Steps that a process takes by whole arrays for one kernel: 1 to 3 s, less than compiling takes."""

_lock = threading.RLock()


KERNEL: dict[str, Any] = {"nogil": True, "error_model": "numpy", "_nrt": False}
"""How kernels are compiled that make no arrays, so that none need be counted, and run without the GIL."""


class _OfThread(threading.local):
    plain = 0
    """Plain kernels that are running, one within the other."""


class _OfProcess:
    plain_steps: float = PLAIN_STEPS
    made = False
    """Whether some kernel was compiled or loaded, and numba with it."""
    making = 0
    """Threads that compile or load."""
    collecting = True
    """Whether Python looked for circles of objects before that."""
    compiled = False
    """Whether one of those has compiled something, not only loaded it."""
    since_s = made_s = compiled_s = 0.0


_thread, _process = _OfThread(), _OfProcess()


class Kernel:
    """A function that numba can compile, with numba's `options`; `keep` it on disk once that is done.

    It is compiled when it is first called, for each kind of arguments, unless the caller is itself a kernel that runs
    as plain Python (see `suited`).
    """

    def __init__(self, function: Callable[..., Any], options: Mapping[str, Any], keep: bool) -> None:
        update_wrapper(self, function)
        self.py_func, self._options, self._keep = function, options, keep
        self.plain_steps = self.array_steps = 0.0

    def __call__(self, *given: Any) -> Any:
        return self.py_func(*given) if _thread.plain else self.dispatcher(*map(as_struct, given))

    def plainly(self, *given: Any) -> Any:
        """The same as plain Python, with all that it calls."""
        _thread.plain += 1
        try:
            return self.py_func(*given)
        finally:
            _thread.plain -= 1

    @property
    def made(self) -> bool:
        """Whether it was compiled or loaded in this process."""
        return "dispatcher" in self.__dict__

    @cached_property
    def dispatcher(self) -> Any:
        """What numba makes of it."""
        with compiling():
            from .numba_cache import dispatcher_of

            _process.made = True
            return dispatcher_of(self.py_func, self._options, self._keep, Kernel, compiling, note_compiled)


def jit(**options: Any) -> Callable[[F], F]:
    """A decorator: a function that numba compiles with its `options`, once for each machine and kind of arguments."""

    def made(function: F) -> F:
        return cast(F, Kernel(function, {**options, "no_cfunc_wrapper": True}, keep=True))

    return made


def inner(**options: Any) -> Callable[[F], F]:
    """A decorator for a function that only kernels call: it is kept with those, and Python cannot call it."""

    def made(function: F) -> F:
        alone = {"no_cfunc_wrapper": True, "no_cpython_wrapper": True}
        return cast(F, Kernel(function, {**options, **alone}, keep=False))

    return made


def suited(kernel: F, steps: float, by_arrays: F | None = None, most: float = ARRAY_STEPS) -> F:
    """The kernel as it is best run to take about so many steps: compiled, or as plain Python if the steps are few.

    A step is a turn of an inner loop. All plain runs of a kernel together take no more than `PLAIN_STEPS`. `by_arrays`
    computes the same in numpy: it takes all but few steps, up to `most`, as long as nothing is compiled or loaded, as
    then whatever is kept of the others costs little.
    """
    known = cast(Kernel, kernel)
    with _lock:
        if known.made:
            return kernel
        by_arrays = None if _process.made or known.array_steps + steps > most else by_arrays
        few = by_arrays is None or steps <= FEW_STEPS
        if few and known.plain_steps + steps <= _process.plain_steps:
            known.plain_steps += steps
            return cast(F, known.plainly)
        if by_arrays is None or not _process.plain_steps:
            return kernel
        known.array_steps += steps
    return by_arrays


def plain(kernel: F) -> F:
    """A function that kernels call, as plain Python: for a few calls."""
    return cast(F, cast(Kernel, kernel).plainly)


def take_plainly(steps: float) -> None:
    """Take so many steps of a kernel in plain Python from now on; with 0 whatever runs is compiled, by arrays none."""
    _process.plain_steps = steps


@contextmanager
def compiling() -> Iterator[None]:
    """What is done here is done once for each machine or process: `running_s` stands still.

    Compilers make objects by the million, and hardly any circles: to look for those takes a fifth as long again.
    """
    with _lock:
        _process.making += 1
        if _process.making == 1:
            _process.since_s = time.monotonic()
            _process.collecting = gc.isenabled()
            gc.disable()
    try:
        yield
    finally:
        with _lock:
            _process.making -= 1
            if not _process.making:
                if _process.collecting:
                    gc.enable()
                took_s = time.monotonic() - _process.since_s
                _process.made_s += took_s
                _process.compiled_s += took_s if _process.compiled else 0.0
                _process.compiled = False


def note_compiled() -> None:
    """Say, within `compiling`, that something was compiled: it was not kept from an earlier run."""
    with _lock:
        _process.compiled = True


def made_s() -> float:
    """Seconds by the clock in which kernels were compiled or loaded so far."""
    with _lock:
        return _process.made_s + (time.monotonic() - _process.since_s if _process.making else 0.0)


def compiled_s() -> float:
    """Seconds by the clock in which kernels were compiled so far, loading left out."""
    with _lock:
        return _process.compiled_s


def running_s() -> float:
    """A clock, s, for limits: it stands still while a kernel is compiled or loaded."""
    with _lock:
        return _now_or_since_s() - _process.made_s


def counted_s() -> float:
    """A clock, s, for limits of whole commands: each run loads kernels, so it stands still only where one is compiled.

    Until a kernel is there it is not known which of the two it was: so long it stands still, too.
    """
    with _lock:
        return _now_or_since_s() - _process.compiled_s


def _now_or_since_s() -> float:
    """Now, by the clock; where a kernel is compiled or loaded, when that began."""
    return _process.since_s if _process.making else time.monotonic()


def cores() -> int:
    """How many threads share the work of a kernel: one for each core, or as many as NUMBA_NUM_THREADS says."""
    if text := os.environ.get("NUMBA_NUM_THREADS", ""):
        return max(1, int(text)) if text.isdecimal() else 1
    return len(machine_cores())


def machine_cores() -> list[int]:
    """The numbers of the cores that this process may use; at least one."""
    if hasattr(os, "sched_getaffinity"):
        return sorted(os.sched_getaffinity(0)) or [0]
    return list(range(os.cpu_count() or 1))
