"""What a process of the server does: it answers questions until nobody is there who asks."""

from __future__ import annotations

import contextlib
import signal
import sys
import threading
import traceback
from multiprocessing.connection import Connection
from typing import Any

from kerfwise.encoder.errors import InputError, KerfwiseError
from kerfwise.encoder.shown import shown
from kerfwise.jobs.processes import end_with_parent

from .asking import Asking


def answer_questions(role: str, way: Connection, stop: Connection) -> None:
    """Answer what is asked over a pipe, as the desk or as the planner."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches every process; only the first one answers
    threading.Thread(target=end_with_parent, daemon=True).start()
    asking = Asking(way, stop)
    if role == "planner":
        from .planner import planner as made
    else:
        from .desk import desk as made
    answers = made(asking)
    with contextlib.suppress(EOFError, OSError):
        while True:
            question, given = way.recv()
            try:
                told = ("answer", answers[question](**given))
            except Exception as error:  # the server lives on, whatever went wrong
                told = ("refused", as_told(error))
            way.send(told)


def as_told(error: Exception) -> dict[str, Any]:
    """What went wrong, as JSON: `input` for what a person gave, `fault` for a fault of kerfwise itself."""
    if isinstance(error, InputError):
        place = {"file": str(error.file) if error.file else None, "line": error.line, "column": error.column}
        details = [shown(text) for text in error.details]
        return {"kind": "input", "message": shown(error.message), "details": details, **place, **_drawn(error)}
    if isinstance(error, KerfwiseError):
        return {"kind": "input", "message": str(error), "details": []}
    traceback.print_exception(error, file=sys.stderr)
    return {"kind": "fault", "message": f"a fault of kerfwise itself: {type(error).__name__}: {error}", "details": []}


def _drawn(error: InputError) -> dict[str, Any]:
    """The drawing that cannot be cut, with what is wrong where."""
    from kerfwise.encoder.readers.read import BrokenNest

    from .problems import Unmended, problems_of

    if isinstance(error, Unmended):
        return {"problems": problems_of(error.broken, error.left)}
    return {"problems": problems_of(error, None)} if isinstance(error, BrokenNest) else {}
