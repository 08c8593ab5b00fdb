"""Which of the plans of a planning is shown as they come."""

from __future__ import annotations

import json
from typing import Any

import pytest
from click.testing import CliRunner

from kerfwise.apps.viewer.serve.news import News
from kerfwise.apps.viewer.serve.plan_request import PlanRequest
from kerfwise.apps.viewer.serve.session import Packed, Session
from kerfwise.apps.viewer.serve.verbs import command
from kerfwise.models.engines.tuning import MEMORY_GB


def came(cost_mm: float, stage: str) -> dict[str, Any]:
    """A plan as the planner tells it."""
    cuts = [{"contour": "A.outer", "entry": [cost_mm, 0.0], "direction": "ccw"}]
    figures = {"objective_mm": cost_mm, "light_mm": cost_mm, "excuses": 0, "state": "kept"}
    return {
        "sha256": "s", "files": {"a.plan.json": Packed.of(json.dumps({"cuts": cuts}))}, "plan_file": "a.plan.json",
        "program_file": "a.nc", "page": Packed.of("{}"), "figures": figures, "summary": "", "ok": True,
        "stopped": False, "stage": stage, "checked": True, "broken": [], "notes": [], "work": 1.0,
        "memory_gb": MEMORY_GB,
    }  # fmt: skip


@pytest.mark.parametrize(("costs_mm", "shown"), [((100, 90, 95), 2), ((100, 90, 85), 3), ((100, 104), 1)])
def test_no_plan_takes_the_place_of_a_cheaper_one(costs_mm: tuple[float, ...], shown: int) -> None:
    """Not the one that is made anew at the end either: it is in the list."""
    wanted = PlanRequest("a.json")
    session = Session("key", "a.json", wanted, {"sha256": "s"}, News(), following=1)
    stages = ["first", *["better"] * (len(costs_mm) - 2), "final"]
    for cost_mm, stage in zip(costs_mm, stages, strict=True):
        session.add(came(cost_mm, stage), wanted, relax=False, run=1)
    assert session.shown == shown
    assert [one.number for one in session.alternatives] == list(range(1, len(costs_mm) + 1))
    session.following = 0  # somebody goes back: what comes is in the list alone
    session.add(came(1.0, "final"), wanted, relax=False, run=1)
    assert session.shown == shown


def test_plans_on_the_way_go_first_and_one_that_somebody_keeps_stays(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("kerfwise.apps.viewer.serve.session.MOST_ALTERNATIVES", 4)
    wanted = PlanRequest("a.json")
    session = Session("key", "a.json", wanted, {"sha256": "s"}, News())
    for run in range(1, 5):
        session.following = run
        for cost_mm, stage in ((100, "first"), (90, "better"), (80, "final")):
            session.add(came(cost_mm - run, stage), wanted, relax=False, run=run)
        if run == 1:
            session.keep(1, True)
    assert [(one.run, one.stage) for one in session.alternatives] == [
        (1, "first"), (2, "final"), (3, "final"), (4, "final"),
    ]  # fmt: skip


@pytest.mark.parametrize(("user", "warned"), [(0, True), (1000, False)])
def test_whoever_serves_as_root_is_warned(monkeypatch: pytest.MonkeyPatch, user: int, warned: bool) -> None:
    monkeypatch.setattr("os.geteuid", lambda: user, raising=False)
    monkeypatch.setattr("kerfwise.apps.viewer.serve.run_server.serve", lambda *given, **more: None)
    done = CliRunner().invoke(command, ["."])
    assert ("serve runs as root" in done.stderr) == warned
