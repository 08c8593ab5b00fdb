"""What counts as an overheat, where, and for how long."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kerfwise import InputError
from kerfwise.models.physics.heat import HeatResult, simulate
from kerfwise.models.physics.heat.simulate import LogicalSheet, spread
from kerfwise.models.physics.heat.timed_path import (
    SCRAP,
    Regions,
    TimedPath,
    hot_contours,
    in_order,
    make_grid,
    torch_on,
)
from kerfwise.rule_kit import circle as drawn_circle
from kerfwise.rule_kit import nest, part, rect
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


ROW = nest(500, 120, part("A", rect(20, 20, 60, 60), marks=[[(40, 60), (70, 60)]]), part("B", rect(400, 20, 60, 60)))


def burnt(x: float, limit_c: float) -> HeatResult:
    """Twice round a square of 62 mm whose left side is at x."""
    ring = [(x, 19.0), (x + 62, 19.0), (x + 62, 81.0), (x, 81.0)]
    return simulate(ROW, rounds([ring, ring], 20.0), Heat(limit_c=limit_c, absorbed_power_w=2500.0), 6.0)


def test_marks_are_not_hot() -> None:
    assert [ROW.contours[k].id for k in hot_contours(ROW)] == ["A.outer", "B.outer"]


def test_overheats_are_counted_where_they_are() -> None:
    regions = Regions(ROW, make_grid(ROW, Heat().grid_mm))
    for x, name in ((19.0, "A.outer"), (399.0, "B.outer")):
        found = burnt(x, 80.0)
        counts = regions.count(found)
        assert counts[ROW.index[name]] == counts.sum() == found.overheats > 0
    assert np.array_equal(regions.count(burnt(19.0, 5000.0)), [0, 0, 0])
