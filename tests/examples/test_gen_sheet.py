from __future__ import annotations

import doctest
import itertools
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import shapely

import kerfwise
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
    made = kerfwise.read_nest(file)
    assert not made.notes
    metal = shapely.union_all([p.polygon for p in made.parts])
    assert metal.area == pytest.approx(sum(p.polygon.area for p in made.parts))
    assert made.sheet.polygon.contains(metal)
    facts = kerfwise.facts(made)
    assert len(facts.in_hull) > 0  # channels with a part in their mouth
    assert any(facts.parent[facts.nest.index[p.outer.id]] >= 0 for p in made.parts)  # frames that host parts


def test_with_a_web_straight_edges_in_a_column_are_so_far_apart(tmp_path: Path) -> None:
    apart, close = (polygons(make_sheet(1, 60, web_mm=web), tmp_path / f"{web}.json") for web in (None, 0.2))
    assert [p.area for p in apart] == pytest.approx([p.area for p in close], rel=1e-4)
    assert pair_gaps(apart) == {12.0}
    assert pair_gaps(close) == {0.2, 12.0}


def polygons(sheet: dict[str, Any], file: Path) -> list[shapely.Polygon]:
    file.write_text(json.dumps(sheet), encoding="utf-8")
    return [part.polygon for part in kerfwise.read_nest(file).parts]


def pair_gaps(parts: list[shapely.Polygon]) -> set[float]:
    """How far parts are apart, up to 12 mm."""
    gaps = {round(a.distance(b), 3) for a, b in itertools.combinations(parts, 2)}
    return {gap for gap in gaps if gap <= 12.0}


def test_as_a_program(tmp_path: Path) -> None:
    out = tmp_path / "sheet.json"
    command = [sys.executable, str(gen_sheet.__file__), "1", "30", str(out), "--width", "3000"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    sheet = json.loads(out.read_text(encoding="utf-8"))
    assert sheet == make_sheet(1, 30, (3000.0, 1500.0))
    assert done.stdout == f"{contour_count(sheet)} contours, {len(sheet['parts'])} parts\n"


def test_examples_in_docstrings_run() -> None:
    assert doctest.testmod(gen_sheet).failed == 0
