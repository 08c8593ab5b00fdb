"""Who listens while a plan is made: told what the engines have reached; Ctrl-C keeps the best plan so far."""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass
from types import FrameType
from typing import Any, Self

from kerfwise.encoder.geometry.tolerances import UM_PER_MM


@dataclass(frozen=True, slots=True)
class Reached:
    """What the engines have reached so far.

    Attributes
    ----------
    engine
        The one that speaks.
    objective_mm, bound_mm
        Cost of the best plan and what is proven of it, mm of idle travel; None where there is none yet.
    seconds
        Since the engines began.
    """

    engine: str
    objective_mm: float | None
    bound_mm: float | None
    seconds: float


OnProgress = Callable[[Reached], object]
"""Called now and then; if it answers False, the engines stop with the best plan so far."""


class CtrlC:
    """As a context, it takes Ctrl-C where it is entered in the main thread: the first asks to stop, the second aborts.

    Attributes
    ----------
    interrupted
        Whether the user pressed Ctrl-C.
    stopped
        Whether the work was asked to stop, for whatever reason.
    signals
        Those that ask to stop.
    shown
        What a terminal shows meanwhile: a context; None in a pipe.
    """

    signals: tuple[signal.Signals, ...] = (signal.SIGINT,)

    def __init__(self, shown: Any = None) -> None:
        self.interrupted = self.stopped = False
        self.started = time.monotonic()
        self.shown = shown
        self._held = ExitStack()

    def stop(self, signum: int, frame: FrameType | None) -> None:
        """The first Ctrl-C asks to stop; a second one aborts."""
        if self.interrupted:
            raise KeyboardInterrupt
        self.interrupted = self.stopped = True

    def __enter__(self) -> Self:
        self.started = time.monotonic()
        if threading.current_thread() is threading.main_thread():
            for number in self.signals:
                self._held.callback(signal.signal, number, signal.signal(number, self.stop))
        if self.shown is not None:
            self._held.enter_context(self.shown)
        return self

    def __exit__(self, *error: object) -> None:
        self._held.close()


class Listener(CtrlC):
    """Listens to the engines, and answers False once the user has had enough.

    It takes Ctrl-C for the time of a solve. What `on_progress` raises stops the engines too; a KeyboardInterrupt counts
    as Ctrl-C, everything else comes out at the end of the context.
    """

    def __init__(self, on_progress: OnProgress | None = None, shown: Any = None) -> None:
        super().__init__(shown)
        self._on_progress = on_progress
        self._failure: BaseException | None = None

    def __call__(self, engine: str, cost_um: int | None, bound_um: int | None) -> bool:
        """What an engine has reached, µm; whether to go on."""
        if self._on_progress is not None and not self.stopped:
            seconds = time.monotonic() - self.started
            try:
                going = self._on_progress(Reached(engine, _mm(cost_um), _mm(bound_um), seconds))
            except KeyboardInterrupt:
                self.interrupted = self.stopped = True
            except BaseException as failure:  # an engine's thread would swallow it
                self._failure, self.stopped = failure, True
            else:
                self.stopped = self.stopped or going is False
        return not self.stopped

    def __exit__(self, *error: object) -> None:
        super().__exit__(*error)
        if self._failure is not None:
            raise self._failure


class Listeners:
    """Makes a listener for each sheet or job of several, and knows what all of them have heard."""

    def __init__(self, listener: Callable[[str], Listener]) -> None:
        self._listener = listener
        self._made: list[Listener] = []

    def __call__(self, name: str) -> Listener:
        """The listener of the next one, which is called so."""
        self._made.append(self._listener(name))
        return self._made[-1]

    @property
    def interrupted(self) -> bool:
        """Whether the user pressed Ctrl-C in one of them."""
        return any(one.interrupted for one in self._made)

    @property
    def stopped(self) -> bool:
        """Whether one of them was asked to stop."""
        return any(one.stopped for one in self._made)


def _mm(um: int | None) -> float | None:
    return um / UM_PER_MM if um else None
