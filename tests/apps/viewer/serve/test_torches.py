"""Several torches in the viewer: planned again and again, a row for each cut, all torches seen, no drop taken."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from kerfwise.tests.apps.viewer.serve.conftest import Look
from kerfwise.tests.apps.viewer.serve.served import Open, Served, Tab
from kerfwise.tests.commands.test_torches import COPIES, SINGLE, STEP, plant_file

pytestmark = [pytest.mark.slow, pytest.mark.browser]

NEST = {"format": "kerfwise-nest/1", "sheet": {"width": 360, "height": 280}, "parts": [*COPIES, SINGLE]}


def row(opened: Open, served: Served, name: str) -> Tab:
    folder = served.server.folder.path / name
    folder.mkdir()
    plant_file(folder)
    return opened(json.dumps(NEST), "row.json", "profile: plant.yaml\n")


@pytest.mark.full
def test_the_sheet_moves_by_all_of_them(opened: Open, served: Served, tmp_path: Path) -> None:
    tab = row(opened, served, tmp_path.name)
    tab.solved()
    lines = {line["name"]: line for line in tab.get("bent", plan=1)["lines"]}
    assert lines["A.outer"]["off"] > 0 < lines["C.outer"]["off"]
    assert lines["A.outer"]["cut_s"] == lines["C.outer"]["cut_s"] < lines["S.outer"]["cut_s"]


def test_two_torches(look: Look, opened: Open, served: Served, tmp_path: Path) -> None:
    tab = row(opened, served, tmp_path.name)
    at = look(tab)
    at.plan()
    order = at.order
    assert sorted(order) == sorted(["A.hole1", "A.outer", "B.outer", "C.hole1", "C.outer", "D.outer", "S.outer"])
    torches = at.ask("app.side.cuts.map(cut => cut.torch)")
    assert [torches[order.index(name)] for name in ("C.outer", "D.outer", "S.outer")] == [2, 2, 1]
    assert order.index("C.outer") == order.index("A.outer") + 1
    rows = at.page.locator("#orders .row .flag").all_inner_texts()
    assert rows.count("T2") == 3
    first, second = order.index("A.outer"), order.index("C.outer")
    begins, ends = at.ask("[app.stages[0].timeline.begins_s, app.stages[0].timeline.ends_s]")
    assert (begins[first], ends[first]) == (begins[second], ends[second])
    path, beside = at.ask(f"[app.side.cuts[{first}].path, app.side.cuts[{second}].path]")
    assert [b - a for a, b in zip(path, beside, strict=True)] == pytest.approx([0, STEP, 0] * (len(path) // 3))
    at.ask("app.seek(given[0])", ends[first] + 1e-3)
    at.choose("C.outer")
    said = at.page.locator("#why-said").inner_text()
    assert "cut by torch 2" in said
    assert at.page.locator("#hands-chosen button", has_text="pin as").count() == 0
    at.page.wait_for_selector("#why-said h3:has-text('If it were moved')")
    heat = tab.get("heat", plan=1)
    assert heat["peak_c"] > heat["ambient_c"] + 40
    at.page.click("#heat")
    at.page.wait_for_selector("#heat[aria-pressed=true]")
    hottest = "app.stages[0].heat.at(app.state.time_s, ...given[0])"
    assert at.ask(hottest, [70, 20]) == pytest.approx(at.ask(hottest, [70, 20 + STEP]), abs=2)  # A, and C beside it
    assert at.ask(hottest, [70, 20]) > heat["ambient_c"] + 20 > at.ask(hottest, [300, 70])
    at.panel("nc")
    at.page.wait_for_selector("#nc .row.now")
    at.drag([at.row("S.outer"), at.row("A.outer")])
    at.let_go()
    assert "several torches cut at a time" in at.page.locator("#hands-said").inner_text()
    tab.state()
    tab.edit({"lock": "S.outer first"})
    tab.solved()
    at.until("app.data.nest.contours[app.side.cuts[0].contour].id === 'S.outer'")
    assert tab.state()["alternatives"][-1]["ok"]
    assert "knows one torch, and the profile has several" in tab.post("cut", 422, upto=2)["message"]
