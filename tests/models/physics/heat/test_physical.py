"""The heat equation against what can be computed by hand: a point source in an infinite plate, energy, a free part."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.models.physics.heat.physical import SheetSimulation, run_physical, time_step_s
from kerfwise.models.physics.heat.simulate import run_logical
from kerfwise.models.physics.heat.timed_path import HeatRun, events_of, in_order, make_grid
from kerfwise.rules.case import nest
from kerfwise.rules.profile.plant_sections import MATERIALS, Heat
from kerfwise.tests.models.physics.heat.paths import along, beside, circle, rounds
from kerfwise.tests.tools.amount import examples

STEEL = MATERIALS["carbon-steel"]
NO_LOSS = Heat(absorbed_power_w=1e6, loss_w_m2k=0.0, grid_mm=4.0)


@pytest.mark.parametrize("loss_w_m2k", [0.0, 400.0])
@pytest.mark.parametrize("after_s", [15.0, 40.0])
def test_instant_point_source_in_an_infinite_plate(after_s: float, loss_w_m2k: float) -> None:
    """T = Q / (4 π k g t) · exp(-r² / 4 α t - 2 h t / ρ c g), Carslaw and Jaeger 1959, 10.3."""
    energy_j, thickness_mm, alpha = 1e4, 6.0, STEEL.diffusivity_mm2_s
    heat = replace(NO_LOSS, loss_w_m2k=loss_w_m2k)
    grid = make_grid(nest(600, 600), heat.grid_mm)
    sheet = SheetSimulation(grid, heat, thickness_mm)
    x = grid.x0_mm + heat.grid_mm * np.arange(grid.shape[0])
    y = grid.y0_mm + heat.grid_mm * np.arange(grid.shape[1])
    sheet.run(events_of(along([(x[75], y[75])], 0.0, 0.01, 0.01), grid), after_s)
    t = sheet.now_s
    r2 = (x[:, None] - x[75]) ** 2 + (y[None, :] - y[75]) ** 2
    fade = math.exp(-2 * loss_w_m2k * 1e-6 * t / (STEEL.capacity_j_mm3 * thickness_mm))
    middle_k = energy_j / (4 * math.pi * STEEL.conductivity * 1e-3 * thickness_mm * t)
    exact = middle_k * fade * np.exp(-r2 / (4 * alpha * t))
    found = sheet.temperature_c() - heat.ambient_c
    assert np.abs(found - exact).max() < 0.03 * exact.max()
    assert t == pytest.approx(after_s, abs=time_step_s(heat))


@pytest.mark.parametrize("material", MATERIALS)
def test_energy_put_in_is_in_the_sheet_or_in_the_air(material: str) -> None:
    heat = Heat(material=material, absorbed_power_w=900.0, loss_w_m2k=40.0)
    path = rounds([circle(100, 100, 60), circle(250, 100, 40), [(20, 20), (380, 20), (380, 180), (20, 180)]], 20.0)
    run = run_physical(make_grid(nest(400, 200), 5.0), path, heat, 6.0, None)
    assert run.put_in_j == pytest.approx(900.0 * path.seconds_on, rel=1e-6)
    assert run.lost_j > 0
    assert run.stored_j + run.lost_j == pytest.approx(run.put_in_j, rel=0.01)


def test_without_loss_all_energy_stays() -> None:
    run = run_physical(make_grid(nest(300, 300), 4.0), along([(50, 150), (250, 150)], 0.0, 5.0), NO_LOSS, 6.0, None)
    assert run.lost_j == 0
    assert run.stored_j == pytest.approx(5e6, rel=1e-4)


def test_a_part_that_is_cut_free_keeps_its_heat() -> None:
    """The inner ring heats the part; once the outer ring is cut, what is in it stays in it."""
    ring = [(100.0, 100.0), (200.0, 100.0), (200.0, 200.0), (100.0, 200.0)]
    heat = replace(NO_LOSS, absorbed_power_w=2000.0)
    grid = make_grid(nest(300, 300), heat.grid_mm)
    sheet = SheetSimulation(grid, heat, 6.0)
    events = events_of(rounds([circle(150, 150, 20), ring], 50.0), grid)
    x = grid.x0_mm + heat.grid_mm * np.arange(grid.shape[0])
    y = grid.y0_mm + heat.grid_mm * np.arange(grid.shape[1])
    inside = ((x > 100) & (x < 200))[:, None] & ((y > 100) & (y < 200))[None, :]
    means = []
    for until_s in (15.0, 60.0, 300.0):
        sheet.run(events, until_s)
        excess = sheet.temperature_c() - heat.ambient_c
        means.append((float(excess[inside].mean()), float(excess[~inside].mean())))
    (part, around), (part_later, around_later), (part_last, around_last) = means
    assert part > 2 * around
    assert part_last == pytest.approx(part_later, rel=1e-4) == pytest.approx(part, rel=1e-4)
    assert around_last == pytest.approx(around_later, rel=1e-4) == pytest.approx(around, rel=1e-4)


@examples(40)
@given(
    st.lists(st.tuples(st.floats(20, 180), st.floats(20, 180)), min_size=3, max_size=8),
    st.floats(0.5, 3.0),
)
def test_a_closed_path_cuts_every_link_between_inside_and_outside(
    corners: list[tuple[float, float]], shift: float
) -> None:
    """Every round of links crosses a closed path an even number of times, wherever the path lies on the grid."""
    grid = make_grid(nest(200, 200), 5.0)
    points = [*corners, corners[0]]
    events = events_of(along([(x + shift, y) for x, y in points], 0.0, 10.0), grid)
    nx, ny = grid.shape
    crossed_x, crossed_y = np.zeros((nx, ny), dtype=int), np.zeros((nx, ny), dtype=int)
    for link, along_y in zip(events.link.tolist(), events.along_y.tolist(), strict=True):
        (crossed_y if along_y else crossed_x)[divmod(link, ny)] += 1
    loops = crossed_x[:-1, :-1] + crossed_y[1:, :-1] + crossed_x[:-1, 1:] + crossed_y[:-1, :-1]
    assert not (loops % 2).any()


def test_heat_stays_on_its_side_of_the_kerf() -> None:
    """A straight cut gives half of its heat to each side wherever it lies; little flows across ahead of the torch."""
    grid = make_grid(nest(200, 100), 5.0)
    for y in (50.0, 51.0, 52.5, 54.9):
        sheet = SheetSimulation(grid, NO_LOSS, 6.0)
        sheet.run(events_of(along([(-10, y), (210, y)], 0.0, 1.0), grid), 400.0)
        excess = sheet.temperature_c() - NO_LOSS.ambient_c
        below = grid.y0_mm + 5.0 * np.arange(grid.shape[1]) <= y
        assert excess[:, below].sum() == pytest.approx(excess[:, ~below].sum(), rel=0.01)


def test_steps_keep_their_results_whatever_the_looks_between() -> None:
    path, grid = rounds([circle(100, 60, 40), circle(200, 60, 30)], 30.0), make_grid(nest(300, 120), 5.0)
    seen: list[float] = []
    plain = run_physical(grid, path, Heat(), 6.0, None)
    looked = run_physical(grid, path, Heat(), 6.0, (2.0, lambda now_s, field: seen.append(now_s)))
    assert np.array_equal(plain.peak_c, looked.peak_c)
    assert np.array_equal(plain.above_s, looked.above_s)
    assert len(seen) > 5


def test_two_torches_put_in_at_one_time_what_each_of_them_does() -> None:
    """Nothing is cut by a torch that stands, so that temperatures add up."""
    heat, away = replace(NO_LOSS, absorbed_power_w=2000.0), (120.0, 40.0)
    grid, one = make_grid(nest(400, 300), heat.grid_mm), along([(120.0, 120.0)], 1.0, 9.0, 8.0)
    other = along([(120.0 + away[0], 120.0 + away[1])], 1.0, 9.0, 8.0)
    after = []
    for path in (one, other, beside(one, away)):
        sheet = SheetSimulation(grid, heat, 6.0)
        sheet.run(events_of(path, grid), 20.0)
        after.append(sheet.temperature_c() - heat.ambient_c)
    assert after[2].max() > 20
    assert np.abs(after[0] + after[1] - after[2]).max() < 1e-4 * after[2].max()


@pytest.mark.parametrize("model", [run_physical, run_logical])
def test_two_torches_far_apart_leave_what_each_leaves_by_itself(model: Callable[..., HeatRun]) -> None:
    heat, ring = Heat(absorbed_power_w=2000.0, loss_w_m2k=0.0, grid_mm=5.0), circle(100, 100, 40)
    grid, path, away = make_grid(nest(1200, 200), 5.0), rounds([ring, circle(100, 100, 70)], 10.0), (1000.0, 0.0)
    both, left, right = (
        model(grid, some, heat, 6.0, None).peak_c
        for some in (beside(path, away), path, in_order([burn.by(1, burn.contour, away) for burn in path.burns], 0.0))
    )
    assert left.max() > 40
    assert both == pytest.approx(np.maximum(left, right), abs=0.5)
