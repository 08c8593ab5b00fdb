"""Maps of temperatures: what is too hot is blue, what is not counted grey, contours can be seen, and the limit."""

from __future__ import annotations

import io

import matplotlib.image
import numpy as np
import pytest
from numpy.typing import NDArray

from kerfwise.apps.heat.simulation import HeatPicture, peak_map
from kerfwise.models.physics.heat import simulate
from kerfwise.models.physics.heat.timed_path import in_order, make_grid, torch_on
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.rules.profile.plant_sections import Heat

PLATE = nest(400, 200, part("A", rect(40, 40, 200, 120), [circle(140, 100, 30)]))
GRID = make_grid(PLATE, 5.0)
HOT, BAND, SCRAP = (0x2F, 0xB4, 0xFF), (0x8F, 0x95, 0x9C), (0xD0, 0xD4, 0xD8)


@pytest.fixture(autouse=True)
def _small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fewer pixels, which are enough to count and quicker to draw."""
    monkeypatch.setattr("kerfwise.apps.heat.simulation.DPI", 60)


def pixels(png: bytes) -> NDArray[np.uint8]:
    return (matplotlib.image.imread(io.BytesIO(png))[:, :, :3] * 255 + 0.5).astype(np.uint8)


def count(png: bytes, colour: tuple[int, int, int]) -> int:
    return int((pixels(png) == colour).all(axis=2).sum())


def bluish(png: bytes) -> int:
    """Pixels of a thin blue line, mixed with what is below it; the colours of temperatures have more red by then."""
    image = pixels(png).astype(int)
    return int(((image[:, :, 2] > image[:, :, 0] + 70) & (image[:, :, 1] > 110)).sum())


def field(hot_points: int) -> NDArray[np.float32]:
    made = np.full(GRID.shape, 20.0, dtype=np.float32)
    made[60 : 60 + hot_points, 10 : 10 + hot_points] = 500.0
    return made


@pytest.mark.slow
def test_what_is_too_hot_is_blue_and_as_large_as_it_is() -> None:
    picture = HeatPicture(PLATE, GRID, 20.0, 100.0)
    none, few, many = (count(picture.png(field(n), "t", GRID.metal), HOT) for n in (0, 4, 8))
    assert none < few < many
    assert (many - none) / (few - none) == pytest.approx(64 / 16, rel=0.15)


@pytest.mark.slow
def test_a_frame_has_the_limit_as_a_line() -> None:
    picture = HeatPicture(PLATE, GRID, 20.0, 100.0)
    none, some = (bluish(picture.png(field(n), "t")) for n in (0, 8))
    assert 20 < some - none < 500
    assert count(picture.png(field(8), "t"), BAND) == 0


@pytest.mark.slow
def test_the_kerfs_band_and_scrap_are_grey_in_the_map_of_a_program() -> None:
    ring = PLATE.contour("A.hole1").curve.flatten(0.2)
    path = in_order([torch_on("A.hole1", np.concatenate([ring, ring[:1]]), 0.0, 5.0)], 5.0)
    png = peak_map(PLATE, simulate(PLATE, path, Heat(), 6.0), 20.0)
    assert count(png, BAND) > 500
    assert count(png, SCRAP) > 500
    assert png == peak_map(PLATE, simulate(PLATE, path, Heat(), 6.0), 20.0)


def test_a_sheet_of_one_point_can_be_drawn() -> None:
    grid = make_grid(PLATE, 5000.0)
    hot = np.full(grid.shape, 500.0, dtype=np.float32)
    assert HeatPicture(PLATE, grid, 20.0, 100.0).png(hot, "t", grid.metal).startswith(b"\x89PNG")
