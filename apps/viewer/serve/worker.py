"""A process that answers questions for the server, one at a time; one that dies is started again."""

from __future__ import annotations

import contextlib
import gc
import math
import os
import signal
import sys
import threading
import time
import traceback
import warnings
from collections.abc import Callable, Sequence
from multiprocessing import get_context, parent_process
from multiprocessing.connection import Connection
from multiprocessing.context import SpawnProcess
from pathlib import Path
from typing import Any, Literal, NoReturn

from kerfwise.encoder.errors import Advice, InputError, KerfwiseError
from kerfwise.encoder.escape import escape_text
from kerfwise.encoder.files import read_only_within
from kerfwise.jobs.process_pool import show_warnings_as_notes, start_quietly

from .plan_request import STOP, Questions

# A process that answers questions for the server, one at a time. One that dies is started again, and nothing is lost:
# all that counts is held by the server.

Role = Literal["desk", "planner"]
Heard = Callable[[dict[str, Any]], None]
"""Called with what a process has to tell before its answer."""
ENDED_S = 3.0
COLLECTED = 100_000, 20, 20
"""Objects between two looks for what nobody needs: with Python's 700 these take a fifth of a first plan's time."""
SLOW = "there was no answer within {:g} s, and it was given up"


class Refused(Exception):
    """The question was answered: it cannot be, and `told` says why, as JSON."""

    def __init__(self, answer: dict[str, Any]) -> None:
        super().__init__(answer["message"])
        self.told = answer


class Died(Exception):
    """The process ended in the middle of its answer: it was killed, memory ran out, or a library has crashed."""


class Worker:
    """One such process. Threads may ask; each waits for its turn.

    `desk` answers in hundredths of a second, `planner` plans. Files that are named in what is asked are read within
    the folders `readable` only.
    """

    def __init__(self, role: Role, readable: Sequence[Path] = ()) -> None:
        self.role, self._readable = role, tuple(readable)
        self._turn = threading.Lock()
        self._process: SpawnProcess | None = None
        self._way: Connection | None = None
        self._stop: Connection | None = None
        self._closed = False

    @property
    def pid(self) -> int | None:
        """Of the process; None where none runs."""
        return None if self._process is None or not self._process.is_alive() else self._process.pid

    def ask(self, question: str, heard: Heard = lambda told: None, within_s: float | None = None, **given: Any) -> Any:
        """The answer, as JSON can hold it.

        Raises Refused if something given cannot be used, or there is no answer `within_s`; Died if the process died;
        the next question starts another.
        """
        with self._turn:
            if self._closed:
                raise Died("the server is ending")
            way = self._begun()
            try:
                way.send((question, given))
            except OSError:  # it has died since the last question
                way = self._begun(again=True)
                way.send((question, given))
            ends_s = math.inf if within_s is None else time.monotonic() + within_s
            try:
                while True:
                    if ends_s < math.inf and not way.poll(max(0.0, ends_s - time.monotonic())):
                        self._end()
                        raise Refused({"kind": "slow", "message": SLOW.format(within_s), "details": []})
                    kind, reply = way.recv()
                    if kind == "heard":
                        heard(reply)
                    elif kind == "answer":
                        return reply
                    else:
                        raise Refused(reply)
            except (EOFError, OSError):
                self._end()
                raise Died(f"the process that worked on it died ({self._how()}); another is started") from None

    def stop(self, how: str = STOP) -> None:
        """Ask it to come to an end soon, with the best that it has, or with nothing."""
        with contextlib.suppress(OSError, AttributeError, TypeError):  # closed, also while it is sent
            self._stop.send(how)  # type: ignore[union-attr]

    def kill(self) -> None:
        """End the process; what it is doing is lost, and who waits for it is told `Died`."""
        if (process := self._process) is not None:
            _kill_all(process)

    def close(self) -> None:
        """End the process for good."""
        self._closed = True
        self.kill()
        if (process := self._process) is not None:
            process.join(ENDED_S)

    def _begun(self, again: bool = False) -> Connection:
        if again:
            self._end()
        if self._way is None or self._process is None or not self._process.is_alive():
            self._end()
            context = get_context("spawn")
            self._way, there = context.Pipe()
            self._stop, stop = context.Pipe()
            work = (self.role, there, stop, self._readable)
            self._process = context.Process(target=answer_questions, args=work, daemon=True)
            start_quietly(self._process)
            there.close()
            stop.close()
        return self._way

    def _end(self) -> None:
        for way in (self._way, self._stop):
            if way is not None:
                way.close()
        self._way = self._stop = None
        if self._process is not None:
            _kill_all(self._process)
            self._process.join(ENDED_S)

    def _how(self) -> str:
        code = None if self._process is None else self._process.exitcode
        return f"signal {-code}" if code is not None and code < 0 else f"exit code {code}"


def _kill_all(process: SpawnProcess) -> None:
    """End a process, and whatever it has begun: solvers of others, which go on by themselves else."""
    if process.pid is None:  # it could not be started
        return
    process.kill()
    if hasattr(os, "killpg"):
        with contextlib.suppress(OSError):
            os.killpg(process.pid, signal.SIGKILL)


# What a process of the server does: it answers questions until nobody is there who asks.


def answer_questions(role: str, way: Connection, stop: Connection, readable: Sequence[Path] = ()) -> None:
    """Answer what is asked over a pipe, as the desk or as the planner."""
    gc.set_threshold(*COLLECTED)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches every process; only the first one answers
    if hasattr(os, "setpgid"):
        os.setpgid(0, 0)  # it ends with all that it begins
    threading.Thread(target=_end_with_server, daemon=True).start()
    show_few_notes()
    if readable:
        read_only_within(readable)
    asking = Questions(way, stop)
    if role == "planner":
        from .planner import planner as made
    else:
        from .query_worker import desk as made
    answers = made(asking)
    with contextlib.suppress(EOFError, OSError):
        while True:
            question, arguments = way.recv()
            try:
                reply = ("answer", answers[question](**arguments))
            except Exception as error:  # the server lives on, whatever went wrong
                reply = ("refused", error_as_json(error))
            way.send(reply)
    _end_all()  # threads that wait for the end of the server may not have seen it yet


def show_few_notes() -> None:
    """Have this process write warnings as notes, and none on what is still going on: pages say that."""
    show_warnings_as_notes()
    warnings.filterwarnings("ignore", ".*, still going$", Advice)


def _end_with_server() -> None:
    """End all once the server has ended, whatever this process is doing."""
    if (server := parent_process()) is not None:
        server.join()
    _end_all()


def _end_all() -> NoReturn:
    """End this process and all that it has begun."""
    if hasattr(os, "killpg"):
        os.killpg(0, signal.SIGKILL)
    os._exit(1)


def error_as_json(error: Exception) -> dict[str, Any]:
    """What went wrong, as JSON: `input` for what a person gave, `fault` for a fault of kerfwise itself."""
    if isinstance(error, InputError):
        place = {"file": str(error.file) if error.file else None, "line": error.line, "column": error.column}
        details = [escape_text(text) for text in error.details]
        return {"kind": "input", "message": escape_text(error.message), "details": details, **place, **_drawn(error)}
    if isinstance(error, KerfwiseError):
        return {"kind": "input", "message": str(error), "details": []}
    traceback.print_exception(error, file=sys.stderr)
    return {"kind": "fault", "message": f"a fault of kerfwise itself: {type(error).__name__}: {error}", "details": []}


def _drawn(error: InputError) -> dict[str, Any]:
    """The drawing that cannot be cut, with what is wrong where, or the questions that it raises."""
    from kerfwise.encoder.questions import Questions as OfDrawing
    from kerfwise.encoder.readers.read import BrokenNest

    from .query_worker import Unmended, problems_of

    if isinstance(error, OfDrawing):
        return {"questions": error.as_json()}
    if isinstance(error, Unmended):
        return {"problems": problems_of(error.broken, error.left)}
    return {"problems": problems_of(error, None)} if isinstance(error, BrokenNest) else {}
