"""An edge start from nest to program: offered, preheated, judged, explained and drawn; and not where it may not be."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.tools import canon

NEST = {
    "format": "kerfwise-nest/1",
    "sheet": {"width": 200, "height": 120},
    "parts": [{"id": "A", "outer": [[4, 30], [64, 30], [64, 90], [4, 90]]}],
}
PLANT = """
based_on: oxyfuel-thick-plate
machine: {edge_preheat: 7 s, travel_x: [-20, 3000], travel_y: [-20, 1500]}
leads: {edge_start: true}
objective: {time: 92}
"""


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("near.json").write_text(json.dumps(NEST))
    Path("plant.yaml").write_text(PLANT)
    return tmp_path


@pytest.mark.linuxcnc
def test_it_preheats_and_is_judged_explained_and_drawn(here: Path) -> None:
    given = ("near.json", "-p", "plant.yaml")
    done = kerfwise("solve", *given, "--work", 1, "-o", "a.nc", "--plan", "a.json", "--picture", "a.svg")
    assert done.code == 0, done.err
    assert ", 0 pierces," in done.out
    run = canon.run(Path("a.nc").read_text())
    assert run.error is None
    assert run.burns[0].pierce[0] < 0
    assert run.dwell_s == 7
    for made in ("a.nc", "a.json"):
        assert kerfwise("check", *given, made).code == 0
        assert json.loads(kerfwise("time", *given, made, "--json").out)["pierce_s"] == pytest.approx(7)
    assert "begun off the edge of the sheet at (-2.0, " in kerfwise("explain", *given, "a.json", "A.outer").out
    assert "begins off the sheet" in Path("a.svg").read_text()


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("travel_x: [-20, 3000], ", "", "no edge starts are offered: give machine.travel_x and machine.travel_y"),
        ("travel_x: [-20, 3000]", "travel_x: [0, 3000]", ""),
        ("leads: {edge_start: true}", "", ""),
    ],
)
def test_it_is_not_offered_where_the_machine_may_not_get_there(here: Path, old: str, new: str, said: str) -> None:
    given = ("near.json", "-p", "plant.yaml")
    kerfwise("solve", *given, "--work", 1, "-o", "edge.nc")
    Path("plant.yaml").write_text(PLANT.replace(old, new))
    done = kerfwise("solve", *given, "--work", 1, "-o", "a.nc")
    assert done.code == 0, done.err
    assert ", 1 pierce," in done.out
    assert said in done.err
    assert kerfwise("check", *given, "edge.nc").code == 1


def test_it_is_not_offered_from_an_edge_that_nobody_has_stated(here: Path) -> None:
    Path("near.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="300mm" height="90mm" viewBox="0 0 300 90">'
        '<path d="M 4 20 H 64 V 80 H 4 Z"/></svg>'
    )
    done = kerfwise("solve", "near.svg", "-p", "plant.yaml", "--work", 1, "-o", "a.nc")
    assert done.code == 0, done.err
    assert ", 1 pierce," in done.out
    assert "no edge starts are offered: nobody has stated where the sheet's edge is" in done.err
