"""The page with hands in a browser: a row is dragged, the verdict read, the plan made again, undone and saved."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
from playwright.sync_api import Browser, Page, sync_playwright

from kerfwise.tests.serving.conftest import SMALL, TOKEN, Open, Served, Tab
from kerfwise.tests.tools.browser import chromium

pytestmark = pytest.mark.slow

WAIT_MS = 120_000
BAD = ("error", "warning")
"""Kinds of what a console says; that the server has refused something, 422, is told by the browser itself."""
SIZES = pytest.mark.parametrize("size", [(1400, 900), (390, 844)], ids=["desk", "phone"])


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with sync_playwright() as play:
        made = play.chromium.launch(executable_path=chromium(), args=["--no-sandbox"])
        yield made
        made.close()


@pytest.fixture
def page(browser: Browser, served: Served) -> Iterator[Page]:
    """A tab that has the token; nothing may be wrong in it, and nothing asked of anybody else."""
    wrong: list[str] = []
    tab = browser.new_page()
    tab.set_default_timeout(WAIT_MS)
    tab.on("console", lambda told: wrong.append(told.text) if told.type in BAD and "422" not in told.text else None)
    tab.on("pageerror", lambda error: wrong.append(str(error)))
    own = (served.address, "data:", "blob:")
    tab.on("request", lambda asked: None if asked.url.startswith(own) else wrong.append(asked.url))
    tab.goto(f"{served.address}/?token={TOKEN}")
    yield tab
    tab.close()
    assert wrong == []


def shown(page: Page, served: Served, tab: Tab, size: tuple[int, int] = (1400, 900)) -> None:
    page.set_viewport_size({"width": size[0], "height": size[1]})
    page.goto(f"{served.address}/nest/{tab.id}")
    page.wait_for_selector("[data-ready=yes]", state="attached")


def drag(page: Page, start: str, to: str) -> str:
    """Drag from one place of the page to another; what the verdict says before it is dropped."""
    first, last = page.locator(start).bounding_box(), page.locator(to).bounding_box()
    assert first is not None
    assert last is not None
    page.mouse.move(first["x"] + 8, first["y"] + first["height"] / 2)
    page.mouse.down()
    page.mouse.move(last["x"] + 8, last["y"] + last["height"] / 2, steps=6)
    page.wait_for_selector("#hands-verdict.good, #hands-verdict.bad, #hands-verdict.gives")
    return page.locator("#hands-verdict").inner_text()


def order(page: Page) -> list[str]:
    return [str(row.get_attribute("data-contour")) for row in page.locator("#orders .row").all()]


@SIZES
def test_a_row_is_dragged_and_the_nest_planned_again(
    page: Page, served: Served, opened: Open, size: tuple[int, int]
) -> None:
    tab = opened()
    shown(page, served, tab, size)
    page.click("#hands-plan")
    page.wait_for_selector("#hands-plans li", state="attached")
    if size[0] < 500:
        page.click("#tab-order")
    page.wait_for_selector("[data-contour='C.outer']")
    assert order(page) == ["A.hole1", "A.outer", "B.outer", "C.outer"]
    said = drag(page, "[data-contour='C.outer'] .no", "[data-contour='B.outer'] .no")
    assert said.startswith("C.outer cannot be cut as number 3: level-ahead: B.outer is cut before C.outer")
    assert said.endswith("locked there, level-ahead gives way")
    assert tab.state()["locked"] == []
    page.mouse.up()
    page.wait_for_selector("#hands-plans li:nth-child(2)", state="attached")
    page.wait_for_selector("#row-2[data-contour='C.outer']")
    assert tab.state()["locked"] == ["C.outer position 3"]
    page.click("#hands-undo")
    page.wait_for_selector("#row-3[data-contour='C.outer']")
    assert tab.state()["locked"] == []
    page.click("#hands-save")
    page.wait_for_selector("#hands-said:has-text('saved small.nc')")
    assert tab.nest.with_name("small.nc").is_file()
    overflow = page.locator("body").evaluate("body => body.scrollWidth - innerWidth")
    assert overflow <= 0


def screen(page: Page, *points: tuple[float, float]) -> list[tuple[float, float]]:
    """Where points of the sheet are on the screen, as the drawing says of two of its own points."""
    box = page.locator("#stages canvas").bounding_box()
    assert box is not None
    probes = [(box["x"] + 60, box["y"] + 90), (box["x"] + 260, box["y"] + 290)]
    seen = []
    for x, y in probes:
        page.mouse.move(x, y)
        told = page.locator("#under").inner_text().split()
        seen.append((float(told[1]), float(told[3])))
    (ax, ay), (bx, by) = probes
    (sx, sy), (tx, ty) = seen
    return [(ax + (x - sx) * (bx - ax) / (tx - sx), ay + (y - sy) * (by - ay) / (ty - sy)) for x, y in points]


def test_a_part_is_dragged_onto_another_on_the_drawing(page: Page, served: Served, opened: Open) -> None:
    tab = opened()
    tab.solved()
    shown(page, served, tab)
    page.wait_for_selector("#row-3")
    start, to = screen(page, (280, 60), (170, 60))
    page.keyboard.down("Shift")
    page.mouse.move(*start)
    page.mouse.down()
    page.mouse.move(*to, steps=5)
    page.wait_for_selector("#hands-verdict.gives")
    assert page.locator("#hands-verdict").inner_text().startswith("C.outer cannot be cut as number 3: level-ahead")
    page.mouse.up()
    page.keyboard.up("Shift")
    page.wait_for_selector("#row-2[data-contour='C.outer']")
    assert tab.state()["locked"] == ["C.outer position 3"]


def test_locks_weights_and_a_conflict(page: Page, served: Served, opened: Open) -> None:
    tab = opened()
    tab.solved()
    shown(page, served, tab)
    page.click("#tab-locks")
    for line in ("A.outer first", "B.outer 2nd"):
        page.fill("#hands-lock-line", line)
        page.press("#hands-lock-line", "Enter")
        page.wait_for_selector(f"#hands-locks li:has-text('{line[:7]}')")
    page.click("#tab-rules")
    page.click("#hands-weights summary")
    page.locator("[aria-label='weight of heat-lag']").press("ArrowRight")
    page.wait_for_selector("#hands-weights output:has-text('100 mm')")
    page.click("#hands-plan")
    page.wait_for_selector("#hands-conflict .good")
    assert "A.hole1 is cut before A.outer" in page.locator("#hands-conflict").inner_text()
    assert tab.state()["settings"] == {"rules.heat-lag.weight": "100 mm"}
    page.click("#hands-conflict button:has-text('undo: A.outer first')")
    page.wait_for_selector("#hands-conflict", state="hidden")
    page.wait_for_selector("#hands-plans li:nth-child(2)", state="attached")
    assert tab.state()["locked"] == ["B.outer position 2"]


def test_another_tab_is_seen_at_once(page: Page, served: Served, opened: Open) -> None:
    tab = opened()
    shown(page, served, tab)
    page.click("#tab-locks")
    tab.edit({"lock": "C.outer last"})
    page.wait_for_selector("#hands-locks li:has-text('C.outer last')")
    tab.solved()
    page.wait_for_selector("#row-3[data-contour='C.outer']")


def test_a_nest_is_opened_from_the_list_and_by_dropping_it(
    page: Page, served: Served, client: httpx.Client, tmp_path: Path
) -> None:
    (served.server.folder.path / "listed.json").write_text(SMALL, encoding="utf-8", newline="\n")
    page.goto(f"{served.address}/?list")
    page.click("button:has-text('listed.json')")
    page.wait_for_url("**/nest/*")
    page.goto(f"{served.address}/?list")
    page.wait_for_selector("h1")
    for text, name in ((SMALL.replace("130, 20], [210", "90, 20], [210"), "broken.json"), (SMALL, "dropped.json")):
        data = page.evaluate_handle(
            "([text, name]) => { const all = new DataTransfer(); all.items.add(new File([text], name)); return all; }",
            [text, name],
        )
        page.dispatch_event("main", "drop", {"dataTransfer": data})
        if name == "broken.json":
            page.wait_for_selector("section li")
            assert page.locator("section canvas").count() == 1
    page.wait_for_url("**/nest/*")
