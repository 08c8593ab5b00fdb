"""The walk-through of the docs: what is done on the page of `kerfwise serve`, step by step.

`python -m kerfwise.tests.apps.viewer.serve.walk_through docs/walk-through` does it in Chromium and writes the
pictures.
"""

from __future__ import annotations

import base64
import shutil
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

from playwright.sync_api import Browser, Page

import kerfwise
from kerfwise.postproc.output_files import write_files
from kerfwise.tests.apps.viewer.serve.served import EXAMPLES, Served, serving
from kerfwise.tests.tools.browser import launched

PICTURES = Path(kerfwise.__file__).parent / "docs" / "walk-through"
NEST = "e1x_6.dxf"
WIDE, HIGH = 1280, 760
_QUALITY = 72


def opened(page: Page) -> None:
    """The nest is chosen in the list of the folder."""
    page.click(f"#nests button[aria-label='{NEST}']")
    page.wait_for_selector("[data-ready=yes]", state="attached")
    page.wait_for_selector("#hands-plan")


def planned(page: Page) -> None:
    page.click("#hands-plan")
    page.wait_for_selector("#hands-plans li", state="attached")
    page.wait_for_selector("#row-15")
    page.wait_for_selector("#hands-cancel", state="hidden")


def why(page: Page) -> None:
    """A contour is clicked on the drawing, where it is entered."""
    page.click("#tab-why")
    page.mouse.click(*entry(page, "P2.outer"))
    page.wait_for_selector("#why-said :text('If it were moved')")


def dragged(page: Page) -> None:
    """A row of the order is dragged, and not let go yet."""
    start, to = (page.locator(f"#row-{k} .no").bounding_box() for k in (9, 6))
    assert start is not None
    assert to is not None
    page.mouse.move(start["x"] + 8, start["y"] + 8)
    page.mouse.down()
    page.mouse.move(to["x"] + 8, to["y"] + 8, steps=6)
    page.wait_for_selector("#hands-verdict.good:has-text('as number 7')")


def compared(page: Page) -> None:
    """The row is let go: it is locked there, and the nest is planned again. Then both plans stand side by side."""
    page.mouse.up()
    page.wait_for_selector("#hands-plans li:nth-child(2)", state="attached")
    page.wait_for_selector("#hands-cancel", state="hidden")
    page.click("#tab-plans")
    page.click("#hands-plans button.compare")
    page.wait_for_selector("#stages figure[data-side='1']")


def contradicted(page: Page) -> None:
    """The operator wants an outline cut before the hole in it."""
    page.click("#tab-plans")
    page.click("#hands-plans button.compare[aria-pressed=true]")
    page.wait_for_selector("#stages figure[data-side='1']", state="detached")
    page.click("#tab-locks")
    page.fill("#hands-lock-line", "P3.outer first")
    page.press("#hands-lock-line", "Enter")
    page.wait_for_selector("#hands-locks li:has-text('P3.outer')")
    page.click("#hands-plan")
    page.wait_for_selector("#hands-conflict .good")


def saved(page: Page) -> None:
    """What was too much is taken back, and the plan is saved."""
    page.click("#hands-conflict button:has-text('undo: P3.outer first')")
    page.wait_for_selector("#hands-conflict", state="hidden")
    page.wait_for_selector("#hands-plans li:nth-child(3)", state="attached")
    page.wait_for_selector("#hands-cancel", state="hidden")
    page.click("#hands-save")
    page.wait_for_selector("#hands-said:has-text('saved e1x_6.nc')")


def entry(page: Page, contour: str) -> tuple[float, float]:
    """Where a contour begins to be cut, pixels of the page."""
    script = """id => {
      const app = window.kerfwise, stage = app.stages[0], box = stage.canvas.getBoundingClientRect();
      const [x, y] = stage.toScreen(...app.side.cuts[app.cutOf(app.numberOf(id))].entry);
      return [box.left + x, box.top + y];
    }"""
    x, y = page.evaluate(script, contour)
    return x, y


STEPS: dict[str, Callable[[Page], None]] = {
    "1-open": opened,
    "2-plan": planned,
    "3-why": why,
    "4-drag": dragged,
    "5-compare": compared,
    "6-conflict": contradicted,
    "7-save": saved,
}
"""By the name of its picture, what is done before it is taken."""


def walk(browser: Browser, served: Served, see: Callable[[str, Page], None]) -> None:
    """Do every step, and show the page after it."""
    shutil.copy(EXAMPLES / NEST, served.server.folder.path / NEST)
    page = browser.new_page(viewport={"width": WIDE, "height": HIGH})
    page.set_default_timeout(60_000)
    page.goto(f"{served.entrance}&list")
    page.wait_for_selector("h1")
    for name, does in STEPS.items():
        does(page)
        settle(page)
        see(name, page)
    page.close()


def settle(page: Page) -> None:
    """Waits until every drawing is sharp and nothing is asked for any more."""
    for _ in range(400):
        if page.evaluate("[...document.querySelectorAll('#stages canvas')].every(one => one.dataset.sharp === 'true')"):
            return
        page.wait_for_timeout(15)
    raise AssertionError("the drawing never became sharp")


def picture(page: Page) -> bytes:
    """The page as a WebP picture, as small as can be read."""
    shown = page.context.new_cdp_session(page).send("Page.captureScreenshot", {"format": "webp", "quality": _QUALITY})
    return base64.b64decode(shown["data"])


if __name__ == "__main__":
    made: dict[Path, bytes] = {}

    def see(name: str, page: Page) -> None:
        made[Path(sys.argv[1]) / f"{name}.webp"] = picture(page)

    with tempfile.TemporaryDirectory() as folder, serving(Path(folder)) as server, launched() as browser:
        walk(browser, server, see)
    write_files(made)
