"""What the processes of `test_processes` work on: a module of its own, which they can import by its full name."""

from __future__ import annotations

import os
import time
import warnings
from pathlib import Path

from kerfwise.encoder.errors import Advice
from kerfwise.models.jit import cores, machine_cores


class Unsendable(Exception):
    """Cannot be made again from what pickle keeps of it."""

    def __init__(self, word: str, number: str) -> None:
        super().__init__(word + number)


def doubled(piece: int) -> int:
    """Twice the number; 13 kills the process, 7 is an exception."""
    if piece == 13:
        os._exit(3)
    if piece == 7:
        raise ZeroDivisionError("seven")
    if piece == 8:
        raise Unsendable("eight", "8")
    return 2 * piece


def shares(piece: int) -> tuple[int, int]:
    """Threads that a process may start, and the cores that it may use; slow enough for every process to have one."""
    time.sleep(0.3)
    return cores(), len(machine_cores())


def warns(text: str) -> str:
    """Warns of something, as the readers do where they take long, and as a library does."""
    warnings.warn(text, Advice, stacklevel=2)
    warnings.warn("overflow", RuntimeWarning, stacklevel=2)
    return text


def sleeps(place: str) -> None:
    """Say who this is, and sleep."""
    Path(place).write_text(str(os.getpid()))
    time.sleep(600)
