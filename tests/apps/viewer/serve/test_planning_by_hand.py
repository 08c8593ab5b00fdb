"""Planning in a browser: locks in words, weights, conflicts, alternatives under one cursor, keyboard alone."""

from __future__ import annotations

import pytest

from kerfwise.tests.apps.viewer.serve.at_page import AtPage
from kerfwise.tests.apps.viewer.serve.conftest import MOUSE_FIRST, Look
from kerfwise.tests.apps.viewer.serve.served import Tab

pytestmark = [pytest.mark.slow, pytest.mark.browser]


@MOUSE_FIRST
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
    page.wait_for_selector("#hands-plan:not(.primary)")  # it would find the same: a way out is to be taken
    page.click("#hands-conflict button:has-text('relax')")
    at.planned(2)
    at.page.wait_for_selector("#hands-plans li.shown .chip:has-text('kept')", state="attached")
    unkept = planned.state()["alternatives"][-1]["figures"]["unkept"]
    assert unkept == at.ask("app.side.state.count") == at.ask("app.side.rules.flatMap(one => one.excused).length")
    assert page.locator("#rules-said .kept-open .place").count() == unkept > 0
    assert str(page.locator("#hands-plans li.shown .chip").text_content()).startswith(f"{unkept} place")
    assert at.page.locator("#hands-plans li.shown small").inner_text()
    page.click("#hands-undo")
    page.wait_for_selector("#hands-plans li:nth-child(1).shown", state="attached")
    for _ in range(2):  # nobody waits for the answer to the first
        page.keyboard.press("Control+z")
    page.wait_for_selector("#hands-undo[disabled]")
    at.until("document.querySelectorAll('#hands-locks li').length === 0")
    assert planned.state()["locked"] == []
    page.click("#hands-redo")
    at.until("document.querySelectorAll('#hands-locks li').length === 1")
    page.keyboard.press("Control+z")
    page.wait_for_selector("#hands-undo[disabled]")
    at.until("document.querySelectorAll('#hands-locks li').length === 0")
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


@pytest.mark.full
@MOUSE_FIRST
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


@pytest.mark.full
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
    at.page.wait_for_selector("#hands-reached:has-text('; ')")  # a first plan, or a better one
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
    keys.press("Control+z")
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
    for text in ("plan what is wanted", "draw a tab", "one place earlier", "undo the last change"):
        assert text in listed
    keys.press("Escape")
    for _ in range(20):
        if at.ask("app.state.tab") == "locks":
            break
        keys.press(".")
    assert at.page.locator("#panel-locks").is_visible()
