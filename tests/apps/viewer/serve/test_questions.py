"""Questions that a drawing raises, answered on the page: buttons, pictures, and the job file."""

from __future__ import annotations

import base64
import json
from pathlib import Path
from typing import Any

import httpx
import pytest
from playwright.sync_api import Browser

from kerfwise import read_job
from kerfwise.tests.apps.viewer.serve.at_page import drop
from kerfwise.tests.apps.viewer.serve.conftest import TOUCH_FIRST, Look
from kerfwise.tests.apps.viewer.serve.served import Open, Served
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.commands.test_narrow_slots import slotted
from kerfwise.tests.encoder.readers.drawings import lines, save_dxf, square
from kerfwise.tests.encoder.readers.test_frame import framed

OPEN = """<svg xmlns="http://www.w3.org/2000/svg" width="400mm" height="200mm" viewBox="0 0 400 200">
<g id="a"><rect x="10" y="10" width="380" height="180" fill="none" stroke="black"/></g>
<g id="b" fill="none" stroke="black"><circle cx="100" cy="100" r="30"/><circle cx="250" cy="100" r="30"/>
<path d="M180 40 L 180 160"/></g></svg>"""
"""A frame around everything, and an open line beside closed ones: two questions."""


def folder_of(served: Served, tmp_path: Path) -> Path:
    folder = served.server.folder.path / tmp_path.name
    folder.mkdir(exist_ok=True)
    return folder


def picture_of(told: dict[str, Any]) -> str:
    head, _, data = told["picture"].partition(",")
    assert head == "data:image/svg+xml;base64"
    return base64.b64decode(data).decode("utf-8")


def test_a_question_is_told_as_data_and_answered(served: Served, client: httpx.Client, tmp_path: Path) -> None:
    folder = folder_of(served, tmp_path)
    nest = save_dxf(folder, framed)
    name = f"{folder.name}/{nest.name}"
    asked = client.post("/api/open", json={"nest": name})
    assert asked.status_code == 422
    [question] = asked.json()["questions"]
    assert (question["id"], [choice["value"] for choice in question["choices"]]) == ("frame", ["part", "sheet"])
    job = nest.with_name("drawing.job.yaml")
    wrong = client.post("/api/open", json={"nest": name, "answers": {"frame": "door"}})
    assert wrong.status_code == 422
    assert "the answer frame=door is none of the choices" in wrong.json()["message"]
    pictures = {
        value: picture_of(client.post("/api/preview", json={"nest": name, "answers": {"frame": value}}).json())
        for value in ("part", "sheet")
    }
    assert pictures["part"] != pictures["sheet"]
    assert not job.exists()
    job.write_text("quantity: 4  # sheets\n")
    opened = client.post("/api/open", json={"nest": name, "answers": {"frame": "sheet", "mask": "whole"}})
    assert opened.status_code == 200, opened.text
    assert job.read_text().startswith("quantity: 4  # sheets\n")
    assert read_job(job).answers == (("frame", "sheet"),)
    assert client.post("/api/open", json={"nest": name}).json()["id"] == opened.json()["id"]
    # the command asks nobody again
    assert kerfwise("read", nest).code == 0


def test_answers_that_are_none_are_refused(served: Served, client: httpx.Client, tmp_path: Path) -> None:
    folder = folder_of(served, tmp_path)
    save_dxf(folder, framed)
    for answers in (["frame"], {"frame": 3}, {"frame": ""}):
        told = client.post("/api/open", json={"nest": f"{folder.name}/drawing.dxf", "answers": answers})
        assert told.status_code == 422
        assert 'answers: expected {"QUESTION": "CHOICE"}' in told.json()["message"]
    nobody = client.post("/api/open", json={"nest": f"{folder.name}/drawing.dxf", "answers": {"nobody": "asks"}})
    assert (nobody.status_code, "raises a question 'nobody'" in nobody.json()["message"]) == (422, True)
    dropped = client.post("/api/drop?name=x.svg&answers=frame", content=OPEN.encode())
    assert 'answers: expected {"QUESTION": "CHOICE"}' in dropped.json()["message"]


def test_a_dropped_drawing_is_kept_once_it_is_answered(served: Served, client: httpx.Client, tmp_path: Path) -> None:
    name = f"{tmp_path.name}.svg"
    folder = served.server.folder.path
    asked = client.post(f"/api/drop?name={name}", content=OPEN.encode())
    assert asked.status_code == 422
    assert {question["id"] for question in asked.json()["questions"]} == {"layer:b", "frame"}
    shown = client.post(f'/api/drop?name={name}&preview=1&answers={{"frame":"part"}}', content=OPEN.encode())
    assert "<svg" in picture_of(shown.json())
    assert not (folder / name).exists()
    answers = '{"frame":"part","layer:b":"open:mark"}'
    done = client.post(f"/api/drop?name={name}&answers={answers}", content=OPEN.encode())
    assert done.status_code == 201, done.text
    assert (folder / name).read_text() == OPEN
    assert dict(read_job(folder / f"{tmp_path.name}.job.yaml").answers) == {"frame": "part", "layer:b": "open:mark"}


@pytest.mark.slow
@pytest.mark.browser
@TOUCH_FIRST
def test_questions_have_buttons_and_pictures_on_the_page(
    browser: Browser, served: Served, tmp_path: Path, wide: int
) -> None:
    context = browser.new_context(viewport={"width": wide, "height": 844}, has_touch=wide < 500)
    page = context.new_page()
    faults: list[str] = []
    page.on("pageerror", lambda error: faults.append(str(error)))
    page.on("console", lambda said: None if "422" in said.text else faults.append(said.text))
    page.goto(f"{served.entrance}&list")
    page.wait_for_selector("h1")
    name = f"{tmp_path.name}.svg"
    drop(page, name, OPEN)
    page.wait_for_selector("#questions fieldset >> nth=1")
    assert page.locator("#questions h2").inner_text() == "This drawing raises 2 questions"
    page.wait_for_selector("[data-previews=drawn]", state="attached")
    cards = page.locator("#questions .choice")
    assert page.locator("#questions .choice img").evaluate_all("all => all.every(one => one.naturalWidth > 100)")
    assert page.locator("#answer-all").is_disabled()
    assert page.locator("#answers-left").inner_text() == "2 questions are not answered yet."
    page.screenshot(path=tmp_path / "asked.png", full_page=True)
    pictures = cards.locator("img").evaluate_all("all => all.map(one => one.src)")
    assert len(set(pictures)) == 4  # the other question has its likeliest answer in each
    page.get_by_role("button", name="a part; what is in it").click()
    page.get_by_role("button", name="the open ones are marked, the closed").click()
    assert page.locator("#questions .choice.chosen").count() == 2
    assert page.locator("#answers-left").inner_text() == ""
    page.screenshot(path=tmp_path / "answered.png", full_page=True)
    assert page.evaluate("document.body.scrollWidth - innerWidth") <= 0
    page.click("#answer-all")
    page.wait_for_url("**/nest/*")
    page.wait_for_selector("[data-ready=yes]", state="attached")
    assert page.evaluate("window.kerfwise.data.nest.contours.map(one => one.id)").count("P1.mark1") == 1
    job = served.server.folder.path / f"{tmp_path.name}.job.yaml"
    assert dict(read_job(job).answers) == {"frame": "part", "layer:b": "open:mark"}
    assert faults == []
    context.close()


@pytest.mark.slow
@pytest.mark.browser
def test_an_answer_may_lead_to_the_next_question(browser: Browser, served: Served, tmp_path: Path) -> None:
    def plate(space: Any) -> None:
        for layer, side in (("PLATE", 200.0), ("0", 50.0)):
            lines(space, square(0 if layer == "PLATE" else 20, 0 if layer == "PLATE" else 20, side), layer=layer)
        space.add_line((30, 30), (60, 60))

    folder = folder_of(served, tmp_path)
    save_dxf(folder, plate)
    context = browser.new_context(viewport={"width": 1400, "height": 900})
    page = context.new_page()
    page.goto(f"{served.entrance}&list")
    page.fill("#filter", folder.name)  # of many nests it may be none of the first
    page.get_by_role("button", name=f"{folder.name}/drawing.dxf").click()
    for _ in range(3):
        page.wait_for_selector("#questions, [data-ready=yes]", state="attached")
        if not page.locator("#questions").count():
            break
        first = page.locator("#questions legend").all_inner_texts()
        for box in page.locator("#questions fieldset").all():
            box.locator("button").first.click()
        page.click("#answer-all")
        page.wait_for_function(
            "first => JSON.stringify([...document.querySelectorAll('#questions legend')].map(one => one.innerText))"
            " !== JSON.stringify(first)",
            arg=first,
        )
    page.wait_for_url("**/nest/*")
    assert read_job(folder / "drawing.job.yaml").answers
    context.close()


SLOTTED = json.dumps(
    {
        "format": "kerfwise-nest/1",
        "sheet": {"width": 400, "height": 400},
        "parts": [{"id": "A", "outer": slotted(30, 30, 1.0, 80)}],
    }
)


def test_a_question_of_the_planning_is_answered_in_the_session(opened: Open, client: httpx.Client) -> None:
    tab = opened(SLOTTED, "slotted.json")
    state = tab.solved()
    [question] = state["questions"]
    assert question["id"] == "narrow"
    pictures = [
        picture_of(client.post("/api/preview", json={"nest": state["nest"], "answers": {"narrow": value}}).json())
        for value in ("slit", "leave")
    ]
    assert len(set(pictures)) == 2
    assert "left out" in pictures[1]
    assert [choice["value"] for choice in question["choices"]][:2] == ["slit", "leave"]
    assert tab.edit({"answer": "narrow"}, expected=422)["message"].startswith("--answer 'narrow': expected QUESTION=")
    assert tab.edit({"answer": "narrow=slit"})["questions"] == []
    assert "narrow" in tab.state()["job_text"]
    state = tab.solved()
    assert (state["problem"], state["questions"], len(state["alternatives"])) == ("", [], 1)
    tab.post("save")
    assert read_job(tab.nest.with_name("slotted.job.yaml")).answers == (("narrow", "slit"),)


@pytest.mark.slow
@pytest.mark.browser
def test_a_question_of_the_planning_has_buttons(look: Look, opened: Open, tmp_path: Path) -> None:
    there = look()
    there.open(opened(SLOTTED, "slotted.json"))
    there.page.click("#hands-plan")
    there.page.wait_for_selector("#hands-questions button >> nth=1")
    there.page.wait_for_selector("#hands-questions[data-previews=drawn]", state="attached")
    shown = "all => all.filter(one => !one.hidden && one.naturalWidth > 100).length"
    assert there.page.locator("#hands-questions img").evaluate_all(shown) == 2
    there.picture(tmp_path, "planning")
    there.page.locator("#hands-questions button").first.click()
    there.planned(1)
    assert there.page.locator("#hands-questions").is_hidden()
    assert there.wrong == []
