"""kerfwise distort: the table, the JSON, the picture, and what it refuses."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

import kerfwise as package
from kerfwise.tests.commands.run_cli import kerfwise

NESTS = Path(package.__file__).parent / "examples" / "nests"
NEST = NESTS / "e1x_6.json"
COARSE, COARSER = ("--grid", "16 mm"), ("--grid", "40 mm")


@pytest.fixture(scope="module")
def plan(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("plan")
    done = kerfwise("solve", NEST, "--work", 1, "-o", folder / "e.nc", "--plan", folder / "e.json")
    assert done.code == 0, done.err
    return folder / "e.json"


@pytest.fixture(scope="module")
def found(plan: Path) -> Any:
    """What the command line says of the plan, as JSON."""
    done = kerfwise("distort", NEST, plan, *COARSE, "--json")
    assert done.code == 0, done.err
    return json.loads(done.out)


def test_the_json_has_every_part_and_no_more(found: Any) -> None:
    assert list(found) == ["grid_mm", "parts"]
    assert found["grid_mm"] == 16
    nest = json.loads(NEST.read_text())
    assert [row["part"] for row in found["parts"]] == [p["id"] for p in nest["parts"]]
    for row in found["parts"]:
        assert list(row) == ["part", "max_mm", "rms_mm", "at"]
        assert 0 < row["rms_mm"] < row["max_mm"] < 0.5
        assert 0 <= row["at"][0] <= nest["sheet"]["width"]


def test_a_program_is_off_as_its_plan_is(plan: Path, found: Any) -> None:
    by_program = json.loads(kerfwise("distort", NEST, plan.with_suffix(".nc"), *COARSE, "--json").out)
    for one, other in zip(found["parts"], by_program["parts"], strict=True):
        assert other["max_mm"] == pytest.approx(one["max_mm"], rel=0.1, abs=0.004)


def test_the_table_begins_with_the_worst_part(plan: Path, tmp_path: Path) -> None:
    picture = tmp_path / "parts.svg"
    done = kerfwise("distort", NEST, plan, *COARSE, "-o", picture)
    assert done.code == 0, done.err
    lines = done.out.splitlines()
    assert lines[0] == "model      plane stress, metal yields beside the cut, grid 16 mm"
    worst = float(lines[1].split()[1])
    assert lines[3].startswith("size       too small by 0.")
    assert lines[4].startswith("would be   0.")
    assert float(lines[7].split()[1]) == worst
    drawn = ElementTree.fromstring(picture.read_bytes())
    words = [text.text or "" for text in drawn.iter("{http://www.w3.org/2000/svg}text")]
    assert any("times as far off as they are" in text for text in words)
    assert sum(text.startswith(("part#", "NC20")) for text in words) == 8


def test_elastic_metal_does_not_yield(plan: Path) -> None:
    done = kerfwise("distort", NEST, plan, *COARSER, "--elastic")
    assert done.out.startswith("model      plane stress, elastic, grid 40 mm\n")


def test_what_is_wrong_is_told_in_one_line(plan: Path, tmp_path: Path) -> None:
    for argv, told in (
        ((NESTS / "plate40.json", plan), "another nest"),
        ((NEST, plan, "--grid", "0.01 mm"), "60000 is the most: give 1.9 mm or more"),
        ((NEST, plan, "--grid", "400 mm"), "give 75 mm or less"),
        ((NEST, plan, "--grid", "wide"), "--grid 'wide'"),
        ((NEST, plan, "-o", tmp_path / "parts.png"), "give a name ending in .svg"),
        ((NEST, plan, "-p", "laser-wood"), "plywood has no modulus"),
        ((NEST,), "Missing argument 'PLAN.json|OUT.nc'"),
        ((NEST, tmp_path / "none.json"), "none.json"),
    ):
        done = kerfwise("distort", *argv)
        assert (done.code, done.out) == (2, ""), argv
        assert told in done.err
        assert "Traceback" not in done.err


def test_water_bends_nothing(plan: Path) -> None:
    given = kerfwise("distort", NEST, plan, *COARSER, "-p", "water-jet", "--json")
    assert all(row["max_mm"] == 0 for row in json.loads(given.out)["parts"])


def test_a_plan_in_memory(plan: Path) -> None:
    off = package.distort(NEST, package.read_plan(plan), grid_mm=40.0)
    assert 0 < off.mean_mm <= off.max_mm < 0.5


def test_python_asks_as_the_command_line_does(plan: Path, found: Any) -> None:
    off = package.distort(NEST, plan, grid_mm=16.0)
    assert off.as_json() == found
    assert repr(off).startswith("<Distortion: worst 0.")
