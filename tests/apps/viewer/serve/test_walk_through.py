"""The walk-through of the docs is what happens: every sentence that it quotes stands on the page, and in a picture."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page

import kerfwise
from kerfwise.tests.apps.viewer.serve.served import Served
from kerfwise.tests.apps.viewer.serve.walk_through import PICTURES, STEPS, picture, walk

TEXT = (Path(kerfwise.__file__).parent / "docs" / "walk-through.md").read_text(encoding="utf-8")
MOST_BYTES = 100_000
SHOWN = """() => window.kerfwise.stages.map(stage => {
  const [x0, y0, x1, y1] = stage.data.nest.bounds;
  const [left, bottom] = stage.toScreen(x0, y0), [right, top] = stage.toScreen(x1, y1);
  return [left, top, stage.size.wide - right, stage.size.high - bottom, (right - left) / stage.size.wide];
})"""


def quoted() -> dict[str, list[str]]:
    """By picture, what its section quotes of the page."""
    found = {}
    for section in TEXT.split("\n## ")[1:]:
        (name,) = re.findall(r"!\[[^\]]+\]\(walk-through/([\w-]+)\.webp\)", section)
        found[name] = [" ".join(quote.split()) for quote in re.findall(r"`([^`]+)`", section)]
    return found


def test_every_step_has_its_section_and_a_small_picture() -> None:
    assert list(quoted()) == list(STEPS)
    assert all(quoted().values())
    assert sorted(path.name for path in PICTURES.iterdir()) == [f"{name}.webp" for name in STEPS]
    for name in STEPS:
        data = (PICTURES / f"{name}.webp").read_bytes()
        assert (data[:4], data[8:12]) == (b"RIFF", b"WEBP")
        assert 5_000 < len(data) <= MOST_BYTES


@pytest.mark.slow
@pytest.mark.browser
def test_the_page_says_what_the_walk_through_quotes(browser: Browser, served: Served) -> None:
    seen: list[str] = []

    def see(name: str, page: Page) -> None:
        text = " ".join(page.locator("body").inner_text().split())
        missing = [quote for quote in quoted()[name] if quote not in text]
        assert missing == [], f"docs/walk-through.md, {name}: not on the page, which says: {text}"
        for left, top, right, bottom, share in page.evaluate(SHOWN):
            assert min(left, top, right, bottom) > 0, f"{name}: the sheet is not in view"
            assert share > 0.4
        assert len(picture(page)) <= MOST_BYTES
        seen.append(name)

    walk(browser, served, see)
    assert seen == list(STEPS)
    assert (served.server.folder.path / "e1x_6.nc").is_file()
