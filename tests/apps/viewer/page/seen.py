"""A page in the browser, and what the tests do with it."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal, cast

from playwright.sync_api import Browser, Page

HEIGHTS = {1400: 900, 1024: 768, 390: 844}
_READY = "document.documentElement.dataset.ready === 'yes'"
_SHARP = "[...document.querySelectorAll('#stages canvas')].every(canvas => canvas.dataset.sharp === 'true')"


class Seen:
    """An open page; `wrong` are errors of its scripts and lines of its console, `asked` requests for anything else."""

    def __init__(self, browser: Browser, path: Path, wide: int, scheme: str) -> None:
        look = cast(Literal["dark", "light"], scheme)
        self.context = browser.new_context(
            viewport={"width": wide, "height": HEIGHTS[wide]}, color_scheme=look, has_touch=wide < 500
        )
        self.page: Page = self.context.new_page()
        self.wrong: list[str] = []
        self.asked: list[str] = []
        self.page.on("console", lambda said: self.wrong.append(said.text))
        self.page.on("pageerror", lambda error: self.wrong.append(str(error)))
        self.page.on("request", lambda request: self._note(request.url, path))
        self.page.goto(path.as_uri())
        self.until(_READY)
        self.sharp()

    def _note(self, url: str, path: Path) -> None:
        if url != path.as_uri() and not url.startswith(("data:", "blob:")):
            self.asked.append(url)

    def close(self) -> None:
        self.context.close()

    def sharp(self) -> None:
        """Waits until every drawing is what was asked for."""
        self.page.evaluate("() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
        self.until(_SHARP)

    def until(self, true: str) -> None:
        """Waits until an expression is true: the page's policy lets nobody else evaluate it again and again."""
        for _ in range(1000):
            if self.page.evaluate(true):
                return
            self.page.wait_for_timeout(15)
        raise AssertionError(f"this never came: {true}")

    def state(self, name: str) -> Any:
        """What is shown: see `State` in store.js."""
        return self.page.evaluate(f"window.kerfwise.state.{name}")

    @property
    def chosen(self) -> str:
        """The id of the contour that is chosen, "" for none."""
        return str(self.page.evaluate("window.kerfwise.data.nest.contours[window.kerfwise.state.selected]?.id ?? ''"))

    @property
    def said(self) -> str:
        """What a screen reader was told last."""
        return self.page.locator("#live").inner_text()

    def camera(self) -> tuple[float, float, float]:
        """Scale, x and y."""
        scale, x, y = self.page.evaluate("(({scale, x, y}) => [scale, x, y])(window.kerfwise.stages[0].camera)")
        return scale, x, y

    def drawing(self) -> tuple[float, float, float, float]:
        """Left, top, width and height of the first drawing, pixels of the page."""
        box = self.page.locator("#stages canvas").first.bounding_box()
        assert box is not None
        return box["x"], box["y"], box["width"], box["height"]

    def entry(self, contour: str) -> tuple[float, float]:
        """Where the cut of a contour enters it, pixels of the page."""
        script = """id => {
          const app = window.kerfwise, stage = app.stages[0];
          return stage.toScreen(...app.side.cuts[app.cutOf(app.numberOf(id))].entry);
        }"""
        x, y = self.page.evaluate(script, contour)
        left, top, *_ = self.drawing()
        return left + x, top + y
