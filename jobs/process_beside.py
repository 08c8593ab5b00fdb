"""A process beside this one: it sets out early, is told of more later, and answers."""

from __future__ import annotations

import contextlib
import pickle
import signal
import sys
import threading
import warnings
from collections.abc import Callable, Iterator
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

if TYPE_CHECKING:
    from multiprocessing.connection import Connection
    from multiprocessing.process import BaseProcess

Hear = Callable[[], Any]
"""The next thing that the process is told."""


class Beside:
    """A process that begins and ends with the context. Whatever goes wrong in it, it has no answer.

    Where Linux runs it and this process has one thread, it is forked, and has all that this one has loaded; else it
    sets out from nothing.

    Parameters
    ----------
    work
        What it does, a function of a module: it is given `Hear` and what is `given`, and yields its answers.
    given
        What it is handed when it sets out.
    """

    def __init__(self, work: Callable[..., Iterator[object]], *given: object) -> None:
        self._work, self._given = work, given
        self.pays = True
        """Whether the process is begun."""
        self.process: BaseProcess | None = None
        self._way: Connection | None = None
        self._sent: threading.Thread | None = None

    def tell(self, value: object) -> bool:
        """Hand something on as soon as the process takes it, after what was handed on before; whether that can be."""
        if self._way is None or not (data := _pickled(value)):
            return False

        def send(way: Connection, before: threading.Thread | None) -> None:
            if before is not None:
                before.join()
            with contextlib.suppress(OSError):
                way.send_bytes(data)

        self._sent = threading.Thread(target=send, args=(self._way, self._sent), daemon=True)
        self._sent.start()
        return True

    def answer(self) -> Any:
        """What it answers, as soon as that is there; None where there is no answer."""
        if self._way is None or self._sent is None:
            return None
        self._sent.join()
        try:
            return self._way.recv()
        except (EOFError, OSError):
            return None

    def __enter__(self) -> Self:
        """Have the process set out, where that pays."""
        if not self.pays:
            return self
        from multiprocessing import get_context

        from .process_pool import start_quietly

        forked = sys.platform == "linux" and threading.active_count() == 1
        context = get_context("fork" if forked else "spawn")
        with contextlib.suppress(OSError), warnings.catch_warnings():  # no process can be started: there is no answer
            warnings.simplefilter("ignore", DeprecationWarning)  # of threads that libraries keep for their own loops
            way, there = context.Pipe()
            given = self._given if forked else None
            process = context.Process(target=_serve, args=(there, self._work, given), daemon=True)  # type: ignore[attr-defined]
            start_quietly(process)
            self.process = process
            there.close()
            self._way = way
            if not forked and not self.tell(self._given):
                self.__exit__(None, None, None)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """End the process, whatever it is at."""
        if self.process is not None and self.process.pid is not None:
            from .process_pool import ENDED_S

            self.process.terminate()
            self.process.join(ENDED_S)
        if self._way is not None:
            self._way.close()
            self._way = None


def _pickled(value: object) -> bytes:
    """What a process is handed on; empty where something in it cannot be."""
    try:
        return pickle.dumps(value)
    except (pickle.PicklingError, AttributeError, TypeError, RecursionError):
        return b""


def _serve(way: Connection, work: Callable[..., Iterator[object]], given: tuple[object, ...] | None) -> None:
    """What the process does; where it cannot, it says nothing."""
    from .process_pool import end_with_parent, show_warnings_as_notes

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches every process; only the first one answers
    threading.Thread(target=end_with_parent, daemon=True).start()
    show_warnings_as_notes()
    with contextlib.suppress(Exception):
        for answer in work(way.recv, *(way.recv() if given is None else given)):
            way.send(answer)
