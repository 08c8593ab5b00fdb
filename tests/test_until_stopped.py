"""A long command of the tests that is stopped says so, and what it has."""

from __future__ import annotations

import contextlib
import os
import signal
from collections.abc import Iterator

import pytest

from kerfwise.tests.until_stopped import until_stopped


def results(stop: signal.Signals | None = None) -> Iterator[int]:
    yield 1
    yield 2
    if stop is not None:
        os.kill(os.getpid(), stop)
    yield 3


def test_all_come_where_nobody_stops_it() -> None:
    assert list(until_stopped(results(), 3, "nests")) == [1, 2, 3]


@pytest.mark.parametrize("stop", [signal.SIGINT, signal.SIGTERM])
def test_stopped_it_ends_with_what_there_is(stop: signal.Signals, capsys: pytest.CaptureFixture[str]) -> None:
    assert list(until_stopped(results(stop), 3, "nests")) == [1, 2]
    assert capsys.readouterr().err == "stopped after 2 of 3 nests\n"


def test_it_ends_though_what_runs_takes_the_signal_for_its_own(capsys: pytest.CaptureFixture[str]) -> None:
    def swallowing() -> Iterator[int]:
        with contextlib.suppress(KeyboardInterrupt):
            os.kill(os.getpid(), signal.SIGTERM)
        yield 1
        yield 2

    assert list(until_stopped(swallowing(), 2, "nests")) == [1]
    assert capsys.readouterr().err == "stopped after 1 of 2 nests\n"


def test_no_more_begin_after_the_minutes() -> None:
    assert list(until_stopped(results(), 3, "nests", minutes=0.0)) == []
