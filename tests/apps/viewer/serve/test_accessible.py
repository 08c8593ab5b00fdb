"""axe finds nothing on any state of the viewer, and what is disabled, refused or unsure looks so."""

from __future__ import annotations

import json
from itertools import product

import pytest

from kerfwise.tests.apps.viewer.serve.at_page import AtPage, drop
from kerfwise.tests.apps.viewer.serve.conftest import Look
from kerfwise.tests.apps.viewer.serve.served import Open, Served, Tab
from kerfwise.tests.tools.amount import few
from kerfwise.tests.tools.axe import findings

pytestmark = [pytest.mark.slow, pytest.mark.browser]

CUT_OFF = """['verdict', 'proof'].filter(id => {
  const chip = document.getElementById(id), { left, right, top, bottom } = chip.getBoundingClientRect();
  const at = share => document.elementFromPoint(left + share * (right - left), (top + bottom) / 2);
  const mine = [0.05, 0.5, 0.95].every(share => at(share) === chip);
  return !mine || left < 0 || top < 0 || right > innerWidth || chip.scrollWidth > chip.clientWidth + 1;
})"""
"""Those of the two chips that are not seen whole."""
PRIMARY = "[...document.querySelectorAll('button.primary')].filter(one => one.offsetParent).map(one => one.id)"
SCHEMES = pytest.mark.parametrize("scheme", few(["light", "dark"]))


@SCHEMES
@pytest.mark.parametrize("wide", few([1400, 1024, 390]))
def test_axe_finds_nothing_in_any_panel(look: Look, planned: Tab, served: Served, wide: int, scheme: str) -> None:
    planned.edit({"lock": "C.outer first"})
    plans = planned.solved()["alternatives"]
    compare = f"[aria-label='compare plan {plans[0]['number']} with plan {plans[-1]['number']}']"
    at = look(planned, wide)
    at.page.emulate_media(color_scheme="dark" if scheme == "dark" else "light")
    at.ask("app.choose(0)")
    found = {}
    for tab in at.page.locator("#tabs [role=tab]:visible").all():
        tab.click()
        at.page.wait_for_timeout(150)
        found[tab.inner_text()] = findings(at.page)
    at.panel("plans")
    at.page.click(compare)
    at.page.wait_for_selector("figure[data-side='1']")
    found["compared"] = findings(at.page)
    at.panel("plans")
    at.page.click(compare)
    at.panel("locks")
    at.page.fill("#hands-lock-line", "A.outer before A.hole1")
    at.page.press("#hands-lock-line", "Enter")
    at.page.wait_for_selector("#hands-locks li >> nth=1")
    found["not planned"] = findings(at.page)
    assert at.page.locator("#proof.stale").is_visible(), "no proof stands over another wish"
    at.page.click("#hands-plan")
    at.page.wait_for_selector("#hands-conflict p .said.good, #hands-conflict p .said.bad")
    found["conflict"] = findings(at.page)
    assert {state: said for state, said in found.items() if said} == {}


@SCHEMES
def test_axe_finds_nothing_while_it_is_planned(look: Look, planned: Tab, served: Served, scheme: str) -> None:
    at = look(planned)
    at.page.emulate_media(color_scheme="dark" if scheme == "dark" else "light")
    with served.planner_taken():
        planned.edit({"lock": "C.outer first"})
        planned.post("solve", 202)
        at.page.wait_for_selector("#hands-cancel:visible")
        assert findings(at.page) == []
        at.page.click("#hands-cancel")


@pytest.mark.parametrize("wide", few([390, 1024, 1400]))
def test_verdict_and_proof_are_whole_and_one_action_stands_out(look: Look, planned: Tab, wide: int) -> None:
    at = look(planned, wide)
    for kind, status, share in product(("kept", "kept but for", "broken"), ("optimal", "feasible"), (None, 0.123)):
        figures = {"status": status, "gap": 0.123, "light_gap": share}
        at.ask(
            "app.judged({ ...app.side, state: { ...app.side.state, kind: given[0], count: 12 },"
            " figures: { ...app.side.figures, ...given[1] } })",
            kind,
            figures,
        )
        assert at.ask(CUT_OFF) == [], (kind, figures)
    at.page.reload()
    at.page.wait_for_selector("[data-ready=yes]", state="attached")
    assert at.ask(PRIMARY) == ["hands-save"]
    planned.edit({"lock": "C.outer first"})
    at.page.wait_for_selector("#hands-plan.primary")
    assert at.ask(PRIMARY) == ["hands-plan"]
    assert at.ask(CUT_OFF) == []
    at.page.click("#hands-undo")
    at.page.wait_for_selector("#hands-undo:disabled")
    looks = (
        "(({ borderStyle, cursor }) => [borderStyle, cursor])(getComputedStyle(document.getElementById('hands-undo')))"
    )
    assert at.ask(looks) == ["dashed", "not-allowed"]


@pytest.mark.parametrize("wide", few([1400, 1024, 390]))
def test_the_list_of_nests(look: Look, opened: Open, served: Served, wide: int) -> None:
    """Pictures, states, a filter, the order of people; a drawing that is refused says why; axe finds nothing."""
    planned = opened(name="row 10.json")
    planned.solved()
    opened(name="row 2.json")
    at = look(wide=wide)
    at.page.goto(f"{served.address}/?list")
    folder = planned.nest.parent.name
    at.page.fill("#filter", f"{folder}/row")
    at.page.wait_for_selector("#nests li >> nth=1")
    at.until(
        "document.querySelectorAll('#nests li').length === 2 && document.querySelectorAll('#nests img').length === 2"
    )
    names = at.page.locator("#nests button").all()
    assert [one.get_attribute("aria-label") for one in names] == [f"{folder}/row 2.json", f"{folder}/row 10.json"]
    chips = at.page.locator("#nests .chip").all_inner_texts()
    assert chips == ["not planned", "✓ planned, every hard rule holds"] or [one.strip("✓ ") for one in chips] == [
        "not planned", "planned, every hard rule holds",
    ]  # fmt: skip
    assert "kB" in at.page.locator("#nests .facts").first.inner_text()
    assert findings(at.page) == []
    assert at.page.evaluate("document.documentElement.scrollWidth - innerWidth") <= 0
    at.page.set_input_files("#file", {"name": "no nest.json", "mimeType": "application/json", "buffer": b"{}"})
    at.page.wait_for_selector("#said.bad[role=alert]")
    assert findings(at.page) == []
    at.wrong.clear()


@pytest.mark.full
def test_a_drawing_that_is_broken_or_asks(look: Look, served: Served) -> None:
    at = look()
    at.page.goto(f"{served.address}/?list")
    parts = [
        {"id": "A", "outer": [[20, 20], [100, 20], [100, 100], [20, 100]]},
        {"id": "B", "outer": [[60, 60], [140, 60], [140, 110], [60, 110]]},
    ]
    text = json.dumps({"format": "kerfwise-nest/1", "sheet": {"width": 400, "height": 120}, "parts": parts})
    at.page.wait_for_selector("#more", state="attached")
    drop(at.page, "overlap of two.json", text)
    at.page.wait_for_selector("#broken canvas")
    assert findings(at.page) == []
    at.wrong.clear()


def refusal(at: AtPage) -> str:
    return str(at.page.locator("#hands-said.warn").inner_text())


def test_a_drag_that_is_not_taken_says_why_and_a_lock_what_gives_way_to_it(look: Look, planned: Tab) -> None:
    at = look(planned)
    planned.edit({"lock": "C.outer last"})
    at.page.wait_for_selector("#hands-locks li", state="attached")
    at.drag([at.row("C.outer"), at.row("B.outer")])
    at.let_go()
    assert "not planned yet" in refusal(at)
    at.page.keyboard.down("Shift")
    at.drag([at.inside("C.outer"), at.inside("B.outer")])
    at.let_go()
    at.page.keyboard.up("Shift")
    assert "not planned yet" in refusal(at)
    at.panel("locks")
    at.page.fill("#hands-lock-line", "C.outer first")
    at.page.press("#hands-lock-line", "Enter")
    at.page.wait_for_selector("#hands-locks li:has-text('C.outer first')")
    assert "takes the place of the lock: C.outer last" in refusal(at)


def test_what_a_drop_comes_to_is_told_apart(planned: Tab) -> None:
    """It goes there, a rule gives way, it will not go there: each of the small nest's moves."""
    how = {
        (name, place): planned.get("move", contours=name, place=place, look=0)["how"]
        for name in ("A.hole1", "A.outer", "B.outer", "C.outer")
        for place in range(1, 5)
    }
    assert how["A.outer", 1] == "no"
    assert how["C.outer", 4] == "goes"
    assert how["C.outer", 3] == "gives way"
    assert set(how.values()) <= {"goes", "gives way", "others move", "no"}


@pytest.mark.full
def test_a_message_goes_with_the_plan_that_it_is_about(look: Look, planned: Tab) -> None:
    planned.edit({"lock": "C.outer first"})
    at = look(planned)
    at.page.click("#hands-plan")
    at.planned(2)
    at.page.wait_for_selector("#hands-said.good:has-text('plan 2')")
    at.panel("plans")
    at.page.locator("#hands-plans li").first.locator("button").first.click()
    at.until("document.querySelector('#hands-plans .shown').value === 1")
    at.until("document.getElementById('hands-said').textContent === ''")
