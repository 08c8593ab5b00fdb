"""The page that shows how a sheet moves: what is in it, and that a browser plays it."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from kerfwise.apps.distortion.cutting import Cutting
from kerfwise.apps.distortion.predict import animate
from kerfwise.tests.apps.distortion.sheets import HEAT, around, part, rectangle, sheet_of
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.tools.browser import launched

NEST = sheet_of(
    rectangle(0, 0, 400, 200), part("A", rectangle(20, 20, 380, 70)), part("B<1>", rectangle(20, 100, 200, 180))
)


def page() -> str:
    return animate(NEST, around(NEST, "A.outer", "B<1>.outer"), HEAT, Cutting(20.0, 2.0, 10.0), "a <nest>").decode()


def data_of(text: str) -> dict[str, Any]:
    found = re.search(r"^const data = (.*);$", text, re.MULTILINE)
    assert found is not None
    read: dict[str, Any] = json.loads(found.group(1))
    return read


def test_metal_grows_as_it_is_cut_and_what_is_free_stays() -> None:
    text = page()
    assert "a &lt;nest&gt;" in text
    data = data_of(text)
    lines = {line["name"]: line for line in data["lines"]}
    assert set(lines) == {"", "A.outer", "B<1>.outer"}
    at_s, cut_s = np.array(data["at_s"]), lines["A.outer"]["cut_s"]
    for line in lines.values():
        moved = np.array(line["moved"])
        assert moved.shape == (len(at_s), len(line["xy"]))
        assert np.abs(moved[0]).max() < 20 < np.abs(moved).max() < 5000  # µm
    free, edge = (np.array(lines[k]["moved"])[at_s > cut_s] for k in ("A.outer", ""))
    free, edge = (moved.reshape(len(moved), -1, 2) for moved in (free, edge))
    assert np.ptp(free - free[:1], axis=1).max() <= 2  # but for where the sheet has drifted
    assert np.ptp(edge - edge[:1], axis=1).max() > 5
    assert lines[""]["cold"] is None
    assert np.hypot(*np.array(lines["A.outer"]["cold"]).reshape(-1, 2).T).max() / 1000 <= lines["A.outer"]["off"] + 1e-3


def test_another_kind_of_file_is_refused_before_anything_is_read(tmp_path: Path) -> None:
    done = kerfwise("distort", tmp_path / "none.json", tmp_path / "none.nc", "--animate", tmp_path / "a.gif")
    assert (done.code, "give a name ending in .html" in done.err) == (2, True)


@pytest.mark.full
@pytest.mark.browser
def test_a_browser_plays_it_to_the_end(tmp_path: Path) -> None:
    (tmp_path / "a.html").write_text(page(), encoding="utf-8")
    with launched() as browser:
        seen = browser.new_page()
        wrong: list[str] = []
        seen.on("pageerror", lambda error: wrong.append(str(error)))
        seen.goto((tmp_path / "a.html").as_uri())
        seen.evaluate("() => { frame.value = frame.max; play.onclick(); frame.value = frame.max; }")
        seen.wait_for_function("() => cold.checked && play.textContent === 'Play'")
        assert "A.outer" in seen.inner_text("output") or "B<1>.outer" in seen.inner_text("output")
        assert wrong == []
