"""The page with hands on made plates of 16 to 1,000 contours: drag and re-plan, zoomed hits, keyboard, paper."""

from __future__ import annotations

import io
import json
from collections.abc import Iterator
from functools import cache

import httpx
import pypdfium2
import pytest
from playwright.sync_api import Browser

from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.tests.serving.at_page import AtPage
from kerfwise.tests.serving.conftest import TOKEN, Served, Tab, serving

pytestmark = [pytest.mark.slow, pytest.mark.browser]

ROW_PX = 27
LONG_S = 600.0
"""A thousand contours take half a minute of the processor, which others may have."""
WORK = 0.01
"""Of a plan: nothing is proven by it, and what takes time is all the rest."""
PAGES = {16: 1, 115: 3, 308: 7, 1000: 22}
"""Pages of A4 with a drawing and a row a cut."""


class Plates:
    """Made plates on a server of their own, each planned once. Whoever asks for one is shown its first plan."""

    def __init__(self, served: Served) -> None:
        self.served = served
        headers = {"origin": served.address, "x-kerfwise-token": TOKEN}
        self._client = httpx.Client(base_url=served.address, headers=headers, timeout=LONG_S)
        self._tab = cache(self._opened)

    def planned(self, contours: int) -> Tab:
        tab = self._tab(contours)
        tab.state()
        tab.post("back", to=1)
        return tab

    def _opened(self, contours: int) -> Tab:
        path = self.served.server.folder.path / f"{contours}.json"
        path.write_text(json.dumps(make_sheet(1, contours)), encoding="utf-8")
        told = self._client.post("/api/open", json={"nest": path.name}).json()
        tab = Tab(self._client, told["id"], told["version"], path, LONG_S)
        tab.solved()
        return tab


@pytest.fixture(scope="module")
def plates(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Plates]:
    with serving(tmp_path_factory.mktemp("plates"), WORK) as served:
        yield Plates(served)


@pytest.mark.parametrize("wide", [1400, 390])
@pytest.mark.parametrize("contours", PAGES)
def test_a_plate(browser: Browser, plates: Plates, contours: int, wide: int) -> None:
    tab = plates.planned(contours)
    at = AtPage(browser, plates.served, wide, LONG_S)
    at.open(tab)
    assert len(at.order) >= 0.9 * contours
    assert at.page.locator("#orders .row").count() < 60
    hit_when_zoomed(at)
    by_keyboard(at)
    on_paper(at, contours)
    if contours > 100:
        scrolled_by_a_drag(at)
    if contours < 1000:  # half a minute of the processor each
        planned_again(at, tab)
    assert at.page.evaluate("document.documentElement.scrollWidth - innerWidth") <= 0
    at.close()
    assert at.wrong == []


def hit_when_zoomed(at: AtPage) -> None:
    """What is clicked or tapped is what is chosen, however near the view is."""
    for contour in (at.order[0], at.order[len(at.order) // 2], at.order[-1]):
        at.ask("[app.stages[0].fit(), app.chooseId(given[0]), app.set({ selected: -1 })]", contour)
        at.page.mouse.move(*at.entry(contour))
        for _ in range(3):
            at.page.mouse.wheel(0, -500)
        at.sharp()
        at.tap(*at.entry(contour))
        assert at.chosen == contour
    at.page.click("#fit")


def by_keyboard(at: AtPage) -> None:
    """Cuts are chosen, the view is moved, and panels are seen without a pointer."""
    keys = at.page.keyboard
    keys.press("Escape")
    keys.press("n")
    keys.press("n")
    assert at.chosen == at.order[1]
    scale = at.ask("app.stages[0].camera.scale")
    keys.press("+")
    assert at.ask("app.stages[0].camera.scale") > scale
    keys.press("0")
    at.panel("order")
    at.page.focus("#orders")
    keys.press("End")
    assert at.chosen == at.order[-1]
    keys.press("Home")
    assert at.chosen == at.order[0]
    for _ in range(12):
        keys.press(".")
        if at.ask("app.state.tab") == "plans":
            break
    assert at.page.locator("#hands-plans li.shown").is_visible()


def on_paper(at: AtPage, contours: int) -> None:
    """A work sheet with every cut in it."""
    paper = pypdfium2.PdfDocument(io.BytesIO(at.page.pdf(prefer_css_page_size=True)))
    assert len(paper) == PAGES[contours]
    text = "".join("".join(page.get_textpage().get_text_range() for page in paper).split())  # letters stand in lines
    assert [contour for contour in at.order if contour not in text] == []


def scrolled_by_a_drag(at: AtPage) -> None:
    """A row that is held at the end of the list goes to cuts that were not seen."""
    at.panel("order")
    list_box = at.page.locator("#orders").bounding_box()
    assert list_box is not None
    x, y = at.row(at.order[0])
    at.drag([(x, y), (x, list_box["y"] + list_box["height"] - 4)])
    at.until("document.getElementById('orders').scrollTop > 800")
    # What is said is of a place that was passed, until a question was answered before the list has gone on.
    number = "Number(document.getElementById('hands-verdict').textContent.split('as number ')[1]?.split(':')[0])"
    at.until(f"{number} > given[0]", 800 / ROW_PX)
    at.page.keyboard.press("Escape")
    at.let_go()
    at.ask("document.getElementById('orders').scrollTop = 0")


def planned_again(at: AtPage, tab: Tab) -> None:
    """A row is dragged to another place: the lock is there, and the next plan goes by it."""
    at.panel("order")
    row = swapped(at, tab)
    at.ask("document.getElementById('orders').scrollTop = given[0]", ROW_PX * (row - 3))  # not where the list scrolls
    contour, over, plans = at.order[row], at.order[row + 1], at.plans
    said = at.drag_row(contour, over)
    assert f" as number {row + 2}" in said
    at.let_go()
    at.page.wait_for_selector("#hands-cancel", state="visible")
    state = tab.wait()
    assert len(state["alternatives"]) == plans + 1, state["conflict"] or state["problem"]
    at.planned(plans + 1)
    assert at.order[row + 1] == contour
    assert f"{contour} position {row + 2}" in tab.state()["locked"]


def swapped(at: AtPage, tab: Tab) -> int:
    """The first row that is dragged alone and may change places with the next; else one that a lock may move there."""
    order, gives_way = at.order, -1
    for row in range(1, len(order) - 1):
        if order[row].endswith(".outer") and order[row - 1].split(".")[0] == order[row].split(".")[0]:
            continue  # it takes its holes with it
        told = tab.get("move", contours=order[row], place=row + 2)
        if told["lawful"]:
            return row
        if gives_way < 0 and told["gives_way"]:
            gives_way = row
    return gives_way
