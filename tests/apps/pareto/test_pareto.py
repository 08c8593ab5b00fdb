"""kerfwise pareto: a table, a plot, and a lawful plan for every point."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import kerfwise as package
from kerfwise.apps.pareto.pareto import TradeOff
from kerfwise.tests.commands.run_cli import kerfwise

NEST = Path(package.__file__).parent / "examples" / "nests" / "e1x_6.json"


@pytest.mark.slow
def test_every_point_is_a_plan(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("kerfwise.jobs.cooler_orders.ORDERS", 30)
    profile = tmp_path / "hot.yaml"
    profile.write_text("based_on: plasma-carbon-steel\nheat: {limit_c: 90}\n", encoding="utf-8")
    plot, plans = tmp_path / "front.png", tmp_path / "plans"
    done = kerfwise(
        "pareto", NEST, "-p", profile, "--price", 0, "--price", 100, "--work", 2, "-o", plot, "--plans", plans, "--json"
    )
    assert done.code == 0, done.err
    rows = json.loads(done.out)
    assert [row["price_mm"] for row in rows] == [0, 100]
    assert any(row["front"] for row in rows)
    assert plot.read_bytes().startswith(b"\x89PNG")
    for row in rows:
        plan = plans / f"price-{row['price_mm']:g}.plan.json"
        assert json.loads(plan.read_text())["totals"]["idle_mm"] == pytest.approx(row["idle_mm"], abs=0.1)
        assert kerfwise("check", NEST, plan, "-p", profile).code == 0
        heat = json.loads(kerfwise("heat", NEST, plan, "-p", profile, "--json").out)
        assert heat["overheats"] == row["overheats"]


def test_wrong_plot_is_refused(tmp_path: Path) -> None:
    done = kerfwise("pareto", NEST, "-o", tmp_path / "front.svg")
    assert (done.code, "give a name ending in .png" in done.err) == (2, True)


@pytest.mark.slow
def test_after_ctrl_c_what_was_found_is_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """While the prices are being found there is one plan already; the outputs are named after the nest."""

    def interrupted(_: TradeOff) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(TradeOff, "fit", interrupted)
    monkeypatch.chdir(tmp_path)
    done = kerfwise("pareto", NEST, "--price", 0, "--price", 100, "--work", 2)
    assert done.code == 130
    assert len(done.out.splitlines()) == 3
    assert done.out.endswith("written: e1x_6.pareto.png, e1x_6.pareto/price-*\n")
    assert sorted(p.name for p in Path("e1x_6.pareto").iterdir()) == ["price-0.nc", "price-0.plan.json"]
    assert kerfwise("check", NEST, "e1x_6.pareto/price-0.nc").code == 0


def test_before_there_is_a_plan_nothing_is_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(_: TradeOff) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(TradeOff, "fit", interrupted)
    monkeypatch.chdir(tmp_path)
    assert kerfwise("pareto", NEST, "--price", 100).code == 130
    assert list(tmp_path.iterdir()) == []
