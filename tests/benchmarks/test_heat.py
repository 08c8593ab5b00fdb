"""The benchmarks of heat, tried on little."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from kerfwise.benchmarks.heat import EXAMPLES, bench, correlation, plant
from kerfwise.benchmarks.heat_speed import HEIGHT_MM, PLANT, SECONDS, WIDTH_MM, run, up_and_down
from kerfwise.encoder.readers import read_nest
from kerfwise.jobs.heat_control import cooler_orders
from kerfwise.models.engines.baselines import random_order
from kerfwise.models.physics.motion import Leg, idle_mm


@pytest.mark.full
def test_a_row_of_the_correlation(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("kerfwise.jobs.cooler_orders.ORDERS", 60)
    case = bench("e1x_6", read_nest(EXAMPLES / "e1x_6.json"), plant(90.0))
    cooler = cooler_orders(case.facts, case.profile, case.stated)
    cooler.start()
    name, contours, _, mean, rho = (cell.strip() for cell in correlation(case, cooler, 20).strip("|").split("|"))
    assert (name, contours) == ("e1x_6", "16")
    assert 30 < float(mean) < 120
    assert 0.2 < float(rho) <= 1.0


def test_idle_travel_is_that_of_the_clock() -> None:
    case = bench("e1x_6", read_nest(EXAMPLES / "e1x_6.json"), plant(90.0))
    route = case.candidates(random_order(case.problem, 0))
    assert case.broken(route) == 0
    assert case.broken(route[::-1]) > 0
    legs = [Leg(c.pierce, c.end, c.cut_mm) for c in (case.facts.candidates[k] for k in route)]
    assert case.idle_mm(route) == pytest.approx(idle_mm(legs, case.profile.machine.home))


def test_the_torch_goes_all_over_the_sheet() -> None:
    (burn,) = up_and_down(SECONDS).burns
    assert burn.seconds == SECONDS
    steps = np.abs(np.diff(burn.xy[1:], axis=0))
    assert np.all((steps == 0).any(axis=1))
    assert steps[:, 0].sum() == pytest.approx(WIDTH_MM - 30.0)
    assert steps[:, 1].sum() == pytest.approx(200 * (HEIGHT_MM - 20.0))


@pytest.mark.slow
def test_a_command_is_measured_alone(tmp_path: Path) -> None:
    plant = tmp_path / "plant.yaml"
    plant.write_text(PLANT, encoding="utf-8")
    ran = run("profile", "check", str(plant))
    assert ran.text.startswith("plant: fine")
    assert 0 < ran.cpu_s < 60
    assert 10 < ran.memory_mb < 4000
    with pytest.raises(RuntimeError, match="profile check nobody failed"):
        run("profile", "check", "nobody")
