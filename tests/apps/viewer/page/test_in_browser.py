"""The page in the browser: every gesture, on a wide screen and on a phone, with no error and no request."""

from __future__ import annotations

import io
import math

import pypdfium2
import pytest

from kerfwise.tests.apps.viewer.page.conftest import Open
from kerfwise.tests.apps.viewer.page.seen import Seen
from kerfwise.tests.tools.amount import few, rows

pytestmark = [pytest.mark.slow, pytest.mark.browser]

WIDTHS = pytest.mark.parametrize("wide", [1400, 390])
MOUSE_FIRST = pytest.mark.parametrize("wide", few([1400, 390]))
SIZES = pytest.mark.parametrize("name", few(["16", "115"]))
OUTER = "part#8.outer"


def show(seen: Seen, tab: str) -> None:
    seen.page.click(f"#tab-{tab}")


@SIZES
@WIDTHS
def test_wheel_drag_and_click(look: Open, name: str, wide: int) -> None:
    seen = look(name, wide)
    left, top, width, height = seen.drawing()
    x, y = round(left + 0.4 * width), round(top + 0.4 * height)
    scale, cx, cy = seen.camera()
    under = ((x - left - cx) / scale, (cy - y + top) / scale)
    seen.page.mouse.move(x, y)
    seen.page.mouse.wheel(0, -400)
    seen.sharp()
    nearer, cx, cy = seen.camera()
    assert nearer > 1.5 * scale
    assert ((x - left - cx) / nearer, (cy - y + top) / nearer) == pytest.approx(under, abs=1e-6)
    seen.page.mouse.down()
    seen.page.mouse.move(x + 30, y + 20)
    seen.page.mouse.move(x + 60, y + 40)
    seen.page.mouse.up()
    seen.sharp()
    _, dx, dy = seen.camera()
    assert (dx - cx, dy - cy) == pytest.approx((60, 40), abs=31)  # the way until it counts as a drag is lost
    assert seen.chosen == ""
    parts_first = seen.page.evaluate("window.kerfwise.stages[0].fitted.parts")  # few parts on a large sheet
    seen.page.click("#fit-parts" if parts_first else "#fit")
    assert seen.camera()[0] == pytest.approx(scale)
    seen.page.click("#fit")
    assert seen.camera()[0] <= scale


@MOUSE_FIRST
def test_a_click_says_why(look: Open, wide: int) -> None:
    seen = look("16", wide)
    seen.page.mouse.click(*seen.entry(OUTER))
    assert seen.chosen == OUTER
    why = seen.page.locator("#why-said").inner_text()
    for title in ("Why here", "Not earlier", "Entries weighed", "If it were moved"):
        assert title in why
    assert "mm more" in why
    assert seen.said.startswith(OUTER)
    seen.page.locator("#why-said button.link").first.click()
    assert seen.chosen not in ("", OUTER)


@WIDTHS
def test_what_is_hit_when_zoomed(look: Open, wide: int) -> None:
    seen = look("115", wide)
    for contour in ("P3.hole1", "P19.outer", "P41.outer"):
        seen.page.evaluate("id => { const app = window.kerfwise; app.stages[0].fit(); app.chooseId(id); }", contour)
        seen.page.evaluate("() => { const app = window.kerfwise; app.set({ selected: -1 }); }")
        x, y = seen.entry(contour)
        seen.page.mouse.move(x, y)
        for _ in range(3):
            seen.page.mouse.wheel(0, -500)
        seen.sharp()
        x, y = seen.entry(contour)
        seen.page.mouse.click(x, y)
        assert seen.chosen == contour


def test_two_fingers_zoom(look: Open) -> None:
    seen = look("16", 390)
    left, top, width, height = seen.drawing()
    x, y, scale = left + width / 2, top + height / 2, seen.camera()[0]
    fingers = seen.context.new_cdp_session(seen.page)
    for kind, apart in (("touchStart", 20), ("touchMove", 40), ("touchMove", 60), ("touchEnd", 0)):
        points = [] if kind == "touchEnd" else [{"x": x - apart, "y": y, "id": 1}, {"x": x + apart, "y": y, "id": 2}]
        fingers.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
    seen.sharp()
    assert seen.camera()[0] == pytest.approx(3 * scale, rel=0.1)


@SIZES
@WIDTHS
def test_keyboard_only(look: Open, name: str, wide: int) -> None:
    seen = look(name, wide)
    keys = seen.page.keyboard
    keys.press("ArrowRight")
    first = seen.state("time_s")
    keys.press("ArrowRight")
    assert 0 < first < seen.state("time_s")
    assert "2 of" in seen.said
    keys.press("n")
    assert seen.chosen
    assert seen.chosen in seen.page.locator("#why-said").inner_text()
    before = seen.chosen
    keys.press("n")
    assert seen.chosen != before
    scale = seen.camera()[0]
    keys.press("+")
    assert seen.camera()[0] == pytest.approx(1.3 * scale)
    keys.press("End")
    assert seen.page.locator("#doing").inner_text().startswith("done")
    keys.press("?")
    assert seen.page.locator("dialog[open] kbd").count() > 15
    keys.press("Escape")
    seen.until("document.querySelector('dialog[open]') === null")
    keys.press("Escape")
    assert seen.chosen == ""
    if wide < 1100:
        seen.page.focus("#tab-why")
        keys.press("ArrowLeft")
        assert seen.state("tab") == "order"
    for _ in range(60):
        if seen.page.evaluate("document.activeElement.id") == "orders":
            break
        keys.press("Tab")
    keys.press("ArrowDown")
    keys.press("ArrowDown")
    assert seen.page.locator("#orders .row.chosen .no").inner_text() == "2"


@SIZES
def test_search_by_number_id_and_part(look: Open, name: str) -> None:
    seen = look(name)
    first = seen.page.evaluate("window.kerfwise.data.nest.contours[window.kerfwise.side.cuts[6].contour].id")
    part = first.split(".")[0]
    for text, found in (("7", first), (first.upper(), first), (part, None)):
        seen.page.keyboard.press("/")
        seen.page.fill("#search", text)
        if found is None:
            names = seen.page.locator("#found [data-contour]").all_inner_texts()
            assert len(names) >= 1
            assert all(part in one for one in names[:1])
        seen.page.keyboard.press("Enter")
        assert seen.chosen == found or seen.chosen.startswith(part)
        seen.page.evaluate("document.activeElement.blur()")
    seen.page.fill("#search", "no such thing")
    assert "nothing found" in seen.page.locator("#found").inner_text()


@MOUSE_FIRST
def test_a_rule_shows_its_places(look: Open, wide: int) -> None:
    seen = look("16", wide)
    show(seen, "rules")
    rows = seen.page.locator("#rules-said tbody tr[data-rule]")
    assert rows.count() > 10
    assert "excused" in seen.page.locator("#rules-said p").nth(1).inner_text()
    soft = seen.page.locator("#rules-said tr.soft button").first
    soft.click()
    assert len(seen.state("marked")) >= 2
    seen.page.locator(".places .link").first.click()
    assert seen.chosen
    soft = seen.page.locator("#rules-said tr.soft button").first
    soft.click()
    assert seen.state("marked") == []


@MOUSE_FIRST
def test_it_plays_in_true_time_with_the_program(look: Open, wide: int) -> None:
    seen = look("16", wide)
    show(seen, "nc")
    seen.page.select_option("#speed", "16")
    seen.page.click("#play")
    began = seen.page.evaluate("[performance.now() / 1000, window.kerfwise.state.time_s]")
    seen.until("window.kerfwise.state.time_s > 8")
    ended = seen.page.evaluate("[performance.now() / 1000, window.kerfwise.state.time_s]")
    seen.page.click("#play")
    # A busy machine drops frames, and each may count for a quarter of a second at the most: never too fast.
    assert 0 < ended[1] - began[1] <= 16 * (ended[0] - began[0]) + 1
    assert seen.state("playing") is False
    line = int(seen.page.locator("#nc .row.now .no").inner_text())
    number = seen.page.evaluate("window.kerfwise.cutNow()")
    lines = seen.page.evaluate("k => window.kerfwise.data.sides[0].nc.lines[k]", number)
    assert line in lines
    box = seen.page.locator("#ruler").bounding_box()
    assert box is not None
    seen.page.mouse.click(box["x"] + 0.75 * box["width"], box["y"] + box["height"] - 8)
    assert seen.state("time_s") == pytest.approx(0.75 * seen.page.evaluate("window.kerfwise.end()"), rel=0.02)


def test_the_drawing_changes_as_metal_goes(look: Open) -> None:
    seen = look("16")
    pixel = """() => {
      const stage = window.kerfwise.stages[0], [x0, y0, x1, y1] = stage.scenery.outlines.bounds[0];
      const [x, y] = stage.toScreen((x0 + x1) / 2, (y0 + y1) / 2);
      const copy = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
      copy.drawImage(stage.canvas, -Math.round(x * stage.size.ratio), -Math.round(y * stage.size.ratio));
      return [...copy.getImageData(0, 0, 1, 1).data].join();
    }"""
    assert seen.page.evaluate("window.kerfwise.data.nest.contours[0].kind") == "hole"
    uncut = seen.page.evaluate(pixel)
    seen.page.keyboard.press("End")
    seen.sharp()
    cut = seen.page.evaluate(pixel)
    assert cut != uncut
    seen.page.keyboard.press("Home")
    seen.sharp()
    assert seen.page.evaluate(pixel) == uncut


def test_heat_of_a_moment(look: Open) -> None:
    seen = look("16")
    seen.page.click("#heat")
    seen.until("window.kerfwise.state.heat")
    hottest = "window.kerfwise.stages[0].heat.hottest(window.kerfwise.state.time_s)"
    assert seen.page.evaluate(hottest) == pytest.approx(20)
    seen.page.keyboard.press("End")
    assert seen.page.evaluate(hottest) > 25
    assert "hottest now" in seen.page.locator("#heat-scale").inner_text()


@MOUSE_FIRST
def test_two_plans_under_one_cursor(look: Open, wide: int) -> None:
    seen = look("compared", wide)
    assert seen.page.locator("#stages canvas").count() == 2
    left, top, width, height = seen.drawing()
    seen.page.mouse.move(left + width / 2, top + height / 2)
    crosses = seen.page.evaluate("window.kerfwise.stages.map(stage => stage.cross)")
    assert crosses[0] == crosses[1] is not None
    seen.page.mouse.wheel(0, -300)
    scales = seen.page.evaluate("window.kerfwise.stages.map(stage => stage.camera.scale)")
    assert scales[0] == scales[1]
    seen.page.locator("#compared-said td button").first.click()
    assert seen.chosen
    seen.page.keyboard.press("s")
    assert seen.state("side") == 1
    assert "differ" in seen.page.locator("#compared-said").inner_text()


@pytest.mark.parametrize(("name", "pages"), rows([("115", 3), ("16", 1)]))
def test_printed_it_is_a_work_sheet(look: Open, name: str, pages: int) -> None:
    seen = look(name, 1400, "dark")
    paper = pypdfium2.PdfDocument(io.BytesIO(seen.page.pdf(prefer_css_page_size=True)))
    assert len(paper) == pages
    text = paper[0].get_textpage().get_text_range()
    assert "pierce at, mm" in text
    assert [round(size) for size in paper[0].get_size()] == [595, 842]
    assert seen.page.locator("#paper *").count() == 0


@pytest.mark.parametrize("scheme", few(["dark", "light"]))
def test_it_fits_a_phone_in_both_looks(look: Open, scheme: str) -> None:
    seen = look("16", 390, scheme)
    assert seen.page.evaluate("document.documentElement.scrollWidth") <= 390
    assert seen.page.evaluate("document.documentElement.scrollHeight") <= 844
    ground = "getComputedStyle(document.body).backgroundColor.match(/[0-9]+/g).map(Number)[0]"
    assert (seen.page.evaluate(ground) < 80) == (scheme == "dark")
    seen.page.keyboard.press("d")
    assert (seen.page.evaluate(ground) < 80) == (scheme == "light")
    low = [b for b in seen.page.locator("button:visible").all() if (box := b.bounding_box()) and box["height"] < 22]
    assert [b.inner_text() for b in low if "link" not in (b.get_attribute("class") or "")] == []


@pytest.mark.parametrize("name", few(["308", "1000"]))
def test_a_large_nest(look: Open, name: str) -> None:
    seen = look(name)
    rows = seen.page.locator("#orders .row")
    assert rows.count() < 60
    seen.page.focus("#orders")
    seen.page.keyboard.press("End")
    last = seen.page.locator("#orders .row.chosen .no").inner_text()
    assert int(last) == seen.page.evaluate("window.kerfwise.side.cuts.length") >= 0.9 * int(name)
    seen.page.keyboard.press("0")
    left, top, width, height = seen.drawing()
    seen.page.mouse.move(left + width / 2, top + height / 2)
    for _ in range(5):
        seen.page.mouse.wheel(0, -200)
    seen.sharp()
    contour = seen.chosen
    seen.page.evaluate("id => window.kerfwise.chooseId(id)", contour)
    x, y = seen.entry(contour)
    assert math.isfinite(x + y)
    seen.page.evaluate("document.activeElement.blur()")
    seen.page.keyboard.press("End")
    seen.sharp()
    assert seen.page.locator("#doing").inner_text().startswith("done")


def test_names_that_are_scripts_are_names(look: Open) -> None:
    seen = look("wicked")
    seen.page.keyboard.press("n")
    assert "<img src=x onerror" in seen.page.locator("#why-said").inner_text()
    seen.page.fill("#search", "<img")
    assert "<img" in seen.page.locator("#found").inner_text()
    assert seen.page.evaluate("window.evil") is None
    assert seen.page.evaluate("document.querySelectorAll('img').length") == 0


def test_few_parts_on_a_large_sheet_are_what_is_seen_first(look: Open) -> None:
    seen = look("wicked")
    side_px = 200 * seen.camera()[0]
    _, _, wide, high = seen.drawing()
    assert side_px > 0.8 * min(wide, high)
    seen.page.set_viewport_size({"width": 1400, "height": 700})
    seen.sharp()
    assert side_px > 200 * seen.camera()[0] > 0.8 * seen.drawing()[3], "they are seen whole in a smaller window, too"
    seen.page.keyboard.press("0")
    assert 900 * seen.camera()[0] <= seen.drawing()[3]


def test_the_policy_forbids_what_a_script_might_ask(look: Open) -> None:
    seen = look("bare")
    assert seen.page.evaluate("fetch('https://example.org/').then(() => 'answered', () => 'forbidden')") == "forbidden"
    assert any("Content Security Policy" in text for text in seen.wrong)
    seen.wrong.clear()
    assert seen.asked == []


def test_a_nest_without_a_plan(look: Open) -> None:
    seen = look("bare")
    assert seen.page.locator("#transport").is_hidden()
    left, top, width, height = seen.drawing()
    seen.page.mouse.click(left + 0.5 * width, top + 0.5 * height)
    assert seen.chosen == "A.outer"
    assert "A.outer" in seen.page.locator("#why-said").inner_text()
