"""Long commands of the tests: they say how far they are, and end early with what they have."""

from __future__ import annotations

import signal
import time
from collections.abc import Iterable, Iterator
from types import FrameType
from typing import TypeVar

import click

T = TypeVar("T")
TOLD_S = 30.0
"""So often a command says how far it is."""


def until_stopped(results: Iterable[T], of: int, what: str, minutes: float | None = None) -> Iterator[T]:
    """The results as they come, to the last, or until `minutes` are over, or somebody stops the command.

    Ctrl-C and the signal to terminate stop it after the results that are there. Standard error says so, and every half
    minute how many of the results there are.

    Examples
    --------
    >>> list(until_stopped([4, 5, 6], 3, "nests"))
    [4, 5, 6]
    >>> list(until_stopped([4, 5, 6], 3, "nests", minutes=0))
    []
    """
    started = told = time.monotonic()
    stopped = _Stopped()
    before = {number: signal.signal(number, stopped) for number in (signal.SIGINT, signal.SIGTERM)}
    done = 0
    try:
        coming = iter(results)
        while not stopped.asked and (minutes is None or time.monotonic() - started < 60 * minutes):
            try:
                result = next(coming)
            except StopIteration:
                break
            yield result
            done += 1
            if time.monotonic() - told > TOLD_S:
                told = time.monotonic()
                click.echo(f"{done} of {of} {what} after {(told - started) / 60:.1f} minutes", err=True)
    except KeyboardInterrupt:
        pass
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
    if stopped.asked:
        click.echo(f"stopped after {done} of {of} {what}", err=True)


class _Stopped:
    """Remembers that it was asked for: what runs may take the interruption for its own, and go on."""

    def __init__(self) -> None:
        self.asked = False

    def __call__(self, number: int, frame: FrameType | None) -> None:
        self.asked = True
        raise KeyboardInterrupt
