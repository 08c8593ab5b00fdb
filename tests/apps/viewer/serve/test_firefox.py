"""One walk through the interactive viewer in Firefox, as the system has it: by its own protocol, without a driver."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from kerfwise.tests.apps.viewer.serve.served import SMALL, Served, serving
from kerfwise.tests.tools.browser import MissingBrowser

pytestmark = [pytest.mark.full, pytest.mark.slow, pytest.mark.browser]

NAMES = ("firefox-esr", "firefox")
WAIT_S = 60.0
PORT = 28281
NOTE_ERRORS = "addEventListener('error', e => { document.documentElement.dataset.wrong = e.message; });"


def firefox() -> str:
    """The path of Firefox."""
    found = next(filter(None, map(shutil.which, NAMES)), None)
    if found is None:
        raise MissingBrowser("Firefox is missing: `apt-get install firefox-esr` installs it on Debian")
    return found


class InFirefox:
    """A tab of Firefox, and what is done in it."""

    def __init__(self, marionette: Any) -> None:
        from marionette_driver import Wait

        self.tab = marionette
        self.wait = Wait(marionette, timeout=WAIT_S)

    def see(self, css: str, text: str = "") -> Any:
        """An element that is seen, with a text in it, once there is one."""

        def found(tab: Any) -> Any:
            every = tab.find_elements("css selector", css)
            return next((one for one in every if one.is_displayed() and text in one.text), None)

        return self.wait.until(found, message=f"{css} with {text!r} never came")

    def ask(self, script: str) -> Any:
        """What a script says of the page."""
        return self.tab.execute_script(f"return ({script});")

    def rows(self) -> list[str]:
        """Contours in the order that the page lists."""
        listed: list[str] = self.ask("[...document.querySelectorAll('#orders .row')].map(row => row.dataset.contour)")
        return listed

    def drag_row(self, contour: str, to: str) -> None:
        """Drag the row of a contour onto another one, and see what is said before it is dropped."""
        from marionette_driver.marionette import ActionSequence

        grip, over = (self.see(f"#orders .row[data-contour='{name}'] .no") for name in (contour, to))
        hand = ActionSequence(self.tab, "pointer", "hand", {"pointerType": "mouse"})
        hand.pointer_move(0, 0, origin=grip).pointer_down()
        hand.pointer_move(0, 6, origin=grip, duration=100).pointer_move(0, 2, origin=over, duration=200).perform()
        self.see("#hands-verdict.said")
        hand = ActionSequence(self.tab, "pointer", "hand", {"pointerType": "mouse"})
        hand.pointer_up().perform()


@contextmanager
def in_firefox(folder: Path) -> Iterator[InFirefox]:
    from marionette_driver.marionette import Marionette

    made = Marionette(bin=firefox(), headless=True, port=PORT, gecko_log=str(folder / "gecko.log"))
    made.start_session()
    try:
        made.set_window_rect(width=1400, height=900)
        yield InFirefox(made)
    finally:
        made.quit()
        made.cleanup()


@pytest.fixture
def own(tmp_path: Path) -> Iterator[Served]:
    (folder := tmp_path / "nests").mkdir()
    (folder / "small.json").write_text(SMALL, encoding="utf-8")
    with serving(folder) as served:
        yield served


def test_a_walk(own: Served, tmp_path: Path) -> None:
    with in_firefox(tmp_path) as at:
        at.tab.navigate(own.entrance)
        at.see("#nests button", "small.json").click()
        at.see("html[data-ready=yes] #hands-plan")
        at.ask(f"(() => {{ {NOTE_ERRORS} }})()")
        at.see("#hands-plan").click()
        at.see("#verdict", "every hard rule holds")
        at.see("#row-3")
        before = at.rows()
        at.drag_row("B.outer", "C.outer")
        at.wait.until(lambda _: at.rows() not in ([], before), message="the order never changed")
        assert at.rows().index("B.outer") == 3
        at.see("#tab-locks").click()
        at.see("#hands-locks li", "B.outer position 4")
        at.see("#hands-save:not([disabled])").click()
        at.see("#hands-said", "saved small.nc")
        assert (own.server.folder.path / "small.nc").is_file()
        at.see("#hands-undo").click()
        at.wait.until(lambda _: at.rows() == before, message="undo never came back to the first order")
        at.see("#tab-why").click()
        at.see("#look").click()
        at.tab.execute_script(
            "const s = document.getElementById('language'); s.value = 'de'; s.dispatchEvent(new Event('change'));"
        )
        at.see("html[lang=de] #verdict", "jede harte Regel")
        assert at.ask("document.documentElement.scrollWidth - innerWidth") <= 0
        assert at.ask("document.documentElement.dataset.wrong ?? ''") == ""
