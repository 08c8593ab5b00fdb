from __future__ import annotations

import doctest
import json
import subprocess
import sys
from pathlib import Path

import pytest
import shapely

from kerfwise.encoder.facts import FactOptions, compute_facts
from kerfwise.encoder.readers import read_nest
from kerfwise.examples import gen_sheet
from kerfwise.examples.gen_sheet import contour_count, make_sheet, sheet_size_mm


@pytest.mark.slow
@pytest.mark.parametrize("contours", [1, 60, 400, 10_000])
def test_makes_as_many_contours_as_asked(contours: int) -> None:
    sheet = make_sheet(1, contours)
    assert contours <= contour_count(sheet) <= contours + 3  # the last cell may hold a host with its guest
    assert (sheet["sheet"]["width"], sheet["sheet"]["height"]) == sheet_size_mm(contours)


def test_stops_when_the_sheet_is_full() -> None:
    assert 0 < contour_count(make_sheet(1, 1000, (1000, 1000))) < 100


def test_the_same_seed_makes_the_same_sheet() -> None:
    assert make_sheet(3, 80) == make_sheet(3, 80) != make_sheet(4, 80)


def test_parts_lie_on_the_sheet_and_not_on_each_other(tmp_path: Path) -> None:
    file = tmp_path / "sheet.json"
    file.write_text(json.dumps(make_sheet(5, 150)), encoding="utf-8")
    made = read_nest(file)
    assert not made.notes
    metal = shapely.union_all([p.polygon for p in made.parts])
    assert metal.area == pytest.approx(sum(p.polygon.area for p in made.parts))
    assert made.sheet.polygon.contains(metal)
    facts = compute_facts(made, FactOptions())
    assert len(facts.in_hull) > 0  # channels with a part in their mouth
    assert any(facts.parent[facts.nest.index[p.outer.id]] >= 0 for p in made.parts)  # frames that host parts


def test_as_a_program(tmp_path: Path) -> None:
    out = tmp_path / "sheet.json"
    command = [sys.executable, str(gen_sheet.__file__), "1", "30", str(out), "--width", "3000"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    sheet = json.loads(out.read_text(encoding="utf-8"))
    assert sheet == make_sheet(1, 30, (3000.0, 1500.0))
    assert done.stdout == f"{contour_count(sheet)} contours, {len(sheet['parts'])} parts\n"


def test_examples_in_docstrings_run() -> None:
    assert doctest.testmod(gen_sheet).failed == 0
