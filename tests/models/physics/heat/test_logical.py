"""The scheme of Verkhoturov et al. against steps worked out by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.models.physics.heat import simulate
from kerfwise.models.physics.heat.grid import make_grid
from kerfwise.models.physics.heat.simulate import LogicalSheet, spread
from kerfwise.rules.case import nest
from kerfwise.rules.profile.plant_sections import Heat
from kerfwise.tests.models.physics.heat.paths import along

LOGICAL = Heat(model="logical", grid_mm=10.0)


def field(*rows: tuple[float, ...]) -> np.ndarray:
    return np.array(rows, dtype=np.float32)


def test_one_hot_point_gives_to_its_eight_neighbours() -> None:
    """P = (800 - 8 · 80) · 0.5 and S = (0 + 80) · 0.5; what is warm only now waits for the next step."""
    sheet = field((0, 0, 0), (0, 800, 0), (0, 0, 0))
    spread(sheet, np.ones((3, 3), dtype=np.bool_), 0.1, 0.5)
    by_hand = np.zeros((3, 3))
    by_hand[1, 1] = 800.0
    give(by_hand, 1, 1, 0.1, 0.5)
    assert by_hand[1, 1] == pytest.approx(80.0)
    assert by_hand[0, 0] == pytest.approx(40.0)
    assert sheet == pytest.approx(by_hand)


def give(sheet: np.ndarray, i: int, j: int, conduction: float, retention: float) -> None:
    """What the paper says of one point, word for word."""
    around = [(u, v) for u in range(3) for v in range(3) if (u, v) != (i, j) and abs(u - i) < 2 and abs(v - j) < 2]
    delta = sheet[i, j] * conduction
    sheet[i, j] = (sheet[i, j] - delta * len(around)) * retention
    for u, v in around:
        sheet[u, v] = (sheet[u, v] + delta) * retention


def test_the_hottest_goes_first() -> None:
    sheet, by_hand = field((0, 100, 0), (0, 0, 0), (0, 0, 900)), np.zeros((3, 3))
    by_hand[0, 1], by_hand[2, 2] = 100, 900
    give(by_hand, 2, 2, 0.1, 0.9)
    give(by_hand, 0, 1, 0.1, 0.9)
    spread(sheet, np.ones((3, 3), dtype=np.bool_), 0.1, 0.9)
    assert sheet == pytest.approx(by_hand)


def test_only_metal_takes_heat() -> None:
    sheet, metal = field((0, 0, 0), (0, 800, 0), (0, 0, 0)), np.ones((3, 3), dtype=np.bool_)
    metal[0] = False
    spread(sheet, metal, 0.1, 1.0)
    assert sheet[0].tolist() == [0, 0, 0]
    assert sheet[1, 1] == pytest.approx(800 - 5 * 80)


def test_what_is_not_stable_is_refused_with_the_reason() -> None:
    with pytest.raises(InputError, match=r"0.13 for each of 8 neighbours is more than a point has.*up to 0.125"):
        LogicalSheet(make_grid(nest(100, 100), 10.0), replace(LOGICAL, logical_conduction=0.13))
    LogicalSheet(make_grid(nest(100, 100), 10.0), replace(LOGICAL, logical_conduction=0.125))


def test_points_under_the_torch_melt() -> None:
    result = simulate(nest(200, 100), along([(20, 55), (180, 55)], 0.0, 20.0), LOGICAL, 6.0)
    assert result.model == "logical"
    assert result.energy_error is None
    under = result.run.peak_c[2:18, 5]
    assert under == pytest.approx(1500.0)
    assert result.run.peak_c.max() == pytest.approx(1500.0)
    assert result.run.peak_c[5, 9] < 1500.0


def test_a_torch_that_stands_keeps_its_point_melted() -> None:
    frames: list[float] = []
    simulate(
        nest(200, 100),
        along([(105, 55)], 0.0, 30.0, 30.0),
        LOGICAL,
        6.0,
        (10.0, lambda now_s, field: frames.append(float(field[12, 5]))),
    )
    assert len(frames) == 3
    assert frames == sorted(frames)
