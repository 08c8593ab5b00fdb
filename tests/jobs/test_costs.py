"""What a sheet costs: each thing by hand, plans and programs alike."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.jobs.display import summary
from kerfwise.jobs.inputs import Inputs
from kerfwise.jobs.programs import time_made
from kerfwise.jobs.request import options_for
from kerfwise.models.physics.time_and_cost import Cost, RunTimes, cost_of
from kerfwise.models.plan.read_plan import read_plan
from kerfwise.pipeline import plan_nest
from kerfwise.postproc.clock import cost_of_plan, cost_of_sheet
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.plant_sections import Consumables, Prices
from kerfwise.rules.profile.sections import Cuts, Scrap
from kerfwise.tests.commands.run_cli import kerfwise

HOUR = RunTimes((), cut_s=1700.0, idle_s=1800.0, pierce_s=100.0)
"""An hour, half of it with the torch on."""
PLATE = nest(1000, 500, part("A", rect(50, 50, 200, 200)))


@pytest.mark.parametrize(
    ("prices", "parts", "total"),
    [
        (Prices(machine_hour=80), {"machine": 80.0}, 80.0),
        (Prices(gas_hour=12), {"gas": 6.0}, 6.0),
        (Prices(gas_m3=2), {"gas": 4.0}, 4.0),
        (Prices(kwh=0.3, torch_kw=40, standby_kw=2), {"power": 0.3 * (20 + 2)}, 6.6),
        (Prices(consumables=Consumables(24, pierces=400)), {"consumables": 6.0}, 6.0),
        (Prices(consumables=Consumables(24, torch_hours=2)), {"consumables": 6.0}, 6.0),
        (Prices(consumables=Consumables(24, 400, 2)), {"consumables": 12.0}, 12.0),
        (Prices(machine_hour=80, currency="PLN"), {"machine": 80.0}, 80.0),
    ],
)
def test_each_thing_by_itself(prices: Prices, parts: dict[str, float], total: float) -> None:
    cost = cost_of(HOUR, prices, pierces=100, gas_m3_hour=4.0)
    assert cost is not None
    assert dict(cost.parts) == pytest.approx(parts)
    assert (cost.total, cost.currency) == (pytest.approx(total), prices.currency)


def test_the_sheet_by_weight_or_by_piece_and_what_its_remnant_is_worth() -> None:
    plant = replace(load_profile(), prices=Prices(sheet_kg=1.0))
    steel_kg = 1.0 * 0.5 * 0.006 * 7850
    by_weight = cost_of_sheet(HOUR, 0, PLATE, plant)
    assert by_weight == Cost(sheet=pytest.approx(steel_kg))  # 1 m by 0.5 m of 6 mm
    by_piece = replace(plant, prices=Prices(sheet_each=60, remnant_share=0.5))
    assert cost_of_sheet(HOUR, 0, PLATE, by_piece) == Cost(sheet=60.0)
    saves = replace(by_piece, cuts=Cuts(scrap=Scrap(remnant="right")))
    cost = cost_of_sheet(HOUR, 0, PLATE, saves)
    width_mm = 1000 - 250 - 1.5 - 0.01 - 0.75  # what parts, a kerf and half the kerf of the line leave
    assert cost is not None
    assert cost.remnant == pytest.approx(60 * 0.5 * width_mm / 1000, rel=2e-3)
    assert cost.total == cost.sheet - cost.remnant
    assert cost_of_sheet(HOUR, 0, None, saves) == Cost()


def test_no_price_no_cost() -> None:
    assert cost_of(HOUR, Prices(torch_kw=40, remnant_share=1, currency="USD")) is None


def test_a_plan_says_what_it_costs_and_so_does_the_clock(tmp_path: Path) -> None:
    prices = Prices(machine_hour=80, sheet_kg=1.2, consumables=Consumables(24, 400, 2))
    plant = replace(load_profile(), prices=prices)
    given = Inputs(PLATE, plant)
    made = plan_nest(given, options_for(PLATE, plant, work=1)).made
    plan = made.plan
    assert plan.cost is not None
    assert plan.cost == cost_of_plan(plan, PLATE, plant)
    assert plan.cost.consumables == pytest.approx(24 * (1 / 400 + (plan.time.cut_s + plan.time.pierce_s) / 7200))  # type: ignore[union-attr]
    assert time_made(given, plan).as_json()["cost"] == plan.cost.as_json()
    assert f"a sheet costs {plan.cost}" in summary(plan, made.verdict).splitlines()
    file = tmp_path / "plate.plan.json"
    file.write_text(plan.to_json(), encoding="utf-8")
    assert read_plan(file).cost == Cost.of_json(plan.cost.as_json())
    unpriced = plan_nest(Inputs(PLATE, load_profile()), options_for(PLATE, plant, work=1)).made.plan
    assert unpriced.cost is None
    assert "cost" not in unpriced.to_json().partition('"solve"')[0]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("prices: {gas_m3: 2}", "1:18: prices.gas_m3: nobody says how much gas flows: give material.gas_flow"),
        (
            "material: {gas_flow: 80 l/min}\nprices: {gas_m3: 2, gas_hour: 3}",
            "2:18: prices.gas_m3: the gas has a price by the hour too",
        ),
        ("prices: {sheet_kg: 2, sheet_each: 3}", "1:35: prices.sheet_each: the sheet has a price by the kilogram too"),
        ("prices: {kwh: 2}", "1:15: prices.kwh: nobody says how much power is drawn"),
        ("prices: {consumables: {set_price: 9}}", "1:23: prices.consumables: nobody says how long a set lasts"),
        ("prices: {machine_hour: -1}", "1:24: prices.machine_hour: expected a number of at least 0, got '-1'"),
        ("prices: {machine_our: 1}", "1:10: prices: unknown key 'machine_our': did you mean 'machine_hour'?"),
        ("prices: {consumables: {set: 1}}", "1:24: prices.consumables: unknown key 'set': did you mean 'set_price'?"),
    ],
)
def test_prices_that_mean_nothing_are_refused_in_place(text: str, message: str, tmp_path: Path) -> None:
    file = tmp_path / "plant.yaml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as caught:
        load_profile(file)
    assert str(caught.value).startswith(f"{file}:{message}")


def test_the_flow_of_gas_is_in_the_chart(tmp_path: Path) -> None:
    (tmp_path / "chart.csv").write_text("material, thickness [mm], kerf [mm], gas_flow [l/min]\nS235, 6, 1.5, 50\n")
    file = tmp_path / "plant.yaml"
    file.write_text("material: {chart: chart.csv}\nprices: {gas_m3: 2}\n", encoding="utf-8")
    plant = load_profile(file)
    assert plant.material.gas_flow_m3_h == pytest.approx(3.0)
    assert dict(cost_of_sheet(HOUR, 0, PLATE, plant).parts) == pytest.approx({"gas": 3.0})  # type: ignore[union-attr]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            "prices: {machine_hour: 80, consumables: {pierces: 400, torch_hours: 3}}",
            "prices.consumables.pierces and prices.consumables.torch_hours are given without "
            "prices.consumables.set_price: the cost leaves out consumables",
        ),
        (
            "prices: {torch_kw: 40}",
            "prices.torch_kw is given without prices.kwh: the cost leaves out the power",
        ),
        (
            "material: {gas_flow: 80 l/min}\nprices: {machine_hour: 80}",
            "material.gas_flow is given without prices.gas_m3 or gas_hour: the cost leaves out the gas",
        ),
        ("material: {gas_flow: 80 l/min}", ""),
        (
            "prices: {machine_hour: 80, remnant_share: 0.5}",
            "prices.remnant_share is given without prices.sheet_kg or sheet_each: the cost leaves out sheet and "
            "remnant",
        ),
        ("prices: {sheet_kg: 1, remnant_share: 0.5}", ""),
        ("prices: {currency: USD}", "prices: no price is given, so that no cost is told"),
        ("prices: {machine_hour: 80}", ""),
        ("name: bare", ""),
    ],
)
def test_prices_that_are_half_given_say_what_is_missing(text: str, said: str, tmp_path: Path) -> None:
    file = tmp_path / "plant.yaml"
    file.write_text(text, encoding="utf-8")
    assert load_profile(file).time_and_price_notes() == ((said,) if said else ())


def test_the_command_line_tells_it(tmp_path: Path) -> None:
    file = tmp_path / "plant.yaml"
    file.write_text("prices: {machine_hour: 80, torch_kw: 40}\n", encoding="utf-8")
    ended = kerfwise("profile", "check", file)
    assert (ended.code, "note: prices.torch_kw is given without prices.kwh" in ended.err) == (0, True)
