"""The interactive viewer on made plates of 16 to 1,000 contours: gestures, re-plan, zoomed hits, keyboard, paper."""

from __future__ import annotations

import io
import json
import re
from collections.abc import Iterator
from functools import cache
from itertools import product

import pypdfium2
import pytest
from playwright.sync_api import Browser

from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.tests.apps.viewer.serve.at_page import AtPage
from kerfwise.tests.apps.viewer.serve.served import Served, Tab, browser_of, serving
from kerfwise.tests.tools.amount import rows

pytestmark = [pytest.mark.slow, pytest.mark.browser]

ROW_PX = 27
LONG_S = 180.0
"""A thousand contours take half a minute of the processor, which others may have."""
WORK = 0.05
"""Of a plan: nothing is proven by it, and what takes time is all the rest."""
JOB = "set:\n  rules.hold-small-parts.strength: hard\n  rules.hold-small-parts.tabs: nest\n"
"""Parts may be held by tabs where somebody draws them."""
LARGE_JOB = f"{JOB}  rules.zone-order: off\n"
"""Without zones the largest plate is planned in half the time."""
FIRST = {(16, 1400)}
"""The plate that is always seen, and how wide."""
PAGES = {16: 1, 41: 2, 115: 3, 308: 7, 1000: 22}
"""Pages of A4 with a drawing and a row a cut."""
SEEN = rows(sorted(product(PAGES, (1400, 1024, 390)), key=lambda plate: plate not in FIRST), len(FIRST))


class Plates:
    """Made plates on a server of their own, each planned once. Whoever asks for one is shown its first plan."""

    def __init__(self, served: Served) -> None:
        self.served = served
        self._client = browser_of(served.address, wait_s=LONG_S)
        self._tab = cache(self._opened)

    def planned(self, contours: int) -> Tab:
        tab = self._tab(contours)
        tab.post("back", to=first_plan(tab))
        return tab

    def _opened(self, contours: int) -> Tab:
        path = self.served.server.folder.path / f"{contours}.json"
        path.write_text(json.dumps(make_sheet(1, contours)), encoding="utf-8")
        path.with_suffix(".job.yaml").write_text(JOB if contours < 1000 else LARGE_JOB, encoding="utf-8")
        told = self._client.post("/api/open", json={"nest": path.name}).json()
        tab = Tab(self._client, told["id"], told["version"], path, LONG_S)
        tab.solved()
        return tab


def first_plan(tab: Tab) -> int:
    """Number of the first plan that is there still: one that was shown on the way gives way to the same as final."""
    return min(one["number"] for one in tab.state()["alternatives"])


@pytest.fixture(scope="module")
def plates(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Plates]:
    with serving(tmp_path_factory.mktemp("plates"), WORK) as served:
        yield Plates(served)


@pytest.mark.parametrize(("contours", "wide"), SEEN)
def test_a_plate(browser: Browser, plates: Plates, contours: int, wide: int) -> None:
    tab = plates.planned(contours)
    at = AtPage(browser, plates.served, wide, LONG_S)
    at.open(tab)
    assert len(at.order) >= 0.9 * contours
    assert at.page.locator("#orders .row").count() < 60
    hit_when_zoomed(at)
    by_keyboard(at)
    on_paper(at, contours)
    if contours > 40:
        scrolled_by_a_drag(at)
    with plates.served.planner_taken():
        every_lock(at, tab)
    a_conflict(at, tab, "undo" if wide > 500 else "relax")
    planned_again(at, tab)
    two_plans(at, tab)
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
    far_px = min(800, ROW_PX * len(at.order) - list_box["height"] - ROW_PX)
    at.until("document.getElementById('orders').scrollTop > given[0]", far_px)
    # What is said is of a place that was passed, until a question was answered before the list has gone on.
    number = "Number(document.getElementById('hands-verdict').textContent.match(/as number ([0-9]+)/)?.[1])"
    at.until(f"{number} > given[0]", far_px / ROW_PX)
    at.page.keyboard.press("Escape")
    at.let_go()
    at.ask("document.getElementById('orders').scrollTop = 0")


def every_lock(at: AtPage, tab: Tab) -> None:
    """Each gesture locks what it is about and asks for a plan, which waits here; it is cancelled and taken back."""
    at.panel("order")
    row = swapped(at, tab)
    contour = at.order[row]
    show_row(at, row)
    assert f" as number {row + 2}" in at.drag_row(contour, at.order[row + 1])
    at.let_go()
    taken_back(at, tab, f"{contour} position {row + 2}")

    part, over = two_parts(at)
    said = at.drag_part(part, over)
    place = re.search(r" as number (\d+)", said)
    assert place is not None, said
    at.let_go()
    to = int(place[1])
    names = [one for one in at.order if one.rpartition(".")[0] == part.rpartition(".")[0]]
    taken_back(at, tab, *(f"{name} position {k}" for k, name in enumerate(names, to)))

    at.choose(contour)
    pressed = {
        "start here": f"{contour.rpartition('.')[0]} first",
        f"pin as {row + 1}": f"{contour} position {row + 1}",
        "pin the entry": f"{contour} entry (",
        "other way round": f"{contour} c",
        "no link": f"no link {contour}",
    }
    for title, lock in pressed.items():
        at.press(title)
        at.page.wait_for_selector(f"#hands-locks li:has-text('{lock}')", state="attached")
    taken_back(at, tab, *list(pressed.values())[1:])  # the first gives way to the second

    at.choose(part)
    number = at.order.index(part) + 1
    at.press(f"cut up to here ({number})")
    at.page.wait_for_selector(f"#hands-reached:has-text('cuts 1 to {number} are made')")
    at.press("nothing is cut yet")
    at.until("document.getElementById('hands-reached').textContent === ''")

    at.choose(part)
    at.press("draw a tab")
    (x0, y0), (x1, y1) = at.entry(part), at.inside(part)
    at.drag([(x0, y0), (x0 + 0.1 * (x1 - x0), y0 + 0.1 * (y1 - y0))])
    at.let_go()
    taken_back(at, tab, f"{part} tab (")

    at.panel("rules")
    at.page.click("#hands-weights summary")
    at.page.locator("[aria-label='weight of heat-lag']").press("ArrowRight")
    at.page.wait_for_selector("#hands-plan.primary")
    assert "rules.heat-lag.weight" in tab.state()["settings"]
    at.page.click("#hands-undo")
    at.page.wait_for_selector("#hands-plan:not(.primary)")


def two_parts(at: AtPage) -> tuple[str, str]:
    """Outlines of two parts that are hit in their middle, seen from near: the view is moved there."""
    script = """(() => {
      const stage = app.stages[0], { contours } = app.data.nest, found = [];
      for (const { contour } of app.side.cuts) {
        const [x0, y0, x1, y1] = stage.scenery.outlines.bounds[contour];
        const hit = contours[stage.pick(...stage.toScreen((x0 + x1) / 2, (y0 + y1) / 2))];
        const { id, kind, part } = contours[contour];
        if (hit && kind === "outer" && hit.part === part) found.push(id);
      }
      return found; })()"""
    at.page.click("#fit")
    at.sharp()
    over, part = at.ask(script)[:2]
    return part, over


def show_row(at: AtPage, row: int) -> None:
    """Scroll the list so that a row is away from its ends, where a drag would scroll it on."""
    at.ask("document.getElementById('orders').scrollTop = given[0]", ROW_PX * (row - 3))


def taken_back(at: AtPage, tab: Tab, *locks: str) -> None:
    """What a gesture has locked waits to be planned; then it is cancelled, and all is as it was."""
    at.page.wait_for_selector("#hands-reached:has-text('another nest is being planned')")
    locked = tab.state()["locked"]
    assert [lock for lock in locks if not any(line.startswith(lock) for line in locked)] == [], locked
    at.page.click("#hands-cancel")
    at.page.wait_for_selector("#hands-cancel", state="hidden")
    listed = "document.getElementById('hands-locks').textContent"
    while tab.state()["locked"]:  # one gesture after the other
        before = at.ask(listed)
        at.page.click("#hands-undo")
        at.until(f"{listed} !== given[0]", before)
    at.page.wait_for_selector("#hands-plan:not(.primary)")
    assert (tab.state()["locked"], tab.state()["shown"]) == ([], first_plan(tab))


def planned_again(at: AtPage, tab: Tab) -> None:
    """A row is dragged to another place: the lock is there, and the next plan goes by it."""
    at.panel("order")
    row = swapped(at, tab)
    show_row(at, row)
    contour, over, plans = at.order[row], at.order[row + 1], at.plans
    said = at.drag_row(contour, over)
    assert f" as number {row + 2}" in said
    at.let_go()
    at.page.wait_for_selector("#hands-cancel", state="visible")
    state = tab.wait()
    assert len(state["alternatives"]) > plans, state["conflict"] or state["problem"]
    at.planned(plans + 1)
    assert at.order[row + 1] == contour
    assert f"{contour} position {row + 2}" in tab.state()["locked"]


def a_conflict(at: AtPage, tab: Tab, way_out: str) -> None:
    """An outline is to be cut before the hole in it: both are shown, and either way out of it leads to a plan."""
    outer = next(one for one in at.order if one.endswith(".hole1")).replace(".hole1", ".outer")
    plans = at.plans
    at.panel("locks")
    at.page.fill("#hands-lock-line", f"{outer} first")
    at.page.press("#hands-lock-line", "Enter")
    at.page.wait_for_selector(f"#hands-locks li:has-text('{outer} first')")
    at.page.click("#hands-plan")
    at.page.wait_for_selector("#hands-conflict .said")
    said = at.page.locator("#hands-conflict").inner_text()
    assert "These cannot all hold" in said
    assert f"is cut before {outer}: it lies inside it" in said
    conflict = tab.state()["conflict"]
    assert (conflict["minimal"], len(conflict["clash"])) == (True, 2)
    if way_out == "undo":
        at.page.click(f"#hands-conflict button:has-text('undo: {outer} first')")
    else:
        at.page.click("#hands-conflict button:has-text('relax ')")
    at.planned(plans + 1)
    assert at.page.locator("#hands-conflict").is_hidden()
    assert len(tab.state()["locked"]) == (way_out == "relax")
    if way_out == "relax":
        assert at.order.index(outer) > at.order.index(outer.replace(".outer", ".hole1"))
        first = first_plan(tab)
        tab.post("back", to=first)
        at.until("document.documentElement.dataset.plan === given[0]", str(first))
        assert tab.state()["locked"] == []


def two_plans(at: AtPage, tab: Tab) -> None:
    """The new plan is compared with the one before, and saved; then that one is gone back to."""
    new, first = tab.state()["shown"], first_plan(tab)
    at.panel("plans")
    at.page.click(f"[aria-label='compare plan {first} with plan {new}']")
    at.page.wait_for_selector("figure[data-side='1']")
    assert "differ" in at.page.locator("#compared-said").inner_text()
    at.panel("plans")
    at.page.click(f"[aria-label='compare plan {first} with plan {new}']")
    at.page.wait_for_selector("figure[data-side='1']", state="detached")
    at.page.click("#hands-save")
    at.page.wait_for_selector(f"#hands-said:has-text('saved {tab.nest.stem}.nc')")
    assert tab.nest.with_suffix(".nc").is_file()
    at.page.click("#hands-undo")
    at.until("document.documentElement.dataset.plan !== given[0]", str(new))
    assert tab.state()["shown"] < new


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
