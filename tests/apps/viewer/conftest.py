"""One browser for all tests of the viewer that follow each other: to start it takes a second of the processor."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path

import pytest
from playwright.sync_api import Browser

from kerfwise.tests.tools.browser import launched

_started = ExitStack()
_browsers: list[Browser] = []


@pytest.fixture
def browser() -> Browser:
    """It has a loop in this thread: tests of this folder run theirs by `in_a_loop`."""
    if not _browsers:
        _browsers.append(_started.enter_context(launched()))
    return _browsers[0]


@pytest.hookimpl(trylast=True)
def pytest_runtest_teardown(nextitem: pytest.Item | None) -> None:
    """End it before tests of other folders, which may begin loops, and browsers, of their own."""
    if nextitem is None or Path(__file__).parent not in nextitem.path.parents:
        _browsers.clear()
        _started.close()
