"""kerfwise pareto: a table, a plot, and a lawful plan for every point."""

from __future__ import annotations

import json
from pathlib import Path
from typing import cast

import pytest
from hypothesis import given
from hypothesis import strategies as st

import kerfwise as package
from kerfwise.apps.pareto.pareto import Trade, TradeOff, front
from kerfwise.models.plan.plan import Totals
from kerfwise.pipeline import VerifiedPlan
from kerfwise.tests.commands.run_cli import kerfwise

NEST = Path(package.__file__).parent / "examples" / "nests" / "e1x_6.json"


@pytest.mark.slow
def test_every_point_is_a_plan(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("kerfwise.jobs.cooler_orders.ORDERS", 5)
    profile = tmp_path / "hot.yaml"
    profile.write_text("based_on: plasma-carbon-steel\nheat: {limit_c: 90}\n", encoding="utf-8")
    plot, plans = tmp_path / "front.png", tmp_path / "plans"
    done = kerfwise(
        "pareto",
        NEST,
        "-p",
        profile,
        "--price",
        0,
        "--price",
        100,
        "--work",
        0.5,
        "-o",
        plot,
        "--plans",
        plans,
        "--json",
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


class _Made:
    def __init__(self, idle_mm: float, ok: bool = True) -> None:
        self.verdict, self.ok = self, ok
        self.plan = self
        self.totals = Totals(0.0, idle_mm, 0, 0.0, 0.0)


def trade(price_mm: float, overheats: int, idle_mm: float, ok: bool = True, off_mm: float | None = None) -> Trade:
    return Trade(price_mm, cast(VerifiedPlan, _Made(idle_mm, ok)), overheats, 0.0, off_mm)


def test_beaten_plans_and_the_second_of_equals_are_not_on_the_front() -> None:
    cheap, even, dear, beaten, twin = (
        trade(0, 90, 1000), trade(10, 60, 1200), trade(30, 50, 2000), trade(100, 70, 1500), trade(300, 60, 1200),
    )  # fmt: skip
    assert front([dear, twin, beaten, even, cheap]) == [cheap, even, dear]
    assert front([]) == []


def test_a_plan_that_the_check_refuses_is_not_on_the_front() -> None:
    lawful, unlawful = trade(0, 90, 1000), trade(10, 1, 500, ok=False)
    assert front([unlawful, lawful]) == [lawful]


def test_a_plan_with_straighter_parts_is_on_the_front_though_it_travels_more() -> None:
    short, straight, beaten = (
        trade(0, 5, 1000, off_mm=0.3),
        trade(0, 5, 2000, off_mm=0.1),
        trade(9, 5, 2100, off_mm=0.2),
    )
    assert front([beaten, straight, short]) == [short, straight]


@given(st.lists(st.tuples(st.integers(0, 9), st.integers(0, 9), st.integers(0, 9)), max_size=12))
def test_the_front_is_what_nothing_beats(points: list[tuple[int, int, int]]) -> None:
    trades = [trade(k, hot, float(idle), off_mm=float(off)) for k, (hot, idle, off) in enumerate(points)]
    kept = front(trades)
    for one, point in zip(trades, points, strict=True):
        beaten = any(all(a <= b for a, b in zip(other, point, strict=True)) and other != point for other in points)
        same = any((k.overheats, k.idle_mm, k.off_mm) == (one.overheats, one.idle_mm, one.off_mm) for k in kept)
        assert same is not beaten
