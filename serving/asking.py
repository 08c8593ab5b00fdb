"""What passes between the server and a process of it: questions with their answers, and what is told meanwhile."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from multiprocessing.connection import Connection
from typing import Any

Answers = Mapping[str, Callable[..., Any]]
"""Question → what answers it."""


class Asking:
    """Whoever has asked: told what is reached, and asked whether the answer is still wanted."""

    def __init__(self, way: Connection, stop: Connection) -> None:
        self._way, self._stop, self._stopped = way, stop, False

    def tell(self, **told: Any) -> None:
        """Tell something before the answer."""
        self._way.send(("heard", told))

    @property
    def stopped(self) -> bool:
        """Whether the answer is to come to its end now."""
        while not self._stopped and self._stop.poll():
            self._stop.recv()
            self._stopped = True
        return self._stopped

    def begin(self) -> None:
        """Forget what was to be stopped before."""
        while self._stop.poll():
            self._stop.recv()
        self._stopped = False
