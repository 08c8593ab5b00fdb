"""A drawing that cannot be cut: each problem is drawn where it is, and repaired where repair mends it."""

from __future__ import annotations

import json
import math
import time
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import ezdxf
import numpy as np
import pytest
from playwright.sync_api import Browser, Page

from kerfwise.apps.viewer.serve import query_worker
from kerfwise.apps.viewer.serve.plan_request import PlanRequest
from kerfwise.apps.viewer.serve.query_worker import Desk
from kerfwise.apps.viewer.serve.worker import error_as_json
from kerfwise.encoder.readers.read import BrokenNest
from kerfwise.tests.apps.viewer.serve.at_page import drop
from kerfwise.tests.apps.viewer.serve.conftest import TOUCH_FIRST
from kerfwise.tests.apps.viewer.serve.served import Served, wait_for

CROSSED = [[200, 20], [300, 20], [300, 100], [201, 100], [199, 98], [200, 100]]
"""It crosses itself near its last corner."""


def nest(*outers: list[list[float]]) -> str:
    parts = [{"id": name, "outer": outer} for name, outer in zip("ABCD", outers, strict=False)]
    return json.dumps({"format": "kerfwise-nest/1", "sheet": {"width": 400, "height": 200}, "parts": parts})


def square(x: float, y: float, wide: float = 80) -> list[list[float]]:
    return [[x, y], [x + wide, y], [x + wide, y + wide], [x, y + wide]]


WRONG = nest(square(20, 20), square(90, 90), CROSSED)
MENDABLE = nest(square(20, 20), CROSSED)


def told(path: Path, repair: bool = False) -> dict[str, Any]:
    try:
        Desk().opened(PlanRequest(str(path), None, repair))
    except Exception as error:
        wrong: dict[str, Any] = error_as_json(error)["problems"]
        return wrong
    raise AssertionError("it was opened")


def open_lines(path: Path) -> Path:
    """A square with a gap of 0.4 mm, another that misses a side, and a part."""
    drawing = ezdxf.new()
    drawing.header["$INSUNITS"] = 4
    space = drawing.modelspace()
    for corners, layer, closed in (
        ([(0, 0), (400, 0), (400, 200), (0, 200)], "SHEET", True),
        ([(20, 20), (100, 20), (100, 100), (20, 100), (20, 20.4)], "CUT", False),
        ([(130, 20), (210, 20), (210, 100), (130, 100)], "CUT", False),
        (square(240, 20), "CUT", True),
    ):
        space.add_lwpolyline(corners, close=closed, dxfattribs={"layer": layer})
    drawing.saveas(path)
    return path


def test_problems_of_a_nest_have_their_place_and_say_what_repair_mends(tmp_path: Path, keep_folder: None) -> None:
    path = tmp_path / "wrong.json"
    path.write_text(WRONG)
    problems = told(path)
    assert [(one["contours"], one["at"], one["mends"]) for one in problems["lines"]] == [
        (["C.outer"], (200.0, 99.0), True),
        (["A.outer", "B.outer"], (95.0, 95.0), False),
    ]
    assert problems["page"]["alert"] == [0, 1, 2]
    assert [one["mends"] for one in told(path, repair=True)["lines"]] == [False]


def test_lines_that_do_not_close_are_drawn_too(tmp_path: Path, keep_folder: None) -> None:
    problems = told(open_lines(tmp_path / "open.dxf"))
    page = problems["page"]["nest"]
    assert page["bounds"] == [0, 0, 400, 200]
    assert [(one["id"], one["closed"]) for one in page["contours"]] == [
        ("P1.outer", True),
        ("open1", False),
        ("open2", False),
    ]
    said = [(one["contours"], one["at"], one["mends"]) for one in problems["lines"]]
    assert said == [([], None, False), (["open1"], (20.0, 20.0), True), (["open2"], (130.0, 20.0), False)]


@pytest.mark.slow
def test_thousands_of_open_lines_are_told_in_seconds(monkeypatch: pytest.MonkeyPatch) -> None:
    def line(x: float) -> Any:
        vertices = np.array([[x, 0, 0], [x, 9.5, 0]])
        return SimpleNamespace(curve=SimpleNamespace(closed=False, vertices=vertices, point_at=lambda s: (x, 0.0)))

    lines = {f"open{k}": line(10.0 * k) for k in range(1, 3000)} | {"open door": line(-10.0)}
    details = [f"the line from ({10 * k}, 0) to ({10 * k}, 9.5)" for k in range(1, 3000)]
    details += ["open7: too short", "open12, and open door are odd", "open12.5 or reopen3"]
    contours = SimpleNamespace(contour=lines.__getitem__, file="open.dxf")
    broken = SimpleNamespace(nest=contours, wrong=tuple(lines), details=details, message="lines do not close")
    monkeypatch.setattr(query_worker, "page_of", lambda *given: {})
    begun_s = time.process_time()
    told = [one["contours"] for one in query_worker.problems_of(cast("BrokenNest", broken), None)["lines"]]
    assert time.process_time() - begun_s < 10  # half a second; minutes where each line looks at all others
    assert told == [*([f"open{k}"] for k in range(1, 3000)), ["open7"], ["open12", "open door"], []]


@pytest.fixture
def keep_folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """The desk goes to the nest's folder; afterwards the test is where it was."""
    monkeypatch.chdir(tmp_path)


def middle(page: Page, of: str) -> tuple[float, float]:
    box = page.locator(of).first.bounding_box()
    assert box is not None
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


@pytest.mark.slow
@pytest.mark.browser
@TOUCH_FIRST
def test_marks_stay_where_the_problems_are_and_repair_opens_the_drawing(
    browser: Browser, served: Served, tmp_path: Path, wide: int
) -> None:
    context = browser.new_context(viewport={"width": wide, "height": 844}, has_touch=wide < 500)
    page = context.new_page()
    faults: list[str] = []
    page.on("pageerror", lambda error: faults.append(str(error)))
    page.on("console", lambda said: None if "422" in said.text else faults.append(said.text))
    page.goto(f"{served.entrance}&list")
    page.wait_for_selector("h1")
    drop(page, f"{tmp_path.name}.json", WRONG)
    page.wait_for_selector("#broken .mark")
    assert page.locator("#broken .mark").count() == 2
    assert page.locator("#broken .repair").count() == 1
    box = page.locator("#broken canvas").bounding_box()
    assert box is not None
    scale = min((box["width"] - 32) / 400, (box["height"] - 32) / 200)
    x = box["x"] + box["width"] / 2 + (95 - 200) * scale
    y = box["y"] + box["height"] / 2 - (95 - 100) * scale
    assert middle(page, "#broken .mark >> nth=1") == pytest.approx((x, y), abs=1.5)
    x, y = middle(page, "#broken .mark >> nth=1")
    px, py = round(x + 40), round(y + 40)
    page.mouse.move(px, py)
    page.mouse.wheel(0, -400)
    zoom = math.exp(400 * 0.0016)
    there = pytest.approx((px + (x - px) * zoom, py + (y - py) * zoom), abs=1.5)
    wait_for(lambda: page.wait_for_timeout(15) or middle(page, "#broken .mark >> nth=1") == there)
    page.click("#broken .mark >> nth=1")
    assert page.locator("#broken .bubble").inner_text().startswith("A.outer and B.outer overlap by 100.000 mm²")
    assert page.locator("#broken .bubble .repair").count() == 0
    page.click("#broken li >> nth=0 >> .link")
    assert "C.outer crosses itself" in page.locator("#broken .bubble").inner_text()
    page.click("#broken .bubble .repair")  # what it mends is gone; the rest is still wrong
    page.wait_for_selector("#broken .mark >> nth=1", state="detached")
    assert page.locator("#broken li").count() == 1
    assert page.locator("#broken .repair").count() == 0
    drop(page, f"{tmp_path.name}-2.json", MENDABLE)  # wrong in nothing but what is asked
    page.get_by_role("button", name="the largest loop of each").click()
    page.click("#answer-all")
    page.wait_for_url("**/nest/*")
    page.wait_for_selector("[data-ready=yes]", state="attached")
    assert (served.server.folder.path / f"{tmp_path.name}-2.json").read_text() == MENDABLE
    assert page.evaluate("document.body.scrollWidth - innerWidth") <= 0
    assert faults == []
    context.close()
