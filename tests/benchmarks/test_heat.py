"""The benchmarks of heat, tried on little."""

from __future__ import annotations

import numpy as np
import pytest

from kerfwise.benchmarks.heat import EXAMPLES, bench, correlation, plant
from kerfwise.benchmarks.heat_speed import HEIGHT_MM, SECONDS, WIDTH_MM, up_and_down
from kerfwise.encoder.readers import read_nest
from kerfwise.models.heat.pair_prices import fit_pair_prices
from kerfwise.models.timing.constant import Leg, idle_mm


def test_a_row_of_the_correlation() -> None:
    case = bench("e1x_6", read_nest(EXAMPLES / "e1x_6.json"), plant(90.0))
    routes = case.random(range(100, 130))
    orders = [case.order(route) for route in routes]
    found = [case.overheats(route) for route in routes]
    prices = fit_pair_prices(case.facts.nest, case.profile.heat, orders, found.__getitem__)
    name, contours, _, mean, rho = (cell.strip() for cell in correlation(case, prices, 12).strip("|").split("|"))
    assert (name, contours) == ("e1x_6", "16")
    assert 30 < float(mean) < 120
    assert 0.2 < float(rho) <= 1.0


def test_idle_travel_is_that_of_the_clock() -> None:
    case = bench("e1x_6", read_nest(EXAMPLES / "e1x_6.json"), plant(90.0))
    (route,) = case.random(range(1))
    legs = [Leg(c.pierce, c.end, c.cut_mm) for c in (case.facts.candidates[k] for k in route)]
    assert case.idle_mm(route) == pytest.approx(idle_mm(legs, case.profile.machine.home))


def test_the_torch_goes_all_over_the_sheet() -> None:
    (burn,) = up_and_down(SECONDS).burns
    assert burn.seconds == SECONDS
    steps = np.abs(np.diff(burn.xy[1:], axis=0))
    assert np.all((steps == 0).any(axis=1))
    assert steps[:, 0].sum() == pytest.approx(WIDTH_MM - 30.0)
    assert steps[:, 1].sum() == pytest.approx(200 * (HEIGHT_MM - 20.0))
