"""Tabs of a browser: they share what is wanted, outlive a killed planner and a closed browser, show names as names."""

from __future__ import annotations

import os

import httpx
import pytest

from kerfwise.tests.apps.viewer.serve.at_page import drop
from kerfwise.tests.apps.viewer.serve.conftest import FIRST, MOUSE_FIRST, Look
from kerfwise.tests.apps.viewer.serve.served import SMALL, Open, Served, Tab

pytestmark = [pytest.mark.slow, pytest.mark.browser]


@pytest.mark.full
def test_eight_tabs_of_one_browser_live(look: Look, opened: Open, served: Served, planned: Tab) -> None:
    """A browser opens six connections to a server, and each of these tabs wants news for as long as it is there."""
    before = served.server.news.listeners
    first = look(planned)
    pages = [first.page, *(first.context.new_page() for _ in range(7))]
    for page in pages[1:]:
        page.set_default_timeout(60_000)
        page.goto(first.page.url)
        page.wait_for_selector("#row-3")
        page.click("#tab-locks")
    assert served.server.news.listeners == before + 1
    planned.edit({"lock": "C.outer last"})
    for page in pages:
        page.wait_for_selector("#hands-locks li:has-text('C.outer last')", state="attached")
    pages[0].close()  # the one that listened for all
    planned.edit({"unlock": "C.outer last"}, {"lock": "B.outer last"})
    for page in pages[1:]:
        page.wait_for_selector("#hands-locks li:has-text('B.outer last')", state="attached")
    pages[7].fill("#hands-lock-line", "A.outer cw")
    pages[7].press("#hands-lock-line", "Enter")
    pages[3].wait_for_selector("#hands-locks li:has-text('A.outer cw')")
    planned.state()
    planned.solved()
    pages[2].wait_for_selector("#row-3[data-contour='B.outer']")


@pytest.mark.full
def test_a_killed_planner_is_said_and_the_next_plan_is_made(look: Look, plate: Tab, served: Served) -> None:
    at = look(plate)
    plate.post("solve", 202, work=200)
    at.page.wait_for_selector("#hands-reached:has-text('; ')")
    pid = served.server.planning.helper.pid
    assert pid is not None  # 0 would be all of this run
    os.kill(pid, 9)
    at.page.wait_for_selector("#hands-said:has-text('died (signal 9)')")
    plate.state()
    plate.post("solve", 202, work=0.1)
    at.planned(1)


def test_a_browser_that_was_closed_finds_its_plans_again(look: Look, opened: Open) -> None:
    tab = opened()
    at = look(tab)
    at.page.click("#hands-plan")
    tab.wait(lambda state: state["solving"] is not None or bool(state["alternatives"]))  # the server has heard of it
    at.context.close()
    tab.wait()
    again = look(tab)
    again.page.wait_for_selector("#row-3")
    assert (again.plans, again.order) == (1, FIRST)


EVIL = "<img src=x onerror='window.evil=1'>"


@MOUSE_FIRST
def test_names_that_are_scripts_are_names(look: Look, opened: Open, wide: int) -> None:
    tab = opened(SMALL.replace('"B"', f'"{EVIL}"').replace('"C"', '"C & <b> C"'))
    at = look(tab, wide)
    at.plan()
    at.panel("order")
    assert "onerror" in at.drag_row(f"{EVIL}.outer", "A.outer").split("cannot")[0]
    at.let_go()
    at.planned(2)
    at.panel("locks")
    assert f"{EVIL}.outer" in at.page.locator("#hands-locks").inner_text()
    at.choose(f"{EVIL}.outer")
    assert EVIL in at.page.locator("#why-said").inner_text()
    at.choose("C & <b> C.outer")
    at.press("start here")
    at.planned(3)
    assert at.page.evaluate("window.evil") is None
    assert at.page.locator("img[src=x]").count() == 0


def test_a_nest_is_opened_from_the_list_and_by_dropping_it(look: Look, served: Served, client: httpx.Client) -> None:
    at = look()
    page = at.page
    (served.server.folder.path / "listed.json").write_text(SMALL, encoding="utf-8", newline="\n")
    (served.server.folder.path / os.fsdecode(b"Tr\xe4ger.json")).write_text(SMALL, encoding="utf-8")
    served.listed("listed.json", os.fsdecode(b"Tr\xe4ger.json"))
    page.goto(f"{served.address}/?list")
    page.wait_for_selector("p:has-text('Tr\\\\udce4ger.json')")
    page.click("button:has-text('listed.json')")
    page.wait_for_url("**/nest/*")
    page.goto(f"{served.address}/?list")
    page.wait_for_selector("h1")
    for text, name in ((SMALL.replace("130, 20], [210", "90, 20], [210"), "broken.json"), (SMALL, "dropped.json")):
        drop(page, name, text)
        if name == "broken.json":
            page.wait_for_selector("section li")
            assert page.locator("section canvas").count() == 1
    page.wait_for_url("**/nest/*")
