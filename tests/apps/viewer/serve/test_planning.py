"""Planning beside the answers: incumbents stream in; it is cancelled, killed, waited for, asked what an effect is."""

from __future__ import annotations

import json
import os
import socket
import threading
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import httpx
import pytest

from kerfwise.apps.viewer.serve import planner
from kerfwise.apps.viewer.serve.plan_request import PlanRequest
from kerfwise.apps.viewer.serve.planner import Effects
from kerfwise.encoder.errors import RulesConflict
from kerfwise.jobs import plan_nest as main_job
from kerfwise.jobs.request import NoPlan
from kerfwise.tests.apps.viewer.serve.served import EXAMPLES, SMALL, Open, Served, Tab, wait_for

pytestmark = pytest.mark.slow


def events(tab: Tab, until: Any, found: list[tuple[str, dict[str, Any]]]) -> None:
    """Listen to a session until something is told."""
    with tab.client.stream("GET", f"/api/{tab.id}/events") as answer:
        what = ""
        for line in answer.iter_lines():
            if line.startswith("event: "):
                what = line.removeprefix("event: ")
            elif line.startswith("data: ") and what != "planner":
                found.append((what, json.loads(line.removeprefix("data: "))))
                if until(found):
                    return


def ended(found: list[tuple[str, dict[str, Any]]]) -> bool:
    """Whether the last news is of plans that were made, and of none that is being made."""
    what, told = found[-1]
    return what == "state" and bool(told["alternatives"]) and told["solving"] is None


def test_incumbents_stream_in_and_can_be_stopped(plate: Tab, served: Served) -> None:
    tab = plate
    found: list[tuple[str, dict[str, Any]]] = []
    before = served.server.news.listeners
    done = threading.Thread(target=events, args=(tab, ended, found))
    done.start()
    wait_for(lambda: found)
    tab.post("solve", 202, work=200)
    tab.post("solve", 202, work=200)  # the same is being planned: it goes on
    wait_for(lambda: any(len(told.get("alternatives", ())) > 1 for _, told in list(found)))
    assert served.server.planning.helper.pid is not None
    tab.client.post(f"/api/{tab.id}/cancel", json={})
    state = tab.wait()
    done.join(30)
    assert not done.is_alive()
    wait_for(lambda: served.server.news.listeners == before)  # the tab is closed
    plans = state["alternatives"]
    assert [one["stage"] for one in plans][:2] == ["first", "better"]
    assert state["shown"] == plans[-1]["number"]
    costs = [one["figures"]["objective_mm"] for one in plans]
    assert sorted(costs, reverse=True) == costs
    assert all(one["ok"] and one["run"] == 1 for one in plans)
    assert all(one["gained_mm"] > 0 for one in plans[1:] if one["stage"] == "better")
    phases = {told["solving"]["phase"] for what, told in found if what == "progress" and told["solving"]}
    assert phases <= {"waits", "getting ready", "reading", "first plan", "improving", "proving", "finishing"}
    assert "first plan" in phases
    assert tab.post("save")["saved"]["same_bytes"] is False


def test_a_killed_process_is_started_again_and_nothing_is_lost(opened: Open, plate: Tab, served: Served) -> None:
    tab = opened()
    tab.solved()
    tab.edit({"lock": "C.outer last"})
    plate.post("solve", 202, work=200)
    wait_for(lambda: served.server.planning.helper.pid is not None and not plate.state()["solving"]["waits"])
    os.kill(served.server.planning.helper.pid or 0, 9)
    assert "died (signal 9)" in plate.wait()["problem"]
    plate.post("solve", 202, work=200)
    wait_for(lambda: not plate.state()["solving"]["waits"])
    plate.client.post(f"/api/{plate.id}/cancel", json={"at_once": True})
    assert plate.wait()["problem"] == "ended without a plan"
    for helper in (served.server.desk, served.server.planning.helper):
        assert helper.pid is not None or helper is served.server.planning.helper
        if helper.pid is not None:
            os.kill(helper.pid, 9)
    assert tab.get("move", contours="B", place=3)["lawful"] is True
    state = tab.solved()
    assert (state["problem"], len(state["alternatives"]), state["locked"]) == ("", 2, ["C.outer last"])


def test_planning_goes_on_when_the_browser_is_closed(opened: Open, served: Served) -> None:
    tab = opened()
    with httpx.Client(base_url=served.address, headers=tab.client.headers) as other:
        gone = Tab(other, tab.id, tab.version, tab.nest)
        gone.post("solve", 202)
    assert len(tab.wait()["alternatives"]) == 1


def test_cancelled_while_it_waited_and_begun_anew(opened: Open, plate: Tab, served: Served) -> None:
    tab = opened()
    plate.post("solve", 202, work=200)
    wait_for(lambda: not plate.state()["solving"]["waits"])
    tab.post("solve", 202)
    waiting = tab.state()
    assert waiting["solving"]["waits"]
    assert waiting["planner"] == plate.state()["nest"]
    tab.client.post(f"/api/{tab.id}/cancel", json={})
    tab.state()
    tab.edit({"lock": "C.outer first"})
    tab.post("solve", 202)
    plate.client.post(f"/api/{plate.id}/cancel", json={"at_once": True})
    made = tab.wait()["alternatives"]
    assert [one["locked"] for one in made] == [["C.outer first"]]
    assert plate.wait()["problem"] == "ended without a plan"
    assert plate.state()["planner"] == ""


def hang_up(tab: Tab, question: str, said: dict[str, Any], when: Any) -> None:
    """Ask the planner something, and go away before it has answered."""
    body = json.dumps(said).encode()
    head = [f"POST /api/{tab.id}/{question} HTTP/1.1", f"host: {tab.client.base_url.netloc.decode()}"]
    head += [f"{name}: {tab.client.headers[name]}" for name in ("origin", "x-kerfwise-token")]
    with socket.create_connection((tab.client.base_url.host, tab.client.base_url.port or 0)) as way:
        way.sendall("\r\n".join([*head, f"content-length: {len(body)}", "", ""]).encode() + body)
        wait_for(when)


EFFECT = {"changes": [{"rule": "heat-lag", "key": "weight", "to": "80 mm"}]}


def test_an_effect_is_cancelled_where_nobody_waits_for_it(opened: Open, plate: Tab, served: Served) -> None:
    turns = served.server.planning.turns
    tab = opened()
    name = plate.state()["nest"]
    hang_up(plate, "effect", EFFECT, lambda: turns.of == name)
    wait_for(lambda: turns.of == "")
    plate.post("solve", 202, work=200)
    wait_for(lambda: not plate.state()["solving"]["waits"])
    before = served.server.planning.turns.waiting
    hang_up(tab, "effect", EFFECT, lambda: turns.waiting == before + 1)
    wait_for(lambda: turns.waiting == before)  # it does not even wait for its turn
    plate.client.post(f"/api/{plate.id}/cancel", json={"at_once": True})
    plate.wait()
    told = tab.client.post(f"/api/{tab.id}/effect", json=EFFECT).json()
    assert told["before"]["status"] == told["after"]["status"] == "optimal"


def test_what_was_ended_early_is_no_measure_of_the_next_effect(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)  # a planner works in the nest's folder
    nest = tmp_path / "plate40.json"
    nest.write_bytes((EXAMPLES / nest.name).read_bytes())
    going = [False]
    effects = Effects(lambda: lambda reached: going[0])
    values = [("heat-lag", "weight", "80 mm")]
    ended = effects.effect(PlanRequest(str(nest)), values)["before"]
    going[0] = True
    assert effects.effect(PlanRequest(str(nest)), values)["before"]["objective_mm"] < ended["objective_mm"]


def test_little_work_that_finds_no_plan_is_followed_by_more(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A lock may leave so few orders that a short search meets none: the command line of the plan says what it took."""
    monkeypatch.chdir(tmp_path)
    (nest := tmp_path / "small.json").write_text(SMALL, encoding="utf-8")
    tried: list[tuple[float, float]] = []

    def plan_nest(given: Any, limits: Any, **rest: Any) -> Any:
        tried.append((limits.work, limits.memory_gb))
        if len(tried) < 3:
            raise NoPlan(RulesConflict("none was found within the limit"), cast(Any, None), given.profile)
        return main_job.plan_nest(given, limits, **rest)

    monkeypatch.setattr(planner, "plan_nest", plan_nest)
    asking = SimpleNamespace(begin=lambda: None, tell=lambda **told: None, stopped=False, go_on=lambda: True)
    told = planner.Planner(cast(Any, asking)).solve(PlanRequest(str(nest)), 0.25, memory_gb=1.5)
    assert tried == [(0.25, 1.5), (1.0, 1.5), (4.0, 1.5)]
    assert (told["work"], told["memory_gb"], told["ok"]) == (4.0, 1.5, True)
