"""The page with hands in a browser, by mouse and by touch: every gesture on a small nest."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from pathlib import Path

import httpx
import pytest
from playwright.sync_api import Browser

from kerfwise.tests.serving.at_page import AtPage, drop
from kerfwise.tests.serving.conftest import SMALL, Open, Served, Tab

pytestmark = [pytest.mark.slow, pytest.mark.browser]

Look = Callable[..., AtPage]
WIDTHS = pytest.mark.parametrize("wide", [1400, 390])
FIRST = ["A.hole1", "A.outer", "B.outer", "C.outer"]
TABS = "based_on: laser-st10kp-2mm\nrules:\n  hold-small-parts: {strength: hard, tabs: nest, width: 0.5 mm}\n"


@pytest.fixture
def look(browser: Browser, served: Served) -> Iterator[Look]:
    """Opens a nest's page; at the end nothing may be wrong in it, and nothing asked of anybody else."""
    opened: list[AtPage] = []

    def looks(tab: Tab | None = None, wide: int = 1400) -> AtPage:
        at = AtPage(browser, served, wide)
        opened.append(at)
        if tab is not None:
            at.open(tab)
        return at

    yield looks
    for at in opened:
        at.close()
    assert [at.wrong for at in opened] == [[] for _ in opened]


@pytest.fixture
def planned(opened: Open) -> Tab:
    """The small nest with its first plan."""
    tab = opened()
    tab.solved()
    return tab


@WIDTHS
def test_a_row_is_dragged_and_the_nest_planned_again(look: Look, opened: Open, wide: int) -> None:
    tab = opened()
    at = look(tab, wide)
    at.plan()
    at.panel("order")
    assert at.order == FIRST
    said = at.drag_row("C.outer", "B.outer")
    assert said.startswith("C.outer cannot be cut as number 3: level-ahead: B.outer is cut before C.outer")
    assert said.endswith("locked there, level-ahead gives way")
    assert at.page.locator(".drop-line").is_visible()
    assert tab.state()["locked"] == []
    at.let_go()
    at.planned(2)
    assert at.order == ["A.hole1", "A.outer", "C.outer", "B.outer"]
    assert (at.chosen, tab.state()["locked"]) == ("", ["C.outer position 3"])
    at.page.click("#hands-undo")
    at.until("app.data.nest.contours[app.side.cuts[3].contour].id === 'C.outer'")
    assert tab.state()["locked"] == []
    at.page.click("#hands-save")
    at.page.wait_for_selector("#hands-said:has-text('saved small.nc')")
    assert tab.nest.with_name("small.nc").is_file()
    assert at.page.evaluate("document.documentElement.scrollWidth - innerWidth") <= 0


@WIDTHS
def test_a_drag_is_given_up_with_escape(look: Look, planned: Tab, wide: int) -> None:
    at = look(planned, wide)
    at.panel("order")
    at.drag_row("C.outer", "B.outer")
    at.page.keyboard.press("Escape")
    at.page.wait_for_selector("#hands-verdict", state="hidden")
    at.let_go()
    at.drag_part("C.outer", "B.outer")
    at.page.keyboard.press("Escape")
    at.page.wait_for_selector("#hands-verdict", state="hidden")
    at.let_go()
    at.page.wait_for_timeout(100)
    assert (at.plans, planned.state()["locked"]) == (1, [])


@WIDTHS
def test_a_part_is_dragged_onto_another_on_the_drawing(look: Look, planned: Tab, wide: int) -> None:
    at = look(planned, wide)
    before = at.ask("[app.stages[0].camera.x, app.stages[0].camera.y]")
    said = at.drag_part("C.outer", "B.outer")
    assert said.startswith("C.outer cannot be cut as number 3: level-ahead")
    assert at.ask("[app.stages[0].camera.x, app.stages[0].camera.y]") == before  # the view stays
    at.let_go()
    at.planned(2)
    assert planned.state()["locked"] == ["C.outer position 3"]
    x, y = at.inside("B.outer")
    at.drag([(x, y), (x + 40, y + 30)])  # without Shift, without staying: the view moves
    at.let_go()
    assert at.ask("[app.stages[0].camera.x, app.stages[0].camera.y]") != before
    assert at.page.locator("#hands-verdict").is_hidden()


def test_two_fingers_zoom_after_a_part_was_dragged(look: Look, planned: Tab) -> None:
    at = look(planned, 390)
    at.drag_part("C.outer", "B.outer")
    at.let_go()
    at.planned(2)
    scale = at.ask("app.stages[0].camera.scale")
    x, y = at.inside("B.outer")
    at.drag([(x, y), (x + 30, y)])
    at.let_go()
    assert at.ask("app.stages[0].camera.scale") == pytest.approx(scale)  # one finger is one finger


@WIDTHS
def test_buttons_of_the_chosen_contour(look: Look, planned: Tab, wide: int) -> None:
    at = look(planned, wide)
    for contour, title, lock in (
        ("C.outer", "start here", "C first"),
        ("B.outer", "end here", "B last"),
        ("A.outer", "pin as 3", "A.outer position 3"),
        ("C.outer", "no link", "no link C.outer"),
    ):
        plans = at.plans
        at.choose(contour)
        at.press(title)
        at.planned(plans + 1)
        assert lock in planned.state()["locked"]
    assert at.order == ["C.outer", "A.hole1", "A.outer", "B.outer"]
    at.choose("A.outer")
    at.press("unlock: A.outer position 3")
    at.planned(6)
    at.choose("A.outer")
    way = at.ask("app.side.cuts[app.cutOf(app.state.selected)].direction")
    at.press("pin the entry")
    at.planned(7)
    assert any(lock.startswith("A.outer entry (") for lock in planned.state()["locked"])
    at.choose("B.outer")
    at.press("other way round")
    at.page.wait_for_selector("#hands-plans li:nth-child(8), #hands-conflict .said", state="attached")
    assert f"B.outer {'ccw' if way == 'cw' else 'cw'}" in planned.state()["locked"]


@WIDTHS
def test_cut_up_to_here(look: Look, planned: Tab, wide: int) -> None:
    at = look(planned, wide)
    at.choose("A.outer")
    at.press("cut up to here (2)")
    at.page.wait_for_selector("#hands-reached:has-text('cuts 1 to 2 are made')")
    at.plan()
    assert at.order == ["B.outer", "C.outer"]
    at.choose("C.outer")
    at.press("nothing is cut yet")
    at.plan()
    assert at.order == FIRST


@WIDTHS
def test_a_tab_is_drawn(look: Look, opened: Open, served: Served, tmp_path: Path, wide: int) -> None:
    folder = served.server.folder.path / tmp_path.name
    folder.mkdir()
    (folder / "tabs.yaml").write_text(TABS, encoding="utf-8")
    tab = opened(job="profile: tabs.yaml\n")
    tab.solved()
    at = look(tab, wide)
    at.choose("B.outer")
    at.press("draw a tab")
    off = 12 / at.ask("app.stages[0].camera.scale")
    at.drag([at.at(150, 100 + off), at.at(180, 100 + off)])  # beside the upper edge of B, and along it
    at.page.screenshot(path=tmp_path / "tab.png")
    assert tab.state()["locked"] == []
    at.let_go()
    at.planned(2)
    (lock,) = tab.state()["locked"]
    words = lock.replace("(", " ").replace(")", " ").replace(",", " ").split()
    assert words[:2] == ["B.outer", "tab"]
    assert (float(words[2]), float(words[3])) == pytest.approx((180, 100), abs=1.0)  # a pixel is more than half a mm
    tabs = at.ask("app.side.cuts[app.cutOf(app.numberOf('B.outer'))].tabs")
    assert [tuple(one[:2]) for one in tabs] == [pytest.approx((float(words[2]), float(words[3])), abs=0.5)]
    at.page.keyboard.press("T")  # on whatever outline is near
    at.page.keyboard.press("Escape")
    assert at.page.locator("#hands-said").inner_text() == "no tab is drawn"
    at.tap(*at.inside("C.outer"))
    assert (at.chosen, tab.state()["locked"]) == ("C.outer", [lock])
    at.choose("B.outer")
    at.press("no tab")
    at.planned(3)
    assert tab.state()["locked"] == ["no tab B.outer"]


@WIDTHS
def test_locks_in_words_weights_and_a_conflict(look: Look, planned: Tab, wide: int) -> None:
    at = look(planned, wide)
    page = at.page
    lock_in_words(at, "A.outer first", "B.outer 2nd")
    at.panel("rules")
    page.click("#hands-weights summary")
    page.locator("[aria-label='weight of heat-lag']").press("ArrowRight")
    page.wait_for_selector("#hands-weights output:has-text('100 mm')")
    page.click("#hands-plan")
    page.wait_for_selector("#hands-conflict .good")
    assert "A.hole1 is cut before A.outer" in page.locator("#hands-conflict").inner_text()
    assert planned.state()["settings"] == {"rules.heat-lag.weight": "100 mm"}
    page.wait_for_selector("#hands-conflict p:last-child .good")
    page.click("#hands-conflict button:has-text('relax')")
    at.planned(2)
    assert at.page.locator("#hands-plans li.shown small").inner_text()
    page.click("#hands-undo")
    page.wait_for_selector("#hands-plans li:nth-child(1).shown", state="attached")
    assert planned.state()["locked"] == []
    lock_in_words(at, "A.outer first", "B.outer 2nd")
    page.click("#hands-plan")
    page.wait_for_selector("#hands-conflict .good")
    page.click("#hands-conflict button:has-text('undo: A.outer first')")
    page.wait_for_selector("#hands-conflict", state="hidden")
    at.planned(3)
    assert planned.state()["locked"] == ["B.outer position 2"]


def lock_in_words(at: AtPage, *lines: str) -> None:
    at.panel("locks")
    for line in lines:
        at.page.fill("#hands-lock-line", line)
        at.page.press("#hands-lock-line", "Enter")
        at.page.wait_for_selector(f"#hands-locks li:has-text('{line[:7]}')")


@WIDTHS
def test_two_alternatives_under_one_cursor(look: Look, planned: Tab, wide: int) -> None:
    planned.edit({"lock": "C.outer first"})
    planned.solved()
    at = look(planned, wide)
    at.panel("plans")
    at.page.click("[aria-label='compare plan 1 with plan 2']")
    at.page.wait_for_selector("figure[data-side='1']")
    at.sharp()
    assert at.ask("app.data.sides.map(side => side.name)") == ["A: plan 2", "B: plan 1"]
    assert "differ" in at.page.locator("#compared-said").inner_text()
    at.tap(*at.inside("C.outer"))
    assert at.chosen == "C.outer"
    assert at.page.locator("#hands-chosen").is_hidden()  # which of the two would be locked?
    at.page.keyboard.press("s")
    at.panel("why")
    at.page.wait_for_selector("#why-said dd:has-text('4 of 4')")
    cross = at.inside("B.outer")
    at.page.mouse.move(*cross)
    assert at.ask("app.stages.map(stage => stage.cross)")[0] == at.ask("app.stages.map(stage => stage.cross)")[1]
    scales = at.ask("app.stages.map(stage => stage.camera.scale)")
    assert scales[0] == scales[1]
    wide_mm = at.ask("app.stages[0].toScreen(400, 0)[0] - app.stages[0].toScreen(0, 0)[0]")
    assert wide_mm <= at.ask("app.stages[0].size.wide")  # the whole sheet fits the half of the page
    at.panel("plans")
    at.page.click("[aria-label='compare plan 1 with plan 2']")
    at.page.wait_for_selector("figure[data-side='1']", state="detached")
    assert at.order[0] == "C.outer"
    at.page.click("[aria-label='compare plan 1 with plan 2']")
    at.page.wait_for_selector("figure[data-side='1']")
    at.panel("plans")
    at.page.click("#hands-plans li:nth-child(1) button >> nth=0")  # back to the first, and alone
    at.page.wait_for_selector("figure[data-side='1']", state="detached")
    at.until("app.data.nest.contours[app.side.cuts[3].contour].id === 'C.outer'")
    assert planned.state()["shown"] == 1


def test_planning_is_cancelled_and_another_nest_waits_for_it(look: Look, plate: Tab, planned: Tab) -> None:
    at, other = look(plate), look(planned)
    plate.post("solve", 202, work=200)
    at.page.wait_for_selector("#hands-cancel")
    other.page.click("#hands-plan")
    other.page.wait_for_selector("#hands-reached:has-text('plate.json is being planned')")
    other.panel("profile")
    other.page.click("[data-rule=level-ahead] summary")
    other.page.select_option("[aria-label='strength of level-ahead in the profile']", "off")
    other.page.wait_for_selector("#profile-effect:has-text('plate.json is being planned')")
    other.page.click("#profile-cancel")
    other.page.wait_for_selector("#profile-effect:has-text('cancelled')")
    at.page.wait_for_selector("#hands-reached:has-text(' m, ')")  # an incumbent, with bound and gap
    at.page.click("#hands-cancel")
    at.planned(1)
    other.planned(2)
    assert plate.state()["alternatives"][0]["ok"]


def test_keyboard_only(look: Look, planned: Tab) -> None:
    at = look(planned)
    keys = at.page.keyboard
    for _ in range(4):
        keys.press("n")
    assert at.chosen == "C.outer"
    keys.press("<")
    at.planned(2)
    assert (at.order[2], planned.state()["locked"]) == ("C.outer", ["C.outer position 3"])
    keys.press("u")
    at.until("app.data.nest.contours[app.side.cuts[3].contour].id === 'C.outer'")
    for name in ("hands-plan", "hands-save"):
        for _ in range(80):
            if at.page.evaluate("document.activeElement.id") == name:
                break
            keys.press("Tab")
        assert at.page.evaluate("document.activeElement.id") == name
    keys.press("Enter")
    at.page.wait_for_selector("#hands-said:has-text('saved small.nc')")
    keys.press("?")
    listed = at.page.locator("#keys-said").inner_text()
    for text in ("plan what is wanted", "draw a tab", "one place earlier", "back to the plan"):
        assert text in listed
    keys.press("Escape")
    for _ in range(20):
        if at.ask("app.state.tab") == "locks":
            break
        keys.press(".")
    assert at.page.locator("#panel-locks").is_visible()


def test_another_tab_is_seen_at_once(look: Look, opened: Open) -> None:
    tab = opened()
    at = look(tab)
    at.panel("locks")
    tab.edit({"lock": "C.outer last"})
    at.page.wait_for_selector("#hands-locks li:has-text('C.outer last')")
    tab.solved()
    at.page.wait_for_selector("#row-3[data-contour='C.outer']")


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


def test_a_killed_planner_is_said_and_the_next_plan_is_made(look: Look, plate: Tab, served: Served) -> None:
    at = look(plate)
    plate.post("solve", 202, work=200)
    at.page.wait_for_selector("#hands-reached:has-text(' m, ')")
    os.kill(served.server.planning.helper.pid or 0, 9)
    at.page.wait_for_selector("#hands-said:has-text('died (signal 9)')")
    plate.state()
    plate.post("solve", 202, work=0.1)
    at.planned(1)


def test_a_browser_that_was_closed_finds_its_plans_again(look: Look, opened: Open) -> None:
    tab = opened()
    at = look(tab)
    at.page.click("#hands-plan")
    at.context.close()
    tab.wait()
    again = look(tab)
    again.page.wait_for_selector("#row-3")
    assert (again.plans, again.order) == (1, FIRST)


EVIL = "<img src=x onerror='window.evil=1'>"


@WIDTHS
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
    page.goto(f"{served.address}/?list")
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
