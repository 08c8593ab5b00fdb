"""What was shown is there again: after the server was killed at any moment, a restart, and changes from outside."""

from __future__ import annotations

import contextlib
import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx
import pytest
from playwright.sync_api import Browser

from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.tests.apps.viewer.serve.conftest import Look
from kerfwise.tests.apps.viewer.serve.served import SMALL, Open, Tab, browser_of, wait_for
from kerfwise.tests.tools.amount import few

pytestmark = pytest.mark.slow


@dataclass
class Killable:
    """`kerfwise serve` of a folder, as a process of its own that is killed and begun again."""

    folder: Path
    state: Path
    work: float = 0.5
    process: subprocess.Popen[str] | None = None
    client: httpx.Client = field(default_factory=httpx.Client)
    port: int = 0
    entrance: str = ""

    def begin(self) -> None:
        token = self.folder.parent / "token"
        token.unlink(missing_ok=True)
        words = ["serve", str(self.folder), "--work", str(self.work), "--token-file", str(token)]
        environment = {**os.environ, "KERFWISE_STATE": str(self.state)}
        self.process = subprocess.Popen(
            [sys.executable, "-m", "kerfwise", *words],
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            env=environment,
        )
        assert self.process.stdout is not None
        found = re.search(r"http://127\.0\.0\.1:(\d+)/\?code=\S+", self.process.stdout.readline())
        assert found is not None
        self.port, self.entrance = int(found[1]), found[0]
        address = f"http://127.0.0.1:{self.port}"
        self.client = browser_of(address, token.read_text(encoding="ascii"))

    def kill(self) -> None:
        assert self.process is not None
        self.process.send_signal(signal.SIGKILL)
        self.process.wait(10)
        self.client.close()

    def open(self, nest: str) -> dict[str, Any]:
        answer = self.client.post("/api/open", json={"nest": nest})
        assert answer.status_code == 200, answer.text
        told: dict[str, Any] = answer.json()
        return told

    def state_of(self, key: str) -> dict[str, Any]:
        told: dict[str, Any] = self.client.get(f"/api/{key}/state").json()
        return told

    def post(self, key: str, what: str, **said: Any) -> dict[str, Any]:
        version = self.state_of(key)["version"]
        told: dict[str, Any] = self.client.post(f"/api/{key}/{what}", json={"version": version, **said}).json()
        return told

    def planned(self, key: str, **said: Any) -> dict[str, Any]:
        self.post(key, "solve", **said)
        ends_s = time.monotonic() + 120
        while (state := self.state_of(key))["solving"] is not None:
            assert time.monotonic() < ends_s, state["solving"]
            time.sleep(0.05)
        return state


@pytest.fixture
def killable(tmp_path: Path) -> Iterator[Killable]:
    (tmp_path / "nests").mkdir()
    made = Killable(tmp_path / "nests", tmp_path / "state")
    yield made
    with contextlib.suppress(Exception):
        made.kill()


def watch(server: Killable, key: str, seen: list[dict[str, Any]], ended: threading.Event) -> None:
    """Note whatever the server tells of a nest, until it is killed."""
    with contextlib.suppress(httpx.HTTPError, ValueError, RuntimeError):  # the client is closed as the server is killed
        while not ended.is_set():
            told = server.state_of(key)
            if told not in seen:
                seen.append(told)


def work_on(server: Killable, key: str) -> None:
    """Plan, lock, plan, save and go back, as quickly as the server answers."""
    with contextlib.suppress(httpx.HTTPError, ValueError, KeyError, RuntimeError):
        server.post(key, "solve")
        time.sleep(0.4)
        for k, locks in enumerate(STEPS[1:]):
            server.post(key, "edit", changes=[{"lock": locks[-1]}], plan=True)
            time.sleep(0.3 + 0.1 * k)
            server.post(key, "save")


STEPS = [
    [],
    ["C.outer first"],
    ["B.outer first"],
    ["B.outer first", "C.outer last"],
    ["B.outer first", "C.outer last", "A.outer cw"],
]
"""The locks after each edit; the second one takes the place of the first."""


MOMENTS_S = few([1.4, 0.02, 0.1, 0.25, 0.45, 0.7, 1.0, 1.9, 2.4, 3.0])


@pytest.mark.parametrize("moment_s", MOMENTS_S)
def test_nothing_that_was_shown_is_lost_when_the_server_is_killed(killable: Killable, moment_s: float) -> None:
    nest = killable.folder / "small.json"
    nest.write_text(SMALL, encoding="utf-8")
    killable.begin()
    key = killable.open("small.json")["id"]
    seen: list[dict[str, Any]] = []
    ended = threading.Event()
    threads = [
        threading.Thread(target=watch, args=(killable, key, seen, ended)),
        threading.Thread(target=work_on, args=(killable, key)),
    ]
    for thread in threads:
        thread.start()
    time.sleep(moment_s)
    killable.kill()
    ended.set()
    for thread in threads:
        thread.join(30)
    port = killable.port
    killable.begin()
    assert killable.port == port  # the page that is still open finds it
    now = killable.open("small.json")
    expect_kept(seen, now)
    for plan in now["alternatives"]:
        assert killable.client.get(f"/api/{key}/page", params={"plan": plan["number"]}).json()["sides"]
    assert killable.planned(key)["solving"] is None
    names = {path.name for path in killable.folder.iterdir() if path.name.startswith("small.")}
    assert "small.nc" not in names or "small.plan.json" in names
    assert not [path for path in killable.folder.iterdir() if path.suffix == ".nc" and not path.read_text()]


def expect_kept(seen: list[dict[str, Any]], now: dict[str, Any]) -> None:
    """All plans that were shown are there, but for those whose place one with the same cuts took; and the locks."""
    there = {one["number"]: one["figures"]["objective_mm"] for one in now["alternatives"]}
    for told in seen:
        for one in told["alternatives"]:
            number, cost = one["number"], one["figures"]["objective_mm"]
            same = [other for other, of in there.items() if other > number and abs(of - cost) < 1e-6]
            assert there.get(number) == cost or same, (number, there)
    if seen:
        assert STEPS.index(now["locked"]) >= STEPS.index(seen[-1]["locked"])
        assert now["shown"] >= seen[-1]["shown"]


@pytest.mark.full
def test_a_planning_that_was_killed_has_its_first_plans_and_goes_on(killable: Killable) -> None:
    nest = killable.folder / "plate.json"
    nest.write_text(json.dumps(make_sheet(1, 30)), encoding="utf-8")
    killable.work = 100.0
    (killable.folder / "plate.job.yaml").write_text("set:\n  rules.zone-order: off\n", encoding="utf-8")
    killable.begin()
    key = killable.open("plate.json")["id"]
    killable.post(key, "solve")
    wait_for(lambda: killable.state_of(key)["alternatives"])
    before = killable.state_of(key)
    assert before["solving"] is not None
    killable.kill()
    killable.begin()
    page = killable.client.get(f"/nest/{key}")  # a reload
    assert page.headers["content-type"].startswith("text/html")
    assert "plate.json" in page.text
    now = killable.state_of(key)
    assert now["solving"] is None  # nothing says that it is being planned for ever
    assert now["problem"] == "the planning was interrupted: press Plan to take it up again"
    expect_kept([before], now)
    assert now["server"] != before["server"]
    killable.post(key, "edit", changes=[{"lock": "P1 first"}], plan=True)
    wait_for(lambda: any(one["locked"] for one in killable.state_of(key)["alternatives"]))


@pytest.mark.browser
def test_a_lost_connection_is_said_and_the_page_goes_on(look: Look, planned: Tab) -> None:
    at = look()
    at.page.route("**/api/events", lambda route: route.abort())
    at.open(planned)
    at.page.wait_for_selector("#hands-notices .lost")
    assert at.page.locator("#hands-save").is_disabled()
    assert at.page.locator("#hands-plan").is_disabled()
    planned.edit({"lock": "C.outer last"})  # another tab goes on meanwhile
    at.page.unroute("**/api/events")
    at.page.wait_for_selector("#hands-notices .lost", state="detached")
    at.page.wait_for_selector("#hands-locks li:has-text('C.outer last')", state="attached")
    at.wrong.clear()


@pytest.mark.full
@pytest.mark.browser
def test_a_page_that_is_open_goes_on_with_the_next_server(killable: Killable, browser: Browser) -> None:
    (killable.folder / "small.json").write_text(SMALL, encoding="utf-8")
    killable.begin()
    key = killable.open("small.json")["id"]
    killable.planned(key)
    page = browser.new_context().new_page()
    page.goto(killable.entrance)
    page.goto(f"http://127.0.0.1:{killable.port}/nest/{key}")
    page.wait_for_selector("#row-3")
    killable.post(key, "edit", changes=[{"lock": "C.outer last"}])
    page.wait_for_selector("#hands-locks li:has-text('C.outer last')", state="attached")
    killable.kill()
    page.wait_for_selector("#hands-notices .lost")
    killable.begin()
    page.wait_for_selector("#hands-notices .lost", state="detached")
    assert page.locator("#hands-plans li").count() == 1
    assert page.locator("#hands-locks li").count() == 1
    page.click("#hands-plan")
    wait_for(lambda: len(killable.state_of(key)["alternatives"]) == 2)
    page.context.close()


@pytest.mark.parametrize("use", ["kept", "disk"])
def test_a_job_file_that_changed_outside_throws_no_edits_away(opened: Open, use: str) -> None:
    tab = opened()
    tab.solved()
    tab.edit({"lock": "C.outer last"})
    job = tab.nest.with_name("small.job.yaml")
    again = opened(job="locks:\n  - B.outer first\n")
    now = again.state()
    assert now["locked"] == ["C.outer last"]
    (told,) = now["differences"]
    assert (told["what"], told["using"], told["unsaved"]) == ("job", "kept", True)
    assert told["lines"] == ["-   - B.outer first", "+   - C.outer last"]
    assert "say first which one counts" in again.post("save", 422)["message"]
    now = again.post("differences", job=use)
    assert (now["differences"], now["locked"]) == ([], ["C.outer last" if use == "kept" else "B.outer first"])
    assert [one["number"] for one in now["alternatives"]] == [1]
    again.solved()
    again.post("save")
    assert ("C.outer" in job.read_text()) == (use == "kept")
    assert "expected" in again.post("differences", 422, job="mine")["message"]


def test_a_job_file_that_changed_outside_is_taken_where_nobody_had_edited_it(opened: Open) -> None:
    tab = opened(job="locks:\n  - B.outer first\n")
    again = opened(job="locks:\n  - C.outer first\n")
    (told,) = again.state()["differences"]
    assert (told["using"], told["unsaved"], again.state()["locked"]) == ("disk", False, ["C.outer first"])
    assert again.post("differences", job="kept")["locked"] == ["B.outer first"]
    assert tab.id == again.id


def test_edits_that_do_not_go_with_a_changed_drawing_are_told_and_kept(opened: Open) -> None:
    tab = opened()
    tab.solved()
    tab.edit({"lock": "C.outer last"})
    again = opened(SMALL.replace('"id": "C"', '"id": "D"'))
    now = again.state()
    drawing, edits = now["differences"]
    assert drawing["parts"] == {"added": ["D"], "removed": ["C"], "changed": []}
    assert (edits["using"], edits["unsaved"]) == ("disk", True)
    assert "C.outer" in edits["why"]
    assert (now["locked"], now["shown"], now["alternatives"][0]["of_now"]) == ([], 0, False)
    assert again.get("page", plan=1)["sides"]
    again = opened()  # it was a mistake
    assert again.post("differences", job="kept")["locked"] == ["C.outer last"]
    assert again.post("back", to=1)["fits"]


@pytest.mark.full
def test_a_damaged_plan_is_left_aside_and_the_others_are_there(killable: Killable) -> None:
    (killable.folder / "small.json").write_text(SMALL, encoding="utf-8")
    killable.begin()
    key = killable.open("small.json")["id"]
    killable.planned(key)
    killable.post(key, "edit", changes=[{"lock": "C.outer first"}])
    killable.planned(key)
    killable.kill()
    plans = sorted(killable.state.rglob("plan-*.zip"))
    plans[0].write_bytes(plans[0].read_bytes()[:200])
    killable.begin()
    now = killable.open("small.json")
    assert [one["number"] for one in now["alternatives"]] == [2]
    assert plans[0].exists()
    for path in killable.state.rglob("session.json"):
        path.write_text("{", encoding="utf-8")
    killable.kill()
    killable.begin()
    assert [one["number"] for one in killable.open("small.json")["alternatives"]] == [2]
