"""A person at the page of a nest: with a mouse on a wide screen, with fingers on a phone."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from playwright.sync_api import Browser, ConsoleMessage, Page

from kerfwise.tests.apps.viewer.serve.served import Served, Tab

HEIGHTS = {1400: 900, 1024: 768, 390: 844}
WAIT_S = 60.0
BAD = ("error", "warning")
"""Kinds of what a console says; that the server has refused something, 422, is told by the browser itself."""
Place = tuple[float, float]


class AtPage:
    """A tab of the browser that has the token; `wrong` is what its console said, and what it asked of anybody else."""

    def __init__(self, browser: Browser, served: Served, wide: int = 1400, wait_s: float = WAIT_S) -> None:
        self.touch = wide < 500
        self.context = browser.new_context(viewport={"width": wide, "height": HEIGHTS[wide]}, has_touch=self.touch)
        self.page: Page = self.context.new_page()
        self.served, self.wrong, self._wait_s = served, list[str](), wait_s
        page, wrong = self.page, self.wrong
        page.set_default_timeout(1000 * wait_s)
        page.on("console", self._heard)
        page.on("pageerror", lambda error: wrong.append(str(error)))
        own = (served.address, "data:", "blob:")
        page.on("request", lambda asked: None if asked.url.startswith(own) else wrong.append(asked.url))
        page.goto(served.entrance)
        self._fingers = self.context.new_cdp_session(page)

    def _heard(self, said: ConsoleMessage) -> None:
        if said.type in BAD and "422" not in said.text:
            self.wrong.append(said.text)

    def open(self, tab: Tab) -> None:
        """Show a nest, and wait until the page stands."""
        self.page.goto(f"{self.served.address}/nest/{tab.id}")
        self.page.wait_for_selector("[data-ready=yes]", state="attached")
        self.sharp()

    def close(self) -> None:
        self.context.close()

    def ask(self, script: str, *given: Any) -> Any:
        """What a script says of the page; `app` is the page itself."""
        return self.page.evaluate(f"given => {{ const app = window.kerfwise; return ({script}); }}", [*given])

    def until(self, script: str, *given: Any) -> Any:
        """Wait until a script says something, and tell it: the page's policy lets nobody else ask it often."""
        ends_s = time.monotonic() + self._wait_s
        while not (said := self.ask(script, *given)):
            assert time.monotonic() < ends_s, f"this never came: {script}"
            self.page.wait_for_timeout(15)
        return said

    def frames(self) -> None:
        """Wait for two frames."""
        self.page.evaluate("() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")

    def sharp(self) -> None:
        """Wait until every drawing is what was asked for."""
        self.frames()
        self.until("[...document.querySelectorAll('#stages canvas')].every(canvas => canvas.dataset.sharp === 'true')")

    def panel(self, name: str) -> None:
        """Show a panel; on a wide screen the order is always seen, and has no tab."""
        if name != "order" or self.page.locator("#tab-order").is_visible():
            self.page.click(f"#tab-{name}")

    @property
    def order(self) -> list[str]:
        """Ids of the contours in the order that the page shows."""
        script = "app.side ? app.side.cuts.map(cut => app.data.nest.contours[cut.contour].id) : []"
        return [str(one) for one in self.ask(script)]

    @property
    def chosen(self) -> str:
        return str(self.ask("app.data.nest.contours[app.state.selected]?.id ?? ''"))

    def choose(self, contour: str) -> None:
        """Choose a contour, and look at the buttons under why."""
        self.ask("app.chooseId(given[0])", contour)
        self.panel("why")

    def press(self, title: str) -> None:
        """A button of the chosen contour."""
        self.page.locator("#hands-chosen button", has_text=title).click()

    def plan(self) -> None:
        """Have the nest planned, and wait for the plan."""
        before = self.plans
        self.page.click("#hands-plan")
        self.planned(before + 1)

    @property
    def plans(self) -> int:
        return self.page.locator("#hands-plans li").count()

    def planned(self, plans: int) -> None:
        """Wait until there are so many plans, or more where better ones came meanwhile, and the shown one is drawn."""
        self.page.wait_for_selector(f"#hands-plans li:nth-child({plans})", state="attached")
        self.page.wait_for_selector("#hands-cancel", state="hidden")
        self.until(
            "Number(document.documentElement.dataset.plan) === document.querySelector('#hands-plans .shown').value"
        )

    def drag(self, places: Sequence[Place], held: bool = False, stay_ms: int = 0) -> None:
        """Press at the first place, until it is `held`, and move to the others; nothing is let go yet."""
        (x, y), *way = places
        if not self.touch:
            self.page.mouse.move(x, y)
            self.page.mouse.down()
        else:
            self._finger("touchStart", x, y)
        if held:
            self.page.wait_for_selector("#hands-verdict:has-text(' is held: ')")
        for to_x, to_y in way:
            for part in (0.2, 0.6, 1.0):
                self.move(x + part * (to_x - x), y + part * (to_y - y))
            x, y = to_x, to_y
        self.page.wait_for_timeout(stay_ms)

    def move(self, x: float, y: float) -> None:
        """Move what is pressed."""
        if self.touch:
            self._finger("touchMove", x, y)
        else:
            self.page.mouse.move(x, y)

    def let_go(self) -> None:
        if self.touch:
            self._fingers.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
        else:
            self.page.mouse.up()

    def tap(self, x: float, y: float) -> None:
        """Click, or tap with a finger."""
        if self.touch:
            self.page.touchscreen.tap(x, y)
        else:
            self.page.mouse.click(x, y)

    def verdict(self) -> str:
        """What is said of the move before it is dropped."""
        self.frames()  # the last move may be told with the next frame only
        return str(self.until("(at => at.className && at.innerText)(document.getElementById('hands-verdict'))"))

    def row(self, contour: str) -> Place:
        """The grip of a contour's row."""
        script = """(() => {
          const row = document.querySelector(`#orders .row[data-contour="${CSS.escape(given[0])}"] .no`);
          const { left, top, height } = row.getBoundingClientRect(); return [left + 8, top + height / 2]; })()"""
        x, y = self.ask(script, contour)
        return x, y

    def drag_row(self, contour: str, to: str) -> str:
        """Drag a row onto another one; what is said of it before it is dropped."""
        self.drag([self.row(contour), self.row(to)])
        return self.verdict()

    def drag_part(self, contour: str, to: str) -> str:
        """Drag a part onto another one on the drawing: with Shift held, or by a finger that stays before it moves."""
        if not self.touch:
            self.page.keyboard.down("Shift")
        self.drag([self.inside(contour), self.inside(to)], held=self.touch)
        if not self.touch:
            self.page.keyboard.up("Shift")
        return self.verdict()

    def inside(self, contour: str) -> Place:
        """The middle of a contour on the drawing."""
        script = """(() => {
          const stage = app.stages[0], [x0, y0, x1, y1] = stage.scenery.outlines.bounds[app.numberOf(given[0])];
          return stage.toScreen((x0 + x1) / 2, (y0 + y1) / 2); })()"""
        return self._on_page(self.ask(script, contour))

    def at(self, x: float, y: float) -> Place:
        """A place of the sheet, mm, on the page."""
        return self._on_page(self.ask("app.stages[0].toScreen(given[0], given[1])", x, y))

    def entry(self, contour: str) -> Place:
        """Where the cut of a contour enters it."""
        return self._on_page(
            self.ask("app.stages[0].toScreen(...app.side.cuts[app.cutOf(app.numberOf(given[0]))].entry)", contour)
        )

    def picture(self, folder: Path, name: str) -> None:
        self.page.screenshot(path=folder / f"{name}.png")

    def _on_page(self, place: Sequence[float]) -> Place:
        box = self.page.locator("#stages canvas").first.bounding_box()
        assert box is not None
        return box["x"] + place[0], box["y"] + place[1]

    def _finger(self, kind: str, x: float, y: float) -> None:
        self._fingers.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": [{"x": x, "y": y}]})


def drop(page: Page, name: str, text: str) -> None:
    """Drop a file on the list of nests."""
    data = page.evaluate_handle(
        "([text, name]) => { const all = new DataTransfer(); all.items.add(new File([text], name)); return all; }",
        [text, name],
    )
    page.dispatch_event("main", "drop", {"dataTransfer": data})
