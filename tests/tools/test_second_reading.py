"""The second reading agrees with the first on the case drawings, and can tell when it does not."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.readers.options import ReadOptions
from kerfwise.encoder.readers.read import Seen
from kerfwise.tests.encoder.readers.drawings import lines, save_dxf, square
from kerfwise.tests.tools import second_reading
from kerfwise.tests.tools.amount import few
from kerfwise.tests.tools.second_reading import Judged, answered, judged, likeliest, planned

CASES = Path(__file__).parents[1] / "encoder" / "readers" / "cases"
REFUSED = ("63-dxf-comma-decimals.dxf",)
FILES = sorted(CASES.glob("*.*"), key=lambda file: (file.name not in REFUSED, int(file.name[:2]) % 3, file.name))
"""The one that is refused, and every third of the others, run always."""


@pytest.mark.parametrize("file", few(FILES, 1 + len(FILES) // 3), ids=lambda file: file.name)
def test_cases_are_read_as_other_programs_show_them(file: Path) -> None:
    row = judged(file, ReadOptions(kerf_mm=1.5))
    if file.name in REFUSED:
        assert row.ended == "refused"
    else:
        assert row == Judged(file, row.ended)


def test_dimensions_are_lines_to_others_and_are_said(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        lines(space, square(0, 0, 50))
        space.add_linear_dim((0, -20), (0, 0), (50, 0)).render()

    file = save_dxf(tmp_path, draw)
    assert judged(file, ReadOptions(kerf_mm=1.5)) == Judged(file, "planned")


def test_what_the_other_program_draws_coarsely_is_no_difference(tmp_path: Path) -> None:
    """GDAL takes even steps along splines, and cuts their corners; a layer that is off is said."""

    def draw(space: Any) -> None:
        space.add_arc((0, 0), 450, 0, 90)
        lines(space, [(0, 450), (0, 0), (450, 0)], closed=False)
        corners = [(100, 100), (160, 100), (220, 100), (220, 130), (220, 160), (160, 160), (100, 160), (100, 130)]
        knots = [0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4]
        space.add_spline().dxf.degree = 2
        spline = space[-1]
        spline.control_points, spline.knots = [(x, y, 0) for x, y in [*corners, corners[0]]], knots
        space.doc.layers.add("OFF").off()
        space.add_circle((300, 100), 20, dxfattribs={"layer": "OFF"})

    assert judged(save_dxf(tmp_path, draw), ReadOptions(kerf_mm=0.2)) == Judged(tmp_path / "drawing.dxf", "planned")


def test_a_file_without_a_page_is_compared_too(tmp_path: Path) -> None:
    file = tmp_path / "bare.svg"
    file.write_text('<svg xmlns="http://www.w3.org/2000/svg"><path d="M0 0H300V200H0Z"/></svg>', encoding="utf-8")
    assert judged(file, ReadOptions(kerf_mm=0.2)) == Judged(file, "asked (1)")


def test_a_small_picture_is_as_sharp_as_a_large_one(tmp_path: Path) -> None:
    file = tmp_path / "small.svg"
    frame = '<rect x="0.5" y="0.5" width="15.4" height="10.3" fill="none" stroke="black" stroke-width="0.05"/>'
    file.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 16.4 11.4">{frame}</svg>', encoding="utf-8")
    assert judged(file, ReadOptions(kerf_mm=0.2)) == Judged(file, "asked (1)")


def test_a_file_is_planned_with_the_first_answer_to_each_question() -> None:
    told = ["plate.dxf: the drawing raises 2 questions that nobody has answered:"]
    told += ["  1. frame: what is it?", "      --answer frame=part    a part", "      --answer frame=sheet   the sheet"]
    told += ["  2. layer:a b: what are they for?", '      --answer "layer:a b=mark"   marked']
    assert likeliest("\n".join(told)) == ["frame=part", "layer:a b=mark"]
    made = planned(CASES / "51-dxf-plate-and-holes-layers.dxf", "plasma-carbon-steel")
    assert (made.ended, made.answers, made.said[:2]) == ("planned", 1, "ok")


@pytest.mark.parametrize("name", ["05-svg-illustrator-points.svg", "31-dxf-corners-overrun.dxf"])
@pytest.mark.parametrize("change", ["a line is forgotten", "a line is invented"])
def test_the_comparison_can_fail(name: str, change: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def otherwise(file: Path, options: ReadOptions) -> tuple[Seen, int]:
        found, count = answered(file, options)
        longest = max(found.lines, key=lambda row: row[1].length_mm)
        if change == "a line is forgotten":
            return replace(found, lines=tuple(row for row in found.lines if row is not longest)), count
        x0, y0, x1, y1 = longest[1].line().bounds
        return replace(found, lines=(*found.lines, ("cut", Curve.of([(x0, y0), (x1, y1)], closed=False)))), count

    monkeypatch.setattr(second_reading, "answered", otherwise)
    row = judged(CASES / name, ReadOptions(kerf_mm=1.5))
    assert (row.unseen_mm > 0, row.unshown_mm > 0) == (change == "a line is forgotten", change == "a line is invented")
