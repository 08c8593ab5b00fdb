"""Benchmarks of heat and distortion."""

from __future__ import annotations

from itertools import islice
from pathlib import Path

import numpy as np
import pytest

from kerfwise.benchmarks.distortion import HELD, camber, literature, over_mm, strips, zones
from kerfwise.benchmarks.distortion_limits import BRIDGE_MM, bridged, waiting
from kerfwise.benchmarks.distortion_rules import BARE, PROCESSES, bare, last_first, made_nest, turned
from kerfwise.benchmarks.heat import EXAMPLES, bench, correlation, plant
from kerfwise.benchmarks.heat_speed import HEIGHT_MM, PLANT, SECONDS, WIDTH_MM, run, up_and_down
from kerfwise.encoder.readers import read_nest
from kerfwise.jobs.heat_control import cooler_orders
from kerfwise.models.engines.baselines import random_order
from kerfwise.models.physics.heat.timed_path import in_order, torch_on
from kerfwise.models.physics.motion import Leg, idle_mm
from kerfwise.rules.profile.load import load_profile


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


def test_turned_burns_take_as_long_and_end_where_they_began() -> None:
    way = np.array([[0.0, 0.0], [30.0, 0.0], [30.0, 10.0]])
    path = in_order([torch_on("A.outer", way, 5.0, 9.0, 1.0)], 9.0)
    (burn,) = turned(path).burns
    assert burn.xy[0].tolist() == [30.0, 10.0]
    assert (burn.at_s[0], burn.at_s[-1], burn.seconds) == (5.0, 9.0, 4.0)
    assert np.all(np.diff(burn.at_s) >= 0)


def test_the_last_part_comes_first_with_its_holes_before_it() -> None:
    nest = made_nest(101, "plasma")
    part = next(p for p in nest.parts if p.holes)
    other = next(p for p in nest.parts if p is not part)
    line = np.array([[0.0, 0.0], [10.0, 0.0]])
    names = (other.outer.id, part.holes[0].id, part.outer.id)
    path = in_order([torch_on(name, line, 10.0 * k, 10.0 * k + 5) for k, name in enumerate(names)], 25.0)
    burns = last_first(path, nest, 10.0).burns
    assert [burn.contour for burn in burns] == [names[1], names[2], names[0]]
    assert [burn.seconds for burn in burns] == [5.0, 5.0, 5.0]
    assert burns[1].at_s[0] == burns[0].at_s[-1] + 1.0


def test_a_bare_profile_has_one_more_rule() -> None:
    profile = load_profile(PROCESSES["laser"][0])
    on = {name for name, setting in bare(profile, "no-narrow-strips").rules.items() if setting.strength != "off"}
    assert on - set(BARE) == {"no-narrow-strips"}


def test_our_shrinkage_is_that_of_the_formulas_for_the_same_heat() -> None:
    for row in list(literature())[2:]:
        ours, okerblom, tendon = (float(cell) for cell in row.split("|")[3:6])
        assert ours == pytest.approx(okerblom, rel=0.08)
        assert ours == pytest.approx(tendon, rel=0.08)


def test_strips_lie_apart_on_their_sheet() -> None:
    nest = strips(3)
    assert [part.id for part in nest.parts] == ["S1", "S2", "S3"]
    assert nest.sheet.polygon.contains(nest.parts[2].polygon)


def test_waits_come_before_each_cut_but_the_first() -> None:
    line = np.array([[0.0, 0.0], [10.0, 0.0]])
    path = in_order([torch_on(f"{k}", line, 10.0 * k, 10.0 * k + 5) for k in range(3)], 25.0)
    later = waiting(path, 100.0)
    assert [burn.at_s[0] for burn in later.burns] == [0.0, 110.0, 220.0]
    assert later.end_s == 225.0


def test_bridges_are_cut_at_the_end_and_nothing_is_left() -> None:
    nest = made_nest(101, "plasma")
    line = np.array([[0.0, 0.0], [100.0, 0.0]])
    names = [part.outer.id for part in nest.parts[:2]]
    path = in_order([torch_on(name, line, 30.0 * k, 30.0 * k + 20) for k, name in enumerate(names)], 50.0)
    burns = bridged(path, nest).burns
    assert [burn.contour for burn in burns] == [names[0], names[0], names[1], names[1], *names]
    low, high = 50 - BRIDGE_MM / 2, 50 + BRIDGE_MM / 2
    assert [burn.xy[[0, -1], 0].tolist() for burn in burns[:2]] == [[0, low], [high, 100]]
    assert [burn.xy[[0, -1], 0].tolist() for burn in burns[4:]] == [[low, high], [low, high]]
    assert burns[4].seconds == pytest.approx(20 * BRIDGE_MM / 100)


@pytest.mark.full
def test_a_strip_cut_off_along_one_edge_bends_as_beam_theory_and_formulas_for_seams_say() -> None:
    row = next(islice(camber(), 2, None))  # oxyfuel
    ours, hot, beam, okerblom, tendon, eccs = (float(cell) for cell in row.split("|")[2:8])
    assert ours == pytest.approx(beam, rel=0.01)
    assert ours == pytest.approx(hot, rel=0.05)
    assert tendon < okerblom < 1.2 * ours
    assert eccs > 1.4 * ours


def test_a_flame_heats_deeper_than_an_arc_and_a_beam() -> None:
    flame, more, arc, beam = (float(row.split("|")[3]) for row in list(zones())[2:])
    assert more > flame > 2 * arc > 4 * beam > 0


def test_heat_that_is_spread_is_as_hot_as_the_normal_law_says() -> None:
    """At the edge of a spread s: 1 / (√2π s) of the heat over the capacity at first, 1 / √e of it at a depth of s."""
    first_k = 30.0 / HELD.capacity_j_mm3 / np.sqrt(2 * np.pi) / 5.0
    assert over_mm(30.0, first_k / np.sqrt(np.e), 5.0) == pytest.approx(5.0)
    assert over_mm(30.0, 1.01 * first_k, 5.0) == 0.0
    assert over_mm(30.0, first_k / 4, 5.0) == over_mm(30.0, first_k / 4)
