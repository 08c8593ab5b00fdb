"""Planning beside the answers: incumbents stream in; it is cancelled, killed, waited for, asked what an effect is."""

from __future__ import annotations

import json
import multiprocessing
import os
import signal
import socket
import subprocess
import sys
import threading
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import httpx
import pytest
import shapely

from kerfwise import pipeline as main_job
from kerfwise.apps.viewer.serve import planner, plans_shown
from kerfwise.apps.viewer.serve.nest_folder import Folder
from kerfwise.apps.viewer.serve.news import News
from kerfwise.apps.viewer.serve.plan_request import PlanRequest, request_inputs, sha256_of
from kerfwise.apps.viewer.serve.planner import Effects
from kerfwise.apps.viewer.serve.plans_shown import RecentFacts
from kerfwise.apps.viewer.serve.query_worker import Desk
from kerfwise.apps.viewer.serve.server import save
from kerfwise.apps.viewer.serve.session import Session
from kerfwise.apps.viewer.serve.worker import answer_questions
from kerfwise.encoder.already_cut import NOTHING_CUT
from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers.read import read_nest
from kerfwise.examples.gen_sheet import make_sheet
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


def is_ended_at_once(state: dict[str, Any]) -> bool:
    """Whether the last planning was ended; it may have shown a plan by then."""
    return state["problem"] in ("ended without a plan", "ended" if state["alternatives"] else "")


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
    assert tab.post("save")["saved"]["same_bytes"] is False


def test_a_killed_process_is_started_again_and_nothing_is_lost(opened: Open, plate: Tab, served: Served) -> None:
    tab = opened()
    tab.solved()
    tab.edit({"lock": "C.outer last"})
    plate.post("solve", 202, work=200)
    wait_for(lambda: served.server.planning.helper.pid is not None and not plate.state()["solving"]["waits"])
    pid = served.server.planning.helper.pid
    assert pid is not None  # 0 would be all of this run
    os.kill(pid, 9)
    assert "died (signal 9)" in plate.wait()["problem"]
    plate.post("solve", 202, work=200)
    wait_for(lambda: not plate.state()["solving"]["waits"])
    plate.client.post(f"/api/{plate.id}/cancel", json={"at_once": True})
    assert is_ended_at_once(plate.wait())
    for helper in (served.server.desk, served.server.planning.helper):
        assert helper.pid is not None or helper is served.server.planning.helper
        if helper.pid is not None:
            os.kill(helper.pid, 9)
    assert tab.get("move", contours="B", place=3)["lawful"] is True
    state = tab.solved()
    assert (state["problem"], len(state["alternatives"]), state["locked"]) == ("", 2, ["C.outer last"])


@pytest.mark.skipif(not hasattr(os, "killpg"), reason="Windows has no groups of processes")
def test_solvers_of_others_end_with_a_process_that_nobody_asks_any_more() -> None:
    """The pipe is the first that it sees of a server's end: it went, its solver stayed."""
    context = multiprocessing.get_context("spawn")
    (way, there), (stop, stops) = context.Pipe(), context.Pipe()
    process = context.Process(target=answer_questions, args=("desk", there, stops), daemon=True)
    process.start()
    way.send(("ready", {}))
    assert way.recv()[0] == "answer"
    solver = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(120)"], process_group=process.pid)
    try:
        for pipe in (way, there, stop, stops):
            pipe.close()
        assert solver.wait(30) == -signal.SIGKILL
        process.join(30)
        assert not process.is_alive()
    finally:
        solver.kill()
        process.kill()


@pytest.mark.skipif(not hasattr(os, "killpg"), reason="Windows has no groups of processes")
@pytest.mark.parametrize("how", ["ended by the server", "the server is killed"])
def test_solvers_of_others_end_with_the_process_that_has_begun_them(how: str) -> None:
    """They are of its group: a solver of MiniZinc that goes on by itself would take a gigabyte more."""
    script = "import sys, time; from kerfwise.apps.viewer.serve.worker import Worker; worker = Worker('desk')"
    script = f"if __name__ == '__main__':\n    {script}; worker.ask('ready'); print(worker.pid, flush=True)\n"
    wait = "    sys.stdin.read(1); worker.kill()\n    time.sleep(60)\n"
    server = subprocess.Popen(
        [sys.executable, "-c", script + wait], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert server.stdin is not None
    assert server.stdout is not None
    group = int(server.stdout.readline())
    solver = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(120)"], process_group=group)
    try:
        assert solver.poll() is None
        if how == "ended by the server":
            server.stdin.write("x")
            server.stdin.flush()
        else:
            server.kill()
        assert solver.wait(30) == -signal.SIGKILL
    finally:
        server.kill()
        solver.kill()
        server.communicate()


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
    assert is_ended_at_once(plate.wait())
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


@pytest.mark.full
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


@pytest.mark.full
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

    def plan_nest(given: Any, limits: Any, *rest: Any, **named: Any) -> Any:
        tried.append((limits.work, limits.memory_gb))
        if len(tried) < 3:
            raise NoPlan(RulesConflict("none was found within the limit"), cast(Any, None), given.profile)
        return main_job.plan_nest(given, limits, *rest, **named)

    monkeypatch.setattr(planner, "plan_nest", plan_nest)
    asking = SimpleNamespace(begin=lambda: None, tell=lambda **told: None, stopped=False, go_on=lambda: True)
    told = planner.Planner(cast(Any, asking)).solve(PlanRequest(str(nest)), 0.25, memory_gb=1.5)
    assert tried == [(0.25, 1.5), (1.0, 1.5), (4.0, 1.5)]
    assert (told["work"], told["memory_gb"], told["ok"]) == (4.0, 1.5, True)


class Told:
    """Whoever has asked a planner of this process: what was told it, in order."""

    def __init__(self) -> None:
        self.all: list[dict[str, Any]] = []
        self.planner = planner.Planner(cast(Any, self))

    stopped = False

    def begin(self) -> None:
        """Nothing is to be forgotten."""

    def go_on(self) -> bool:
        return True

    def tell(self, **told: Any) -> None:
        self.all.append(told)

    def plans(self) -> list[dict[str, Any]]:
        return [told[kind] for told in self.all for kind in ("plan", "checked") if kind in told]


def plan_of(told: dict[str, Any]) -> dict[str, Any]:
    return cast(dict[str, Any], json.loads(told["files"][told["plan_file"]].text()))


@pytest.fixture
def sixteen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (nest := tmp_path / "plate.json").write_text(json.dumps(make_sheet(1, 16)), encoding="utf-8")
    return nest


def test_a_drop_is_answered_along_the_plan_at_hand_first_without_a_program(
    sixteen: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(plans_shown, "BARE_FROM", 10)
    told = Told()
    done = told.planner.solve(PlanRequest(str(sixteen)), 0.2)
    before, text = [cut["contour"] for cut in plan_of(done)["cuts"]], done["files"][done["plan_file"]].text()
    told.all.clear()
    desk, wanted = Desk(), PlanRequest(str(sixteen))
    moves = (desk.move(wanted, text, [name], k + 2) for k, name in enumerate(before[:-1]))
    moved = next(move["place"] for move in moves if move["lawful"] and move["more_mm"]) - 2
    job = f"locks: [{before[moved]} position {moved + 2}]\n"
    told.planner.solve(PlanRequest(str(sixteen), job), 0.2, start=text)
    phases = [one["phase"] for one in told.all if one.get("phase", "getting ready") != "getting ready"]
    assert phases[:2] == ["reading", "first plan"]
    gaps = [one["gap"] for one in told.all if one.get("gap") is not None]
    assert gaps == sorted(gaps, reverse=True), "each set of zones has a bound of its own, and nobody sees it jump"
    bare, checked = told.plans()[:2]
    assert [(one["stage"], one["checked"], one["ok"]) for one in (bare, checked)] == [
        ("first", False, True), ("first", True, True),
    ]  # fmt: skip
    assert bare["program_file"] not in bare["files"]
    assert checked["files"][checked["program_file"]].text().startswith("(KERFWISE")
    sides = [json.loads(one["page"].text())["sides"][0] for one in (bare, checked)]
    assert [side["unchecked"] for side in sides] == [True, False]
    assert [side["nc"] is None for side in sides] == [True, False]
    order = [cut["contour"] for cut in plan_of(bare)["cuts"]]
    assert order == [cut["contour"] for cut in plan_of(checked)["cuts"]]
    assert order.index(before[moved]) == moved + 1
    assert [name for name in order if name != before[moved]] == [name for name in before if name != before[moved]]


def test_a_locked_place_asks_for_no_facts_anew(sixteen: Path) -> None:
    recent = RecentFacts()

    def facts(job: str) -> object:
        given = request_inputs(PlanRequest(str(sixteen), job))
        return recent.of(given.nest, given.profile, NOTHING_CUT)

    first = facts("locks: [P1.outer position 3]\n")
    assert facts("locks: [P1.outer position 4, P2.outer last]\n") is first
    assert facts("locks: [P1.outer cw]\n") is not first
    assert facts("set: {material.kerf: 2 mm}\n") is not first
    with pytest.raises(InputError, match="position 99"):
        facts("locks: [P1.outer position 99]\n")


@pytest.mark.full
def test_plans_are_shown_under_a_price_of_heat_and_the_priced_one_takes_their_place(
    sixteen: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name, value in (("ORDERS", 6), ("NEARBY", 2), ("ROUNDS", 1)):
        monkeypatch.setattr(f"kerfwise.jobs.cooler_orders.{name}", value)
    told = Told()
    wanted = PlanRequest(str(sixteen), "set: {objective.heat: 100, heat.absorbed_power_w: 3000}\n")
    final = told.planner.solve(wanted, 0.1)
    shown = told.plans()
    assert shown
    assert all(one["ok"] and one["unpriced"] for one in shown)
    assert shown[0]["figures"]["objective_mm"] < final["figures"]["objective_mm"]
    session = session_of(wanted)
    for event in (*shown, final | {"stage": "final"}):
        session.add(event, wanted, relax=False, run=0)
    assert session.current is not None
    assert (session.current.stage, session.current.unpriced) == ("final", False)


TIPS_ALONE = (
    "set: {rules.heat-lag: off, rules.no-islands: off, rules.no-narrow-strips: off, rules.part-rigidity: off, "
    "rules.no-tip-travel.weight: 10 mm}\n"
)


def crossed_parts(plan: dict[str, Any], nest: Nest) -> int:
    """How often an idle move leads over a part that is out by then, by drawing it."""
    outers = {part.id: part.outer.polygon.buffer(-0.01) for part in nest.parts}
    at, out, crossed = (0.0, 0.0), list[shapely.Geometry](), 0
    for cut in plan["cuts"]:
        move = shapely.LineString([at, cut["pierce"]])
        crossed += sum(move.intersects(area) for area in out)
        at = cut["lead_out"][-1][:2] if cut["lead_out"] else cut["entry"]
        if cut["kind"] == "outer":
            out.append(outers[cut["part"]])
    return crossed + sum(shapely.LineString([at, (0.0, 0.0)]).intersects(area) for area in out)


def test_each_plan_on_the_way_has_the_price_of_all_that_is_asked(
    sixteen: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The search of large nests does not look at single moves: what its plans cross was missing from what was shown."""
    monkeypatch.setattr("kerfwise.jobs.adaptive_zones.GEOMETRY", 8)
    monkeypatch.setattr("kerfwise.jobs.plan_without_zones.MOST_MOVES", 8)
    for name, value in (("SHOWN_EACH_S", 0.0), ("SHOWN_SHARE", 0.0), ("FEW", 99)):
        monkeypatch.setattr(plans_shown, name, value)
    (plate := sixteen.parent / "forty.json").write_text(json.dumps(make_sheet(1, 41)), encoding="utf-8")
    told = Told()
    final = told.planner.solve(PlanRequest(str(plate), TIPS_ALONE), 0.3)
    plans = [*map(plan_of, told.plans()), plan_of(final)]
    crossed = [crossed_parts(plan, read_nest(plate)) for plan in plans]
    costs = [plan["solve"]["objective"] for plan in plans]
    paid = [plan["totals"]["idle_mm"] + 10.0 * count for plan, count in zip(plans, crossed, strict=True)]
    assert costs == pytest.approx(paid, abs=0.1)
    assert costs == sorted(costs, reverse=True)
    assert crossed[0] > crossed[-1]


def test_plans_are_shown_while_rules_give_way(sixteen: Path) -> None:
    told = Told()
    final = told.planner.solve(PlanRequest(str(sixteen), "locks: [P1.outer first, P1.outer last]\n"), 0.2, relax=True)
    (first, *_) = told.plans()
    assert (first["stage"], first["figures"]["dropped"] > 0) == ("first", True)
    assert first["figures"]["objective_mm"] >= final["figures"]["objective_mm"], "strips are paid for on the way, too"


def session_of(wanted: PlanRequest) -> Session:
    opened = {"sha256": sha256_of(Path(wanted.nest))}
    return Session("key", "plate.json", wanted, opened, News())


def test_a_plan_is_saved_once_its_program_is_checked(sixteen: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(plans_shown, "BARE_FROM", 10)
    told, wanted = Told(), PlanRequest(str(sixteen))
    told.planner.solve(wanted, 0.05)
    bare, checked = told.plans()[:2]
    session = session_of(wanted)
    number = session.add(bare, wanted, relax=False, run=0).number
    assert session.current is not None
    assert session.current.state == "unchecked"
    for refused in (lambda: save(session, Folder(sixteen.parent), "", ""), lambda: session.current.program):
        with pytest.raises(InputError, match="program of this plan is not"):
            refused()
    session.check(number, checked)
    session.check(number + 1, checked)  # of a plan that is gone
    assert [(one.number, one.state, one.run) for one in session.alternatives] == [(number, "kept", 0)]
    assert session.current.program
