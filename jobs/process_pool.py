"""Work side by side in processes of their own: one that dies takes only what it was doing with it."""

from __future__ import annotations

import contextlib
import os
import pickle
import signal
import sys
import threading
import traceback
import warnings
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from multiprocessing import get_context, parent_process
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from multiprocessing.process import BaseProcess
from types import TracebackType
from typing import Generic, Self, TypeVar

from kerfwise.encoder.errors import Advice
from kerfwise.encoder.escape import escape_text
from kerfwise.models.jit import machine_cores

Piece = TypeVar("Piece")
Made = TypeVar("Made")
Work = Callable[[Piece], Made]
Began = Callable[[Piece], None]
"""Called with a piece of work as soon as a process does it."""

ENDED_S = 5.0
"""How long a process that was asked to end is waited for."""


class Died(Exception):
    """A process ended in the middle of its work: it was killed, memory ran out, or a library has crashed."""


@dataclass(slots=True)
class _Worker(Generic[Piece]):
    """A process, the way to it, and the piece of work that it has."""

    process: SpawnProcess
    way: Connection
    at: list[Piece] = field(default_factory=list)


class Workers(Generic[Piece, Made]):
    """So many processes, each with its share of the cores; what they have loaded serves piece after piece.

    Threads of all together are no more than cores: each process gets `cores // jobs` of them, to itself where
    the system lets cores be given. More jobs than cores are not begun.

    Examples
    --------
    >>> with Workers(abs, jobs=1) as workers:
    ...     sorted(workers.run([-3, 2]))
    [(-3, 3), (2, 2)]
    """

    def __init__(self, work: Work[Piece, Made], jobs: int) -> None:
        self._work = work
        self._cores = machine_cores()
        self.jobs = max(1, min(jobs, len(self._cores)))
        self._workers: list[_Worker[Piece]] = []

    def run(
        self, pieces: Iterable[Piece], began: Began[Piece] = lambda piece: None
    ) -> Iterator[tuple[Piece, Made | Exception]]:
        """Each piece with what was made of it, as soon as it is finished; with the exception, where one was raised."""
        left = iter(pieces)
        while True:
            self._begin(left, began)
            busy = {worker.way: worker for worker in self._workers if worker.at}
            if not busy:
                return
            for way in wait(list(busy)):
                assert isinstance(way, Connection)
                worker = busy[way]
                piece, answer = worker.at[0], self._answer(worker)
                worker.at.clear()
                yield piece, answer

    def _begin(self, left: Iterator[Piece], began: Began[Piece]) -> None:
        """Give work to whoever has none; a process is started when there is work for it."""
        for number in range(self.jobs):
            if number < len(self._workers) and self._workers[number].at:
                continue
            for piece in left:
                if number == len(self._workers):
                    self._workers.append(self._started(number))
                self._workers[number].at.append(piece)
                self._send(number, piece)
                began(piece)
                break

    def _send(self, number: int, piece: Piece) -> None:
        try:
            self._workers[number].way.send(piece)
        except OSError:  # it has died since its last piece
            self._workers[number] = self._started(number)
            self._workers[number].at.append(piece)
            self._workers[number].way.send(piece)

    def _answer(self, worker: _Worker[Piece]) -> Made | Exception:
        try:
            answer: Made | Exception = worker.way.recv()
            return answer
        except (EOFError, OSError):
            worker.process.join(ENDED_S)
            code = worker.process.exitcode
            self._workers[self._workers.index(worker)] = self._started(self._workers.index(worker))
            how = f"signal {-code}" if code is not None and code < 0 else f"exit code {code}"
            return Died(f"the process that worked on it died ({how}); where memory ran out, fewer jobs help")

    def _started(self, number: int) -> _Worker[Piece]:
        context = get_context("spawn")
        here, there = context.Pipe()
        threads = max(1, len(self._cores) // self.jobs)
        cores = self._cores[number * threads : (number + 1) * threads]
        process = context.Process(target=_serve, args=(there, self._work, cores), daemon=True)
        start_quietly(process)
        there.close()
        return _Worker(process, here)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """End the processes; what they are doing is lost."""
        for worker in self._workers:
            worker.process.terminate()
        for worker in self._workers:
            worker.process.join(ENDED_S)
            worker.way.close()
        self._workers.clear()


def run_in_process(
    work: Work[Piece, Made],
) -> Callable[[Iterable[Piece], Began[Piece]], Iterator[tuple[Piece, Made | Exception]]]:
    """The same as `Workers.run` in this process, a piece after the other."""

    def run(pieces: Iterable[Piece], began: Began[Piece]) -> Iterator[tuple[Piece, Made | Exception]]:
        for piece in pieces:
            began(piece)
            try:
                answer: Made | Exception = work(piece)
            except Exception as error:
                answer = error
            yield piece, answer

    return run


def _serve(way: Connection, work: Work[Piece, Made], cores: list[int]) -> None:
    """What a process does: its share of the cores, then piece after piece, until nobody is there who gives any."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches every process; only the first one answers
    threading.Thread(target=end_with_parent, daemon=True).start()
    keep_to(cores)
    show_warnings_as_notes()
    with contextlib.suppress(EOFError, OSError):
        while True:
            piece: Piece = way.recv()
            answer: Made | Exception
            try:
                answer = work(piece)
            except KeyboardInterrupt:
                return
            except Exception as error:
                answer = _sendable(error)
            way.send(answer)


def show_warnings_as_notes() -> None:
    """Have this process write warnings as the command line does."""
    warnings.showwarning = _noted
    warnings.simplefilter("always", Advice)


def _noted(message: Warning | str, category: type[Warning], *where: object, **more: object) -> None:
    """A warning as a note, as the command line writes it, without the line of Python that it came from."""
    kind = "" if issubclass(category, Advice) else f"{category.__name__}: "
    with contextlib.suppress(OSError, ValueError):
        sys.stderr.write(f"note: {kind}{escape_text(str(message))}\n")
        sys.stderr.flush()


def _sendable(error: Exception) -> Exception:
    """The exception with its traceback as a note, if it can be sent to another process; else one that says the same."""
    error.add_note("".join(traceback.format_exception(error)))
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:  # of exceptions of libraries nothing is sure
        plain = RuntimeError(f"{type(error).__name__}: {error}")
        plain.add_note(error.__notes__[-1])
        return plain
    return error


def keep_to(cores: list[int]) -> None:
    """Have this process use these cores and no others, and as many threads."""
    os.environ["NUMBA_NUM_THREADS"] = str(len(cores))
    if hasattr(os, "sched_setaffinity"):
        with contextlib.suppress(OSError):
            os.sched_setaffinity(0, cores)


def start_quietly(process: BaseProcess) -> None:
    """Start a process that Ctrl-C does not reach: while it sets out it has no other way to leave that to this one.

    Windows cannot hold it back; there the process has to leave it alone itself.
    """
    if not hasattr(signal, "pthread_sigmask"):
        process.start()
        return
    if isinstance(process, SpawnProcess):
        from multiprocessing.resource_tracker import ensure_running

        ensure_running()  # it would let signals through again where it is started with the process
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        process.start()
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def end_with_parent() -> None:
    """End where the process that gives the work was killed: nobody is left who would want the answer."""
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
