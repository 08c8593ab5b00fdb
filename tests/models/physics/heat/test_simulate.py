"""What counts as an overheat, where, and for how long."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.models.physics.heat import simulate
from kerfwise.models.physics.heat.grid import SCRAP, make_grid
from kerfwise.models.physics.heat.timed_path import TimedPath, in_order, torch_on
from kerfwise.rules.case import circle as drawn_circle
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.profile.plant_sections import Heat
from kerfwise.tests.models.physics.heat.paths import along, circle, rounds

HEAT = Heat(absorbed_power_w=2000.0, kerf_band_mm=10.0, limit_c=100.0)
PLATE = nest(
    400, 200, part("A", rect(20, 20, 160, 160), [drawn_circle(100, 100, 40)]), part("B", rect(220, 20, 160, 160))
)


def test_points_know_their_part_and_what_is_scrap() -> None:
    grid = make_grid(PLATE, 10.0)
    x = grid.x0_mm + 10.0 * np.arange(grid.shape[0])
    assert grid.part[np.abs(x - 30).argmin(), 10] == 0
    assert grid.part[np.abs(x - 100).argmin(), 10] == SCRAP
    assert grid.part[np.abs(x - 300).argmin(), 10] == 1
    assert grid.part[np.abs(x - 200).argmin(), 10] == -1
    assert grid.metal.sum() * 100 == pytest.approx(400 * 200, rel=0.06)


def test_nothing_cut_nothing_hot() -> None:
    result = simulate(PLATE, TimedPath((), 0.0), HEAT, 6.0)
    assert (result.overheats, result.peak_c, result.energy_error) == (0, 20.0, 0.0)
    assert [part.peak_c for part in result.parts] == [20.0, 20.0]


def test_the_band_of_the_kerf_and_scrap_do_not_count() -> None:
    """A slow cut round the hole makes its slug far hotter than the part around it."""
    result = simulate(PLATE, rounds([circle(100, 100, 39)], 10.0), HEAT, 6.0)
    hot = result.run.peak_c > HEAT.limit_c
    assert hot[result.grid.part == SCRAP].any()
    assert not (result.counted & (result.grid.part == SCRAP)).any()
    far = np.hypot(
        result.grid.x0_mm + 5.0 * np.arange(result.grid.shape[0])[:, None] - 100,
        result.grid.y0_mm + 5.0 * np.arange(result.grid.shape[1])[None, :] - 100,
    )
    assert not result.counted[np.abs(far - 39) < 9.9].any()
    assert result.overheats == int((hot & (far > 49) & (result.grid.part != SCRAP)).sum()) > 0
    assert [part.overheats for part in result.parts] == [result.overheats, 0]
    assert result.parts[0].above_s == result.above_s > 0
    assert result.parts[0].peak_c == result.peak_c > HEAT.limit_c


def test_two_cuts_side_by_side_are_hotter_the_sooner_they_follow() -> None:
    lines = ([(205.0, 10.0), (205.0, 190.0)], [(235.0, 190.0), (235.0, 10.0)])

    def after(pause_s: float) -> TimedPath:
        first, second = (np.array(line) for line in lines)
        begin_s = 5.0 + pause_s
        return in_order([torch_on("a", first, 0.0, 5.0), torch_on("b", second, begin_s, begin_s + 5.0)], begin_s + 5.0)

    soon, late = (simulate(PLATE, after(pause_s), HEAT, 6.0) for pause_s in (0.0, 120.0))
    assert soon.peak_c > late.peak_c + 10
    assert soon.overheats > late.overheats


def test_no_power_no_heat() -> None:
    result = simulate(PLATE, rounds([circle(100, 100, 39)], 10.0), replace(HEAT, absorbed_power_w=0.0), 6.0)
    assert (result.overheats, result.peak_c, result.energy_error) == (0, 20.0, 0.0)


def test_a_grid_too_fine_is_refused() -> None:
    with pytest.raises(InputError, match=r"heat.grid: 0.01 mm makes"):
        simulate(PLATE, along([(0, 0), (1, 1)], 0, 1), replace(HEAT, grid_mm=0.01), 6.0)


def test_cuts_that_overlap_in_time_are_refused() -> None:
    point = np.zeros((1, 2))
    with pytest.raises(InputError, match=r"b begins at 3.00 s, before a ends at 5.00 s"):
        in_order([torch_on("a", point, 0.0, 5.0), torch_on("b", point, 3.0, 6.0)], 6.0)
    with pytest.raises(InputError, match=r"a is said to end at 4 s, before it begins at 5 s"):
        torch_on("a", point, 5.0, 4.0)


def test_a_part_that_lies_in_the_band_with_all_its_points_has_no_temperature() -> None:
    plate = nest(400, 200, part("wide", rect(20, 20, 160, 160)), part("narrow", rect(220, 20, 14, 160)))
    squares = [(20.0, 20.0), (180.0, 20.0), (180.0, 180.0), (20.0, 180.0)], [(220.0, 20.0), (234.0, 20.0),
               (234.0, 180.0), (220.0, 180.0)]  # fmt: skip
    path = rounds(squares, 40.0)
    wide, narrow = simulate(plate, path, HEAT, 6.0).parts
    assert wide.peak_c is not None
    assert (narrow.peak_c, narrow.overheats) == (None, 0)


def test_a_grid_that_is_too_coarse_for_the_nest_is_refused() -> None:
    path = rounds([circle(100, 100, 39)], 10.0)
    with pytest.raises(InputError, match=r"no point of the grid counts: all lie within 1500 mm of a cut"):
        simulate(PLATE, path, replace(HEAT, grid_mm=1000.0), 6.0)
    assert simulate(PLATE, path, replace(HEAT, grid_mm=1000.0, absorbed_power_w=0.0), 6.0).overheats == 0
