"""Parts of a nest are changed on the page: dragged with the gap shown, turned, left out, fixed, undone, written."""

from __future__ import annotations

import json

import pytest

from kerfwise import read_nest
from kerfwise.tests.apps.viewer.serve.at_page import AtPage
from kerfwise.tests.apps.viewer.serve.conftest import Look
from kerfwise.tests.apps.viewer.serve.served import Open, Tab
from kerfwise.tests.tools.amount import few

pytestmark = [pytest.mark.slow, pytest.mark.browser]

WIDTHS = pytest.mark.parametrize("wide", few([1400, 1024, 390]))


def shown(look: Look, tab: Tab, wide: int) -> AtPage:
    at = look(tab, wide)
    with at.page.expect_response("**/room") as room:
        at.page.click("#tab-parts")
    room.value.finished()  # the page knows what is cut already
    at.until("document.body.classList.contains('editing-parts')")
    at.frames()
    return at


def dragged(at: AtPage, part: str, dx: float, dy: float) -> str:
    """Drag a part so far, mm; what is said before it is let go."""
    x, y = at.inside(part)
    there = at.ask("given[0] * app.stages[0].camera.scale", dx), at.ask("given[0] * app.stages[0].camera.scale", dy)
    at.drag([(x + 2, y), (x + 2 + there[0], y - there[1])])
    at.frames()  # the last move may be told with the next frame only
    return str(at.page.locator("#parts-said").inner_text())


@WIDTHS
def test_a_part_is_dragged_turned_left_out_undone_and_written(look: Look, opened: Open, wide: int) -> None:
    tab = opened()
    at = shown(look, tab, wide)
    assert "collides with A" in dragged(at, "B.outer", -40, 0)
    at.let_go()
    at.page.keyboard.press("Control+z")
    at.until("document.querySelectorAll('#parts-changes li').length === 0")
    assert "would lie over the sheet's edge" in dragged(at, "B.outer", 0, -40)
    at.let_go()
    at.page.keyboard.press("Control+z")
    at.until("document.querySelectorAll('#parts-changes li').length === 0")
    dragged(at, "B.outer", -40, 0)
    at.let_go()
    at.page.wait_for_selector("#parts-said.bad:has-text('overlaps')")
    assert at.page.locator("#parts-write").is_disabled()
    at.page.keyboard.press("Control+z")
    at.until("document.querySelectorAll('#parts-changes li').length === 0")
    said = dragged(at, "B.outer", -10, 0)
    assert said.startswith(("✓", "10", "20")), said
    at.let_go()
    at.page.wait_for_selector("#parts-said.good")
    moved = at.page.locator("#parts-changes li").inner_text()
    assert moved.startswith("move B -")
    at.page.click("#parts-left")
    at.page.wait_for_selector("#parts-said.good")
    at.ask("app.chooseId('C.outer')")
    at.page.click("#parts-drop")
    at.page.wait_for_selector("#parts-said.good:has-text('2 parts')")
    at.page.click("#parts-undo")
    at.page.wait_for_selector("#parts-said.good:has-text('3 parts')")
    at.page.click("#parts-redo")
    at.page.wait_for_selector("#parts-said.good:has-text('2 parts')")
    before = at.page.url
    at.page.click("#parts-write")
    at.page.wait_for_url(lambda url: url != before)
    at.page.wait_for_selector("[data-ready=yes]", state="attached")
    at.until("app.data.nest.parts.length === 2")
    made = read_nest(tab.nest.with_name("small-2.json"))
    assert [part.id for part in made.parts] == ["A", "B"]
    x0, *_ = made.parts[1].outer.polygon.bounds
    assert x0 == pytest.approx(130 + float(moved.split()[2]), abs=1e-6)
    assert json.loads(tab.nest.read_text())["parts"][1]["outer"][0] == [130, 20], "the old nest stays"


@pytest.mark.full
def test_a_fixed_part_stays_where_others_are_laid_anew(look: Look, opened: Open) -> None:
    at = shown(look, opened(), 1400)
    at.ask("app.chooseId('B.outer')")
    at.page.check("#parts-fix")
    dragged(at, "B.outer", 20, 0)
    at.let_go()
    assert "B is fixed" in at.page.locator("#parts-said").inner_text()
    at.page.click("#parts-anew")
    at.page.wait_for_selector("#parts-said.good")
    assert at.page.locator("#parts-changes").inner_text().strip() == "nest-anew B"


@pytest.mark.full
def test_the_keyboard_moves_turns_and_drops(look: Look, opened: Open) -> None:
    at = shown(look, opened(), 1400)
    at.ask("app.chooseId('C.outer')")
    at.page.focus("#stages canvas")
    for key in ("ArrowRight", "Shift+ArrowUp", "r", "m", "Delete"):
        at.page.keyboard.press(key)
    at.until("document.querySelectorAll('#parts-changes li').length === 5")
    assert at.page.locator("#parts-changes li").all_inner_texts() == [
        "move C 1 0", "move C 0 10", "turn C 90", "mirror C", "drop C",
    ]  # fmt: skip
    at.page.wait_for_selector("#parts-said.good:has-text('2 parts')")


def test_what_is_cut_already_stays(look: Look, planned: Tab) -> None:
    planned.post("cut", upto=3)
    at = shown(look, planned, 1400)
    at.until("document.querySelector('#parts-said') && app.state.tab === 'parts'")
    dragged(at, "B.outer", 5, 0)
    at.let_go()
    assert "B is cut already" in at.page.locator("#parts-said").inner_text()


def test_the_gap_that_the_page_shows_is_that_of_the_server(opened: Open) -> None:
    """What a drop is refused for says the same distance; the page's geometry is tried in Node.js, too."""
    tab = opened()
    assert tab.get("room") == {"gap_mm": 7.5, "edge_mm": 10.0, "cut": []}
    told = tab.post("nest", 422, changes=["move B -25 0"])
    assert told["details"] == ["A lies 5.0 mm from B: 7.5 mm are kept"]
    told = tab.post("nest", changes=["move B -20 0"])
    assert told["drawing"]["parts"] == told["parts"] == ["A", "B", "C"]
