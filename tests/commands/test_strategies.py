"""kerfwise solve: plain strategies to compare with, and a price on overheats, keep every hard rule."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import kerfwise as package
from kerfwise.tests.commands.run_cli import kerfwise

NEST = Path(package.__file__).parent / "examples" / "nests" / "e1x_6.json"
FREE = """
based_on: plasma-carbon-steel
rules: {zone-order: off, level-ahead: off, hull-before: off, heat-lag: off, part-rigidity: off, no-islands: off,
        no-narrow-strips: off, no-tip-travel: off}
heat: {limit_c: 90}
"""


@pytest.fixture(scope="module")
def profile(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("plant") / "free.yaml"
    path.write_text(FREE, encoding="utf-8")
    return path


def solved(folder: Path, profile: Path, *options: object) -> tuple[float, int]:
    """Idle travel, mm, and overheats of the plan; its check is passed, or nothing would be written."""
    plan = folder / "plan.json"
    done = kerfwise("solve", NEST, "-p", profile, "--work", 3, "--plan", plan, *options)
    assert done.code == 0, done.err
    assert "ok: every hard rule holds" in done.out
    heat = kerfwise("heat", NEST, plan, "-p", profile, "--json")
    assert heat.code == 0, heat.err
    return json.loads(plan.read_text())["totals"]["idle_mm"], json.loads(heat.out)["overheats"]


@pytest.mark.slow
def test_shortest_is_shortest_and_the_others_are_lawful(profile: Path, tmp_path: Path) -> None:
    idle = {name: solved(tmp_path, profile, "--strategy", name)[0] for name in ("shortest", "random", "realtime")}
    assert idle["shortest"] < idle["realtime"]
    assert idle["shortest"] < idle["random"]
    again = solved(tmp_path, profile, "--strategy", "random", "--seed", 2)[0]
    assert again != idle["random"]


@pytest.mark.full
@pytest.mark.slow
def test_a_price_on_overheats_buys_fewer_of_them(
    profile: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("kerfwise.jobs.cooler_orders.ORDERS", 60)
    priced = profile.with_name("priced.yaml")
    priced.write_text(FREE + "objective: {heat: 50}\n", encoding="utf-8")
    short_mm, hot = solved(tmp_path, profile)
    priced_mm, cooler = solved(tmp_path, priced)
    assert cooler < 0.85 * hot
    assert priced_mm < 1.3 * short_mm


@pytest.mark.parametrize("strategy", ["shortest", "random"])
def test_a_plan_costs_what_all_rules_ask_for(strategy: str, tmp_path: Path) -> None:
    """Soft rules decide nothing here, but are paid for: the plan is the one that `check` adds up."""
    plan, program = tmp_path / "plan.json", tmp_path / "out.nc"
    done = kerfwise("solve", NEST, "--strategy", strategy, "--work", 1, "-o", program, "--plan", plan)
    assert done.code == 0, done.err
    held = json.loads(plan.read_text())
    paid_mm = sum(breach["mm"] for breach in held["prices"]["breaches"])
    assert held["solve"]["objective"] == pytest.approx(held["prices"]["travel"] + paid_mm, abs=0.01)
    assert held["solve"]["status"] == "feasible"
    assert kerfwise("check", NEST, plan).code == 0
