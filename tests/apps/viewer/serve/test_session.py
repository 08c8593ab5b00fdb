"""A session: lock, plan, back, what is cut already, a conflict, two plans side by side."""

from __future__ import annotations

import json

import httpx
import pytest

from kerfwise.tests.apps.viewer.serve.served import SMALL, Open, Served, Tab, command_line, saved_files

pytestmark = pytest.mark.slow


CLASH = ({"lock": "A.outer first"}, {"lock": "B.outer 2nd"})


ORDER = "A.hole1 A.outer B.outer C.outer"


def order_of(tab: Tab) -> str:
    plan = json.loads(saved_files(tab)["plan.json"])
    return " ".join(cut["contour"] for cut in plan["cuts"])


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
    assert (back["shown"], back["locked"], back["fits"], len(back["alternatives"])) == (1, [], False, 2)
    assert tab.solved()["shown"] == 3  # a job file is there by now, if an empty one
    assert order_of(tab) == ORDER
    assert tab.post("back", 422, to=9)["message"] == "there is no plan 9 in this session"


def test_what_was_wanted_is_wanted_again_in_one_request(opened: Open) -> None:
    """As an undo asks for it: the plan, the job file to the byte, and what is cut already, or none of it."""
    tab = opened(job="locks: [C first]  # ours\n")
    tab.solved()
    before = tab.state()
    tab.edit({"lock": "A.outer cw"}, {"set": "leads.lead_in", "to": "4 mm"})
    tab.solved()
    tab.post("cut", upto=1)
    after = tab.state()
    again = {key: before[key] for key in ("job_text", "upto")}
    told = tab.post("back", to=before["shown"], **again)
    assert (told["fits"], told["job_text"], told["locked"]) == (True, "locks: [C first]  # ours\n", ["C first"])
    again = {key: after[key] for key in ("job_text", "upto")}
    told = tab.post("back", to=after["shown"], **again)
    assert [told[key] for key in ("shown", "upto", "job_text")] == [after["shown"], 1, after["job_text"]]
    version = tab.state()["version"]
    for wrong in ({"job_text": "locks: [Z first]\n"}, {"job_text": "a: b: c"}, {"job_text": 3}, {"upto": 99}):
        assert tab.post("back", 422, to=1, **wrong)["kind"] == "input"
    now = tab.state()
    assert (now["version"], now["job_text"]) == (version, after["job_text"])
    assert tab.post("back", to=0, job_text=None, upto=0)["shown"] == 0


def test_cut_up_to_here(opened: Open, served: Served, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(served.server.planning, "_memory_gb", 1.5)
    tab = opened()
    tab.solved()
    assert tab.post("cut", 200, upto=2)["upto"] == 2
    told = tab.solved()
    saved = saved_files(tab)
    plan = json.loads(saved["plan.json"])
    assert ([cut["contour"] for cut in plan["cuts"]], plan["resumed_after"]) == (["B.outer", "C.outer"], 2)
    assert told["alternatives"][1]["command"].endswith(
        "--lock-from small.before.plan.json --upto 2 --work 1 --memory 1.5"
    )
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


def test_a_nest_that_changed_on_disk_is_shown_anew_and_keeps_its_plans(opened: Open, served: Served) -> None:
    tab = opened()
    tab.solved()
    session, sha256 = served.server.sessions[tab.id], tab.state()["sha256"]
    again = opened(SMALL.replace("[240, 20], [320, 20]", "[240, 20], [325, 20]"))
    assert served.server.sessions[tab.id] is session
    state = again.state()
    assert (again.version > tab.version, state["shown"], state["fits"]) == (True, 0, False)
    assert [(one["number"], one["of_now"]) for one in state["alternatives"]] == [(1, False)]
    assert state["differences"][0]["parts"] == {"added": [], "removed": [], "changed": ["C"]}
    assert again.get("page", plan=1)["sides"]  # it can still be looked at
    assert state["sha256"] != sha256
    assert again.solved()["shown"] == 2  # a number is that of one plan only
    assert again.post("differences", nest="seen")["differences"] == []


def test_plans_of_many_open_nests_are_all_found_again(opened: Open, client: httpx.Client) -> None:
    """More nests than anybody looks at: the first one still has its plan, and what it was made of."""
    tab = opened()
    tab.edit({"lock": "C.outer first"})
    tab.solved()
    page, program = tab.get("page"), client.get(f"/api/{tab.id}/program").text
    for k in range(45):
        opened(SMALL, f"other{k}.json")
    assert tab.get("page") == page
    assert client.get(f"/api/{tab.id}/program").text == program
    assert tab.state()["locked"] == ["C.outer first"]
    assert program.encode() == saved_files(tab)["nc"]
