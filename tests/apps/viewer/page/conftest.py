"""Each page made once, and opened in the browser."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser

from kerfwise.tests.apps.viewer.page.made_pages import PAGES
from kerfwise.tests.apps.viewer.page.seen import Seen

Open = Callable[..., Seen]


@pytest.fixture(scope="session")
def page_file(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """The file of a page by its name in `PAGES`."""
    folder = tmp_path_factory.mktemp("pages")

    def file(name: str) -> Path:
        path = folder / f"{name}.html"
        if not path.exists():
            path.write_bytes(PAGES[name](folder))
        return path

    return file


@pytest.fixture
def look(browser: Browser, page_file: Callable[[str], Path]) -> Iterator[Open]:
    """Opens a page, so wide and in such a look; at the end nothing may be wrong, and nobody may have been asked."""
    opened: list[Seen] = []

    def opens(name: str, wide: int = 1400, scheme: str = "light") -> Seen:
        seen = Seen(browser, page_file(name), wide, scheme)
        opened.append(seen)
        return seen

    yield opens
    for seen in opened:
        seen.close()
        assert seen.wrong == []
        assert seen.asked == []
