"""A session: lock, plan, undo, conflict, save; two tabs, a killed process, a closed browser."""

from __future__ import annotations

import asyncio
import json
import os
import socket
import threading
import time
from pathlib import Path
from typing import Any

import httpx
import pytest

from kerfwise.cli import main
from kerfwise.serving.effect import Effects
from kerfwise.serving.news import News
from kerfwise.serving.server import Server
from kerfwise.serving.wanted import Wanted
from kerfwise.tests.serving.conftest import EXAMPLES, SMALL, Open, Served, Tab

pytestmark = pytest.mark.slow

CLASH = ({"lock": "A.outer first"}, {"lock": "B.outer 2nd"})
ORDER = "A.hole1 A.outer B.outer C.outer"
BROKEN = SMALL.replace("[[130, 20], [210, 20], [210, 100], [130, 100]]", "[[90, 20], [210, 20], [210, 100], [90, 100]]")


def order_of(tab: Tab) -> str:
    plan = json.loads(saved_files(tab)["plan.json"])
    return " ".join(cut["contour"] for cut in plan["cuts"])


def saved_files(tab: Tab) -> dict[str, bytes]:
    tab.state()
    tab.post("save")
    stem = tab.nest.stem
    return {p.name.removeprefix(f"{stem}."): p.read_bytes() for p in tab.nest.parent.iterdir() if p != tab.nest}


def command_line(folder: Path, command: str) -> None:
    """Run a command line in a folder, as a person there would."""
    name, *words = command.split()
    assert name == "kerfwise"
    before = Path.cwd()
    os.chdir(folder)
    try:
        with pytest.raises(SystemExit) as ended:
            main(words)
    finally:
        os.chdir(before)
    assert ended.value.code == 0


def test_lock_and_plan_and_back(opened: Open) -> None:
    tab = opened()
    assert tab.state()["alternatives"] == []
    first = tab.solved()
    assert [first["alternatives"][0]["figures"][key] for key in ("status", "cuts")] == ["optimal", 4]
    assert order_of(tab) == ORDER
    told = tab.edit({"lock": "C.outer first"})
    assert (told["locked"], told["fits"], told["shown"]) == (["C.outer first"], False, 1)
    assert tab.solved()["shown"] == 2
    assert order_of(tab).startswith("C.outer ")
    told = tab.edit({"lock": "C.outer last"})
    assert (told["undone"], told["locked"]) == (["C.outer first"], ["C.outer last"])
    back = tab.post("back", to=1)
    assert (back["shown"], back["locked"], back["fits"], len(back["alternatives"])) == (1, [], True, 2)
    assert order_of(tab) == ORDER
    assert tab.post("back", 422, to=9)["message"] == "there is no plan 9 in this session"


JOB = "# of the night shift\norder: '4711'  # the order\nlocks:\n  - B.outer before C.outer  # as ever\n"


@pytest.mark.parametrize("job", [None, JOB])
def test_what_is_saved_is_what_the_command_line_writes(opened: Open, job: str | None) -> None:
    tab = opened(job=job)
    tab.edit({"lock": "no link C.outer"}, {"lock": "B position 3"}, {"set": "rules.heat-lag.weight", "to": "80 mm"})
    told = tab.solved()
    saved = saved_files(tab)
    assert sorted(saved) == ["job.yaml", "nc", "plan.json", "svg"]
    assert b"heat-lag.weight: 80 mm" in saved["job.yaml"]
    if job is not None:
        assert saved["job.yaml"].decode().startswith(JOB)
    for name in ("nc", "plan.json", "svg"):
        tab.nest.with_name(f"{tab.nest.stem}.{name}").unlink()
    command_line(tab.nest.parent, told["alternatives"][0]["command"])
    again = {name: tab.nest.with_name(f"{tab.nest.stem}.{name}").read_bytes() for name in saved}
    assert again == saved


def test_cut_up_to_here(opened: Open) -> None:
    tab = opened()
    tab.solved()
    assert tab.post("cut", 200, upto=2)["upto"] == 2
    told = tab.solved()
    saved = saved_files(tab)
    plan = json.loads(saved["plan.json"])
    assert ([cut["contour"] for cut in plan["cuts"]], plan["resumed_after"]) == (["B.outer", "C.outer"], 2)
    assert told["alternatives"][1]["command"].endswith("--lock-from small.before.plan.json --upto 2 --work 1")
    tab.nest.with_name("small.nc").unlink()
    command_line(tab.nest.parent, told["alternatives"][1]["command"])
    assert tab.nest.with_name("small.nc").read_bytes() == saved["nc"]
    assert tab.get("move", contours="C", place=3)["lawful"] is False
    assert tab.post("cut", 422, upto=99)["kind"] == "input"
    assert tab.post("cut", 200, upto=0)["upto"] == 0


def test_a_conflict_says_what_each_way_out_would_bring(opened: Open, client: httpx.Client) -> None:
    tab = opened()
    tab.edit(*CLASH)
    told = tab.solved()
    clash = {one["rule"]: one for one in told["conflict"]["clash"]}
    assert told["conflict"]["minimal"]
    assert clash["locks"]["undo"] == [{"unlock": "A.outer first"}]
    assert clash["inner-before-outer"]["soften"] == [{"set": "rules.inner-before-outer.strength", "to": "soft"}]
    undone = client.post(f"/api/{tab.id}/try", json={"changes": clash["locks"]["undo"]}).json()
    assert undone["works"]
    assert undone["text"].startswith("a plan with ")
    soft = client.post(f"/api/{tab.id}/try", json={"changes": clash["inner-before-outer"]["soften"]}).json()
    assert (soft["works"], soft["text"][:27]) == (False, "another contradiction is le")
    relaxed = client.post(f"/api/{tab.id}/try", json={"relax": True}).json()
    assert relaxed["works"]
    assert relaxed["text"].endswith("relaxed")
    assert tab.state()["alternatives"] == []  # nothing of this has changed anything
    assert tab.solved(relax=True)["alternatives"][0]["command"] == "kerfwise solve small.json --work 1 --relax"


def test_two_tabs_see_the_same_and_neither_writes_over_the_other(opened: Open, client: httpx.Client) -> None:
    one = opened()
    two = Tab(client, one.id, one.version, one.nest)
    one.edit({"lock": "C.outer last"})
    refused = two.edit({"lock": "B.outer first"}, expected=409)
    assert (refused["kind"], refused["locked"]) == ("stale", ["C.outer last"])
    assert two.version == one.version
    assert two.edit({"lock": "B.outer cw"})["locked"] == ["C.outer last", "B.outer cw"]
    for what, said in (("solve", {}), ("back", {"to": 1}), ("save", {}), ("cut", {"upto": 1})):
        assert one.client.post(f"/api/{one.id}/{what}", json={"version": one.version, **said}).status_code == 409
        assert one.client.post(f"/api/{one.id}/{what}", json=said).status_code == 409


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


def wait_for(what: Any) -> None:
    ends = time.monotonic() + 30
    while not what():
        assert time.monotonic() < ends
        time.sleep(0.01)


def test_incumbents_stream_in_and_can_be_stopped(plate: Tab, served: Served) -> None:
    tab = plate
    found: list[tuple[str, dict[str, Any]]] = []
    before = served.server.news.listeners
    done = threading.Thread(target=events, args=(tab, lambda found: bool(found[-1][1].get("alternatives")), found))
    done.start()
    wait_for(lambda: found)
    tab.post("solve", 202, work=200)
    assert "is being planned" in tab.post("solve", 422)["message"]
    wait_for(lambda: any((told["solving"] or {}).get("objective_mm") for _, told in list(found)))
    assert served.server.planning.helper.pid is not None
    tab.client.post(f"/api/{tab.id}/cancel", json={})
    state = tab.wait()
    done.join(30)
    assert not done.is_alive()
    wait_for(lambda: served.server.news.listeners == before)  # the tab is closed
    plan = state["alternatives"][0]
    assert plan["ok"]
    reached = [told["solving"]["objective_mm"] for what, told in found if what == "progress" and told["solving"]]
    assert sorted((mm for mm in reached if mm), reverse=True) == [mm for mm in reached if mm]
    assert plan["stopped"]
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


def test_a_dropped_drawing_is_kept_once_it_can_be_cut(client: httpx.Client, served: Served, tmp_path: Path) -> None:
    name = f"{tmp_path.name}.json"
    answer = client.post("/api/drop", params={"name": name}, content=BROKEN)
    told = answer.json()
    assert (answer.status_code, told["kind"]) == (422, "input")
    assert any(problem["contours"] for problem in told["problems"]["lines"])
    assert told["problems"]["page"]["alert"] == [1, 2]
    assert not (served.server.folder.path / name).exists()
    answer = client.post("/api/drop", params={"name": name}, content=SMALL)
    assert (answer.status_code, answer.json()["nest"]) == (201, name)
    assert (served.server.folder.path / name).read_text(encoding="utf-8") == SMALL
    assert client.post("/api/drop", params={"name": name}, content=SMALL).status_code == 201
    assert "another file" in client.post("/api/drop", params={"name": name}, content=SMALL + " ").json()["message"]


def test_nothing_is_written_over_what_changed_on_disk(opened: Open) -> None:
    tab = opened(job="quantity: 2\n")
    tab.edit({"lock": "C.outer last"})
    tab.solved()
    job = tab.nest.with_name("small.job.yaml")
    job.write_text("quantity: 3\n", encoding="utf-8")
    assert "has changed on disk" in tab.post("save", 422)["message"]
    assert job.read_text(encoding="utf-8") == "quantity: 3\n"
    assert not tab.nest.with_name("small.nc").exists()
    tab.nest.write_text(SMALL + "\n", encoding="utf-8")
    assert "the nest has changed on disk" in tab.post("save", 422)["message"]
    tab.edit({"lock": "B.outer cw"})  # it is read again meanwhile, and the plan is the old one still
    assert tab.post("back", 200, to=1)["fits"] is False
    assert "the nest has changed on disk" in tab.post("save", 422)["message"]
    tab.nest.unlink()
    for what in ("save", "edit"):
        assert tab.post(what, 422, changes=[])["message"] == "there is no such file"


def test_a_nest_that_changed_on_disk_is_shown_anew_in_every_tab(opened: Open, served: Served) -> None:
    tab = opened()
    tab.solved()
    session, sha256 = served.server.sessions[tab.id], tab.state()["sha256"]
    again = opened(SMALL + "\n")
    assert served.server.sessions[tab.id] is session
    assert (again.version > tab.version, again.state()["alternatives"]) == (True, [])
    assert again.state()["sha256"] != sha256
    assert again.solved()["shown"] == 2  # a number is that of one plan only


def test_nothing_is_written_where_a_link_leads_out_of_the_folder(opened: Open, served: Served) -> None:
    tab = opened()
    tab.solved()
    outside = served.server.folder.path.parent / "mine.txt"
    outside.write_text("mine", encoding="utf-8")
    tab.nest.with_name("small.nc").symlink_to(outside)
    assert "leads out of the folder" in tab.post("save", 422)["message"]
    assert outside.read_text(encoding="utf-8") == "mine"
    assert not tab.nest.with_name("small.plan.json").exists()


def test_the_old_plan_takes_no_place_of_another_nests(opened: Open) -> None:
    tab = opened()
    tab.solved()
    tab.post("cut", upto=2)
    tab.solved()
    before = tab.nest.with_name("small.before.plan.json")
    before.write_text('{"nest": {"file": "small.dxf"}}', encoding="utf-8")
    assert "is of small.dxf" in tab.post("save", 422)["message"]
    assert "small.dxf" in before.read_text(encoding="utf-8")


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
    ended = effects.effect(Wanted(str(nest)), values)["before"]
    going[0] = True
    assert effects.effect(Wanted(str(nest)), values)["before"]["objective_mm"] < ended["objective_mm"]


def test_two_plans_are_put_side_by_side(opened: Open, client: httpx.Client) -> None:
    tab = opened()
    tab.solved()
    tab.edit({"lock": "C.outer first"})
    tab.solved()
    both = client.get(f"/api/{tab.id}/page", params={"plan": 1, "with": 2}).json()
    contours = [contour["id"] for contour in both["nest"]["contours"]]
    orders = [[contours[cut["contour"]] for cut in side["cuts"]] for side in both["sides"]]
    assert [side["name"] for side in both["sides"]] == ["A: plan 1", "B: plan 2"]
    assert [" ".join(order) for order in orders] == [ORDER, "C.outer A.hole1 A.outer B.outer"]
    assert all(side["nc"]["text"] for side in both["sides"])
    changed = {contours[one["contour"]]: (one["a"], one["b"]) for one in both["comparison"]["changed"]}
    assert changed["C.outer"] == (4, 1)
    assert client.get(f"/api/{tab.id}/page", params={"with": 2}).status_code == 422
    assert client.get(f"/api/{tab.id}/page", params={"plan": 1, "with": 9}).status_code == 422
    told = [tab.get("why", contour="C.outer", plan=number)["place"] for number in (1, 2)]
    assert told == [4, 1]


def test_whoever_is_slow_to_listen_hears_each_thing_once() -> None:
    news = News()
    all_nests, one = news.listen(), news.listen("a")
    for _ in range(50):
        news.tell("progress", "a")
    news.tell("state", "b")
    news.tell("planner")
    assert asyncio.run(all_nests.next()) == [("progress", "a"), ("state", "b"), ("planner", "")]
    assert asyncio.run(one.next()) == [("progress", "a"), ("planner", "")]
    news.leave(one)
    assert news.listeners == 1
    assert news.server != News().server  # so that a tab sees that another server answers


def test_one_stream_has_the_news_of_all_nests(opened: Open, client: httpx.Client) -> None:
    first, found = opened(), []
    with client.stream("GET", "/api/events") as answer:
        lines = answer.iter_lines()
        told = (json.loads(line.removeprefix("data: ")) for line in lines if line.startswith("data: "))
        found.append(next(one for one in told if one.get("id") == first.id))
        first.edit({"lock": "C.outer last"})
        found.append(next(one for one in told if one.get("id") == first.id))
        other = opened(SMALL, "other.json")  # it was not open when the stream began
        other.solved()
        names = next(one for one in told if one.get("alternatives"))
    assert [one["locked"] for one in found] == [[], ["C.outer last"]]
    assert (names["nest"], len(names["alternatives"])) == (other.state()["nest"], 1)


def test_a_profile_that_changed_on_disk_judges_the_moves_of_its_plans(opened: Open, tmp_path: Path) -> None:
    plant = tmp_path / "plant.yaml"
    strength = "based_on: plasma-carbon-steel\nrules:\n  level-ahead: {strength: %s}\n"
    plant.write_text(strength % "hard", encoding="utf-8")
    tab = opened(job=f"profile: {plant.as_posix()}\n")
    tab.solved()
    assert "level-ahead" in tab.get("move", contours="C", place=3)["text"]
    plant.write_text(strength % "off", encoding="utf-8")
    tab.state()
    assert "the profile has changed on disk" in tab.post("save", 422)["message"]
    assert not tab.nest.with_name("small.nc").exists()
    tab.solved()
    tab.state()
    tab.post("save")
    assert tab.nest.with_name("small.nc").exists()
    assert "level-ahead" not in tab.get("move", contours="C", place=3)["text"]


def test_the_profile_that_the_server_was_given_goes_into_the_job_file(served: Served, opened: Open) -> None:
    assert Server(served.server.folder, "laser-wood")._first_text(None, Path("/a/b.dxf")) == "profile: laser-wood\n"
    assert Server(served.server.folder, "/a/p.yaml")._first_text("quantity: 2\n", Path("/a/b.dxf")) == (
        "quantity: 2\nprofile: p.yaml\n"
    )
    assert Server(served.server.folder, "x")._first_text("profile: y\n", Path("/a/b.dxf")) == "profile: y\n"
