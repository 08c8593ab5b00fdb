"""A line on what is being done, once it takes long: reading, measuring and checking have no progress to show.

It is an `Advice`, which the command line writes to standard error; in Python it is a warning that can be filtered.
"""

from __future__ import annotations

import threading
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import wraps
from typing import ParamSpec, TypeVar

from .errors import Advice
from .escape import escape_text

AFTER_S = 5.0
"""Nobody wonders sooner."""

Of = ParamSpec("Of")
Made = TypeVar("Made")


class _Stage:
    """What is being done, and how much there is of it, where that is known."""

    def __init__(self, doing: str) -> None:
        self.doing, self.size = doing, ""

    def tell(self) -> None:
        size = f": {self.size}" if self.size else ""
        warnings.warn(f"{self.doing}{size}, still going", Advice, stacklevel=2)


_now: ContextVar[_Stage | None] = ContextVar("_now", default=None)


@contextmanager
def notice_if_long(doing: str) -> Iterator[None]:
    """Say once that this is still going on, if it takes longer than `AFTER_S`; what is within another is not told too.

    Examples
    --------
    >>> with notice_if_long("reading NEST.dxf"):
    ...     amount(34_000, "entity", "entities")
    """
    if _now.get() is not None:
        yield
        return
    stage = _Stage(escape_text(doing))
    timer = threading.Timer(AFTER_S, stage.tell)
    timer.daemon = True
    before = _now.set(stage)
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
        timer.join()  # whoever forks this process is to find no second thread
        _now.reset(before)


def long_job(doing: Callable[Of, str]) -> Callable[[Callable[Of, Made]], Callable[Of, Made]]:
    """Has a function say what it is doing, in words made of its arguments, if it takes long."""

    def told(function: Callable[Of, Made]) -> Callable[Of, Made]:
        @wraps(function)
        def run(*args: Of.args, **kwargs: Of.kwargs) -> Made:
            with notice_if_long(doing(*args, **kwargs)):
                return function(*args, **kwargs)

        return run

    return told


def amount(count: int, one: str, several: str) -> None:
    """How much there is to do in what is being done, to be told with it."""
    if (stage := _now.get()) is not None:
        stage.size = f"{count:,} {one if count == 1 else several}"
