"""The browser that the page is tested in: Chromium as the system has it; none is ever downloaded."""

from __future__ import annotations

import contextlib
import shutil
from collections.abc import Iterator

from playwright.sync_api import Browser, sync_playwright

NAMES = ("chromium", "chromium-browser", "google-chrome")


class MissingBrowser(AssertionError):
    """Chromium is not on this machine: a test that needs it fails, and says how to get it."""


def chromium() -> str:
    """The path of Chromium."""
    found = next(filter(None, map(shutil.which, NAMES)), None)
    if found is None:
        raise MissingBrowser("Chromium is missing: `apt-get install chromium` installs it on Debian")
    return found


@contextlib.contextmanager
def launched() -> Iterator[Browser]:
    """Chromium as the system has it, until the end of the context."""
    with sync_playwright() as play:
        # As root, as in most containers, Chromium runs without its sandbox only.
        browser = play.chromium.launch(executable_path=chromium(), args=["--no-sandbox"])
        yield browser
        browser.close()
