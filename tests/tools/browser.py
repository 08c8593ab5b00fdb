"""The browser that the page is tested in: Chromium as the system has it; none is ever downloaded."""

from __future__ import annotations

import shutil

NAMES = ("chromium", "chromium-browser", "google-chrome")


class MissingBrowser(AssertionError):
    """Chromium is not on this machine: a test that needs it fails, and says how to get it."""


def chromium() -> str:
    """The path of Chromium."""
    found = next(filter(None, map(shutil.which, NAMES)), None)
    if found is None:
        raise MissingBrowser("Chromium is missing: `apt-get install chromium` installs it on Debian")
    return found
