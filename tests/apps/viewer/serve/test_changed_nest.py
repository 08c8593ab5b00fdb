"""A nest that is changed over the server: tried first, then written beside the old one and opened."""

from __future__ import annotations

import json

import pytest

from kerfwise.tests.apps.viewer.serve.served import Open

pytestmark = pytest.mark.slow


def test_a_changed_nest_is_tried_then_written_and_opened(opened: Open) -> None:
    tab = opened()
    told = tab.post("nest", changes=["drop A", "move B 0 5"])
    assert (told["parts"], told["off"]) == (["B", "C"], [])
    assert "B.outer" in {contour["id"] for contour in told["drawing"]["contours"]}
    assert "reaches" in tab.post("nest", 422, changes=["move B 0 5000"])["details"][0]
    assert "no change of a nest" in tab.post("nest", 422, changes=["paint B red"])["message"]
    assert "in the folder of the nest" in tab.post("nest", 422, changes=["add ../other.json"])["message"]
    made = tab.post("nest", 201, changes=["drop A"], **{"as": f"{tab.nest.stem}-2.json"})
    assert made["id"] != tab.id
    written = tab.nest.with_name(f"{tab.nest.stem}-2.json")
    assert [part["id"] for part in json.loads(written.read_text())["parts"]] == ["B", "C"]
    assert [part["id"] for part in json.loads(tab.nest.read_text())["parts"]] == ["A", "B", "C"]
