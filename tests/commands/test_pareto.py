"""kerfwise pareto: a table, a plot, and a lawful plan for every point."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import kerfwise as package
from kerfwise.tests.commands.run_cli import kerfwise

NEST = Path(package.__file__).parent / "examples" / "nests" / "e1x_6.json"


def test_every_point_is_a_plan(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("kerfwise.models.heat.cooler_orders.ORDERS", 30)
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
