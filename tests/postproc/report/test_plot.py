"""Files: every type, whole or not at all, and clear words where it cannot be."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import matplotlib.image
import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.postproc.report import draw, labels, picture, plot, plot_spot
from kerfwise.rules.case import nest, part, rect
from kerfwise.tests.postproc.report.plausible import plate, plausible_plan


@pytest.fixture(name="plate")
def a_plate() -> Nest:
    return plate()


def crowded(parts: int) -> Nest:
    across = 40
    cells = [(12 * (k % across), 12 * (k // across)) for k in range(parts)]
    return nest(
        480, 12 * (parts // across + 1), *(part(f"P{k}", rect(x + 1, y + 1, 10, 10)) for k, (x, y) in enumerate(cells))
    )


def test_a_png_opens_and_has_a_sensible_size(plate: Nest, tmp_path: Path) -> None:
    plot(plate, plausible_plan(plate), tmp_path / "plan.PNG")
    pixels = matplotlib.image.imread(tmp_path / "plan.PNG")
    height, width = pixels.shape[:2]
    assert 1200 <= width <= 4000
    assert 0.5 < height / width < 0.75
    assert pixels.std() > 0.05


@pytest.mark.slow
def test_a_png_grows_with_the_number_of_contours(plate: Nest) -> None:
    few, many = (draw(n, plausible_plan(n), ".png") for n in (plate, crowded(400)))
    widths = [int.from_bytes(data[16:20], "big") for data in (few, many)]
    assert widths[0] < widths[1] <= 4000


def test_the_same_plan_gives_the_same_png(plate: Nest) -> None:
    assert draw(plate, plausible_plan(plate), ".png") == draw(plate, plausible_plan(plate), ".png")
    assert draw(plate, plausible_plan(plate), ".png") != draw(plate, None, ".png")


@pytest.mark.parametrize("suffix", [".svg", ".png", ".html"])
def test_every_type_can_be_drawn_without_a_plan(plate: Nest, tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"nest{suffix}"
    plot(plate, None, path)
    assert path.stat().st_size > 1000
    assert [p.name for p in tmp_path.iterdir()] == [path.name]


@pytest.mark.parametrize("name", ["plan.eps", "plan", "plan.svgz"])
def test_another_suffix_is_refused_with_those_there_are(plate: Nest, tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError, match=r"\.svg, \.png, \.pdf, \.html"):
        plot(plate, None, tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_is_not_there_is_said(plate: Nest, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"cannot write.*No such file"):
        plot(plate, None, tmp_path / "nowhere" / "plan.svg")


def test_on_failure_the_old_picture_stays(plate: Nest, tmp_path: Path) -> None:
    path = tmp_path / "plan.svg"
    plot(plate, None, path)
    before = path.read_bytes()
    other = nest(600, 300, part("Z", rect(20, 20, 200, 200)))
    with pytest.raises(InputError, match=r"cut 1 is of 'Z\.outer', which is no contour of it"):
        plot(plate, plausible_plan(other), path)
    assert path.read_bytes() == before
    assert [p.name for p in tmp_path.iterdir()] == ["plan.svg"]


def test_a_spot_is_written_too(plate: Nest, tmp_path: Path) -> None:
    plot_spot(plate, ["A.hole1"], tmp_path / "spot.png", "here")
    assert matplotlib.image.imread(tmp_path / "spot.png").shape[1] >= 1200
    with pytest.raises(InputError, match=r"no contour 'A\.hole9'"):
        plot_spot(plate, ["A.hole9"], tmp_path / "spot.svg")
    with pytest.raises(InputError, match="name at least one"):
        plot_spot(plate, [], tmp_path / "spot.svg")


@pytest.mark.slow
def test_a_thousand_contours_are_all_numbered() -> None:
    plate = crowded(1000)
    svg = draw(plate, plausible_plan(plate), ".svg").decode()
    numbers = svg[svg.index('<g id="numbers">') : svg.index('<g id="header">')]
    assert sorted(map(int, re.findall(r">(\d+)</text>", numbers))) == list(range(1, 1001))


def test_a_picture_is_the_same_with_what_was_found_out_before(plate: Nest, monkeypatch: pytest.MonkeyPatch) -> None:
    plan = plausible_plan(plate)
    plain = draw(plate, plan, ".svg")
    assert plain != draw(replace(plate), None, ".svg")
    known = replace(plate)
    picture.prepare(known)
    looked: list[int] = []
    free = labels._free_metals
    monkeypatch.setattr(labels, "_free_metals", lambda parts, *more: looked.append(len(parts)) or free(parts, *more))
    assert draw(known, plan, ".svg") == plain
    assert len(plate.parts) not in looked
    draw(replace(plate), plan, ".svg")
    assert len(plate.parts) in looked
