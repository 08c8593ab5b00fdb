"""The interactive viewer in a browser, by mouse and by touch: every gesture on a small nest."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from playwright.sync_api import Route

from kerfwise.tests.apps.viewer.serve.conftest import FIRST, MOUSE_FIRST, TOUCH_FIRST, WIDTHS, Look
from kerfwise.tests.apps.viewer.serve.served import Open, Served, Tab

pytestmark = [pytest.mark.slow, pytest.mark.browser]


STEP_PX = 6
"""How far an arrow key slides a tab."""
TABS = "based_on: laser-st10kp-2mm\nrules:\n  hold-small-parts: {strength: hard, tabs: nest, width: 0.5 mm}\n"


@WIDTHS
def test_a_row_is_dragged_and_the_nest_planned_again(look: Look, opened: Open, wide: int) -> None:
    tab = opened()
    at = look(tab, wide)
    at.plan()
    at.panel("order")
    assert at.order == FIRST
    said = at.drag_row("C.outer", "B.outer")
    assert "A rule gives way: level-ahead" in said
    assert "C.outer as number 3, against level-ahead: B.outer is cut before C.outer" in said
    assert at.page.locator("#hands-verdict.warn").is_visible()
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


@TOUCH_FIRST
def test_a_drag_is_given_up_with_escape(look: Look, planned: Tab, wide: int) -> None:
    """A page that begins with a plan has grips: they are what a finger drags a row by."""
    at = look(planned, wide)
    rows = "[...document.querySelectorAll('#orders .row')]"
    assert at.ask(f"{rows}.map(row => row.querySelectorAll('.grip').length)") == [1] * len(FIRST)
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


def test_a_drag_is_given_up_where_the_button_was_let_go_unseen(look: Look, planned: Tab) -> None:
    """Over another window, say: the pointer comes back with no button pressed."""
    at = look(planned)
    back = """(() => { const { left, top } = document.querySelector(given[0]).getBoundingClientRect();
      document.querySelector(given[0]).dispatchEvent(new PointerEvent("pointermove", {
        bubbles: true, pointerId: 1, pointerType: "mouse", buttons: 0, clientX: left + 9, clientY: top + 9 })); })()"""
    for drag, over in ((at.drag_row, "#orders"), (at.drag_part, "#stages canvas")):
        drag("C.outer", "B.outer")
        at.ask(back, over)
        at.page.wait_for_selector("#hands-verdict", state="hidden")
        at.let_go()
    assert at.page.locator(".drop-line").is_hidden()
    assert (at.plans, planned.state()["locked"], planned.state()["solving"]) == (1, [], None)


def test_a_drop_into_a_plan_that_another_tab_has_replaced_locks_nothing(look: Look, planned: Tab) -> None:
    at = look(planned)
    asked: list[Route] = []
    at.drag_row("C.outer", "B.outer")
    at.page.route("**/move?*", lambda route: asked.append(route))
    with at.page.expect_request("**/move?*look=0*"):
        at.let_go()
    planned.edit({"lock": "B.outer first"})
    planned.solved()
    at.planned(2)
    for route in asked:
        route.continue_()
    at.page.wait_for_selector("#hands-said:has-text('another plan is shown by now')")
    assert (at.plans, planned.state()["locked"]) == (2, ["B.outer first"])


@TOUCH_FIRST
def test_a_part_is_dragged_onto_another_on_the_drawing(look: Look, planned: Tab, wide: int) -> None:
    at = look(planned, wide)
    before = at.ask("[app.stages[0].camera.x, app.stages[0].camera.y]")
    said = at.drag_part("C.outer", "B.outer")
    assert "C.outer as number 3, against level-ahead" in said
    assert at.ask("[app.stages[0].camera.x, app.stages[0].camera.y]") == before  # the view stays
    at.let_go()
    at.planned(2)
    assert planned.state()["locked"] == ["C.outer position 3"]
    scale = at.ask("app.stages[0].camera.scale")
    x, y = at.inside("B.outer")
    at.drag([(x, y), (x + 40, y + 30)])  # without Shift, without staying: the view moves
    at.let_go()
    assert at.ask("[app.stages[0].camera.x, app.stages[0].camera.y]") != before
    assert at.page.locator("#hands-verdict").is_hidden()
    assert at.ask("app.stages[0].camera.scale") == pytest.approx(scale)  # one finger is one finger


@MOUSE_FIRST
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


@MOUSE_FIRST
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


@pytest.fixture
def tabbed(opened: Open, served: Served, tmp_path: Path) -> Tab:
    """The small nest with its first plan, by a profile in which parts are held by tabs."""
    folder = served.server.folder.path / tmp_path.name
    folder.mkdir()
    (folder / "tabs.yaml").write_text(TABS, encoding="utf-8")
    tab = opened(job="profile: tabs.yaml\n")
    tab.solved()
    return tab


@MOUSE_FIRST
def test_a_tab_is_drawn(look: Look, tabbed: Tab, tmp_path: Path, wide: int) -> None:
    tab = tabbed
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


def test_a_tab_is_drawn_by_the_keyboard(look: Look, tabbed: Tab) -> None:
    at = look(tabbed)
    at.choose("C.outer")
    keys = at.page.keyboard
    keys.press("T")
    keys.press("ArrowLeft")
    keys.press("ArrowRight")
    for _ in range(round(40 * at.ask("app.stages[0].camera.scale") / STEP_PX)):
        keys.press("ArrowRight")
    said = at.page.locator("#hands-said").inner_text()
    assert tabbed.state()["locked"] == []
    keys.press("Enter")
    at.planned(2)
    (lock,) = tabbed.state()["locked"]
    begun = at.ask("[...app.stages[0].scenery.outlines.points(app.numberOf('C.outer'), 0).slice(0, 2)]")
    x, y = (float(word.strip("(),")) for word in lock.split()[2:])
    assert math.dist((x, y), begun) == pytest.approx(40, abs=2)
    assert any(abs(x - side) < 0.01 for side in (240, 320)) or any(abs(y - side) < 0.01 for side in (20, 100))
    assert said == f"a tab at ({x:.1f}, {y:.1f})"
