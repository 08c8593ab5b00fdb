"""Parts of the server by themselves: job files' text, news, lists, who may ask, what is kept, how much is read."""

from __future__ import annotations

import contextlib
import http.client
import json
import os
import socket
import time
from collections.abc import AsyncIterator
from pathlib import Path

import httpx
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.apps.viewer.serve import guard, routes, run_server
from kerfwise.apps.viewer.serve.guard import MOST_BODY_BYTES, Keys
from kerfwise.apps.viewer.serve.job_edits import JobText
from kerfwise.apps.viewer.serve.kept_sessions import KeptSessions, NotPrivate, private_folder
from kerfwise.apps.viewer.serve.nest_folder import Folder, NestList, is_readable
from kerfwise.apps.viewer.serve.news import News
from kerfwise.apps.viewer.serve.plan_request import PlanRequest
from kerfwise.apps.viewer.serve.run_server import make_app
from kerfwise.apps.viewer.serve.server import Server, Serving
from kerfwise.apps.viewer.serve.session import Alternative, Session
from kerfwise.rules.lock import Lock
from kerfwise.rules.profile.overrides import lines_of
from kerfwise.tests.apps.viewer.serve.conftest import Look
from kerfwise.tests.apps.viewer.serve.served import SMALL, TOKEN, Open, Served, Tab, in_a_loop
from kerfwise.tests.apps.viewer.serve.test_guard import OWN
from kerfwise.tests.tools.amount import few

NAMES = st.one_of(
    st.text(st.characters(exclude_categories=("Cc", "Cs")), min_size=1, max_size=12),
    st.text('"\\ ab(:#-?', min_size=1, max_size=8),
).filter(str.strip)


@given(NAMES)
def test_a_lock_on_any_name_is_written_and_taken_back(name: str) -> None:
    before = "quantity: 2  # sheets\n"
    [line] = lines_of(Lock(contour=name, position="first"))
    text = JobText(before).with_lock(line)
    assert [lock.contour for _, lock in text.lines()] == [name]
    assert [said for said, _ in text.lines()] == [line]
    assert text.without_lock(line).text == before


def test_whoever_is_slow_to_listen_hears_each_thing_once() -> None:
    news = News()
    all_nests, one = news.listen(), news.listen("a")
    for _ in range(50):
        news.tell("progress", "a")
    news.tell("state", "b")
    news.tell("planner")
    assert in_a_loop(all_nests.next()) == [("progress", "a"), ("state", "b"), ("planner", "")]
    assert in_a_loop(one.next()) == [("progress", "a"), ("planner", "")]
    news.leave(one)
    assert news.listeners == 1
    assert news.server != News().server  # so that a tab sees that another server answers


@pytest.mark.slow
@pytest.mark.browser
def test_a_long_list_is_told_bit_by_bit(
    look: Look, served: Served, planned: Tab, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever it is sorted by, all of it can be seen; a state is that of the plan that is shown."""
    monkeypatch.setattr(routes, "MOST_ROWS", 2)
    monkeypatch.setattr(Alternative, "state", "kept but for")
    folder = planned.nest.parent
    for name in ("plate10.json", "Plate9.json", "Träger.json", "Traverse.json"):
        (folder / name).write_text(SMALL, encoding="utf-8")
    page = look().page
    page.goto(f"{served.address}/?list")
    page.fill("#filter", folder.name)
    page.click("#more button:has-text('3 are left')")
    page.wait_for_selector("#nests li:nth-child(4)")
    page.wait_for_selector("[aria-label$='small.json']:focus")
    page.click("#more button:has-text('1 is left')")
    page.wait_for_selector("#nests li:nth-child(5)")
    assert page.locator("#more button").count() == 0
    in_order = ["Plate9.json", "plate10.json", "small.json", "Träger.json", "Traverse.json"]
    assert page.locator("#nests b").all_inner_texts() == in_order
    page.select_option("#sort", "state")
    page.wait_for_selector("#nests li:first-child .warn:has-text('places not kept')")
    assert page.locator("#nests b").first.inner_text() == "small.json"


@pytest.mark.slow
def test_the_profile_that_the_server_was_given_goes_into_the_job_file(served: Served, opened: Open) -> None:
    assert (
        Server(served.server.folder, Serving("laser-wood"))._first_text(None, Path("/a/b.dxf"))
        == "profile: laser-wood\n"
    )
    assert Server(served.server.folder, Serving("/a/p.yaml"))._first_text("quantity: 2\n", Path("/a/b.dxf")) == (
        "quantity: 2\nprofile: p.yaml\n"
    )
    assert Server(served.server.folder, Serving("x"))._first_text("profile: y\n", Path("/a/b.dxf")) == "profile: y\n"


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="Windows has no such rights")
def test_nothing_is_kept_where_others_may_write(tmp_path: Path) -> None:
    shared = tmp_path / "shared"
    shared.mkdir()
    shared.chmod(0o777)
    with pytest.raises(NotPrivate, match="may be written by others"):
        private_folder(shared)
    told = KeptSessions(shared, tmp_path).told()
    assert (told["ok"], told["why"]) == (False, f"{shared} may be written by others")
    made = private_folder(tmp_path / "state" / "below")
    assert made.stat().st_mode & 0o077 == 0


@pytest.mark.parametrize("files", few([3_000, 60_000]))
def test_a_folder_of_many_files_is_listed_at_once_and_whole(tmp_path: Path, files: int) -> None:
    for k in range(files):
        (tmp_path / f"plate{k}.dxf").touch()
    (tmp_path / "below" / ".hidden").mkdir(parents=True)
    for name in ("below/a.json", "below/.hidden/b.json", "below/plate.plan.json", "below/other.json"):
        (tmp_path / name).write_text("{}" if "other" in name else SMALL, encoding="utf-8")
    nests = NestList(Folder(tmp_path.resolve()))
    found, complete = nests.known(0.2)
    while not complete:
        found, complete = nests.known(0.2)
    names = [one.name for one in found]
    assert names == ["below/a.json", *(f"plate{k}.dxf" for k in range(files))]  # as people count


@pytest.mark.parametrize("sent", ["", "GET / HTTP/1.1\r\nhost: 127", "GET / HTTP/1.1\r\n", "body", "second"])
def test_half_a_request_is_not_waited_for(served: Served, monkeypatch: pytest.MonkeyPatch, sent: str) -> None:
    monkeypatch.setattr(run_server, "HEAD_S", 0.3)
    monkeypatch.setattr(guard, "BODY_S", 0.3)
    whole = f"GET /api/nests HTTP/1.1\r\nhost: 127.0.0.1:{served.port}\r\nx-kerfwise-token: {TOKEN}\r\n\r\n"
    if sent == "body":
        sent = whole.replace("GET /api/nests", "POST /api/open").replace("\r\n\r\n", "\r\ncontent-length: 9\r\n\r\n{")
    if sent == "second":
        sent = whole + whole[:20]
    said = b""
    # It may have hung up before anything was sent.
    with socket.create_connection(("127.0.0.1", served.port), timeout=20) as way, contextlib.suppress(ConnectionError):
        way.sendall(sent.encode())
        while part := way.recv(65536):
            said += part
    assert said[:12] in (b"", b"HTTP/1.1 408", b"HTTP/1.1 200")


def test_who_does_not_take_what_is_sent_is_left(served: Served, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(run_server, "TAKEN_S", 0.3)
    ask = f"GET /files/page.css HTTP/1.1\r\nhost: 127.0.0.1:{served.port}\r\nx-kerfwise-token: {TOKEN}\r\n\r\n"
    with socket.socket() as way:
        way.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        way.settimeout(20)
        way.connect(("127.0.0.1", served.port))
        with contextlib.suppress(ConnectionError):  # a time-out, where it takes no more and stays, is none
            while True:
                way.sendall(ask.encode())
                time.sleep(0.0005)


def test_a_body_that_does_not_say_its_length_ends_at_the_limit(served: Served) -> None:
    browser = http.client.HTTPConnection("127.0.0.1", served.port, timeout=30)
    sent = 0

    def endless() -> object:
        nonlocal sent
        for _ in range(100):
            sent += 1_000_000
            yield b"x" * 1_000_000

    with contextlib.suppress(OSError):  # the server may hang up
        browser.request("POST", "/api/drop?name=a.json", endless(), OWN, encode_chunked=True)
    assert sent < 100_000_000 or browser.getresponse().status == 413
    assert sent >= MOST_BODY_BYTES


def test_who_sends_too_much_is_told_so(tmp_path: Path) -> None:
    async def endless() -> AsyncIterator[bytes]:
        for _ in range(40):
            yield b"x" * 1_000_000

    async def ask() -> httpx.Response:
        way = httpx.ASGITransport(make_app(Server(Folder(tmp_path)), Keys(TOKEN), 8000))
        async with httpx.AsyncClient(transport=way, base_url="http://127.0.0.1:8000", headers=OWN) as client:
            return await client.post("/api/drop?name=a.json", content=endless())

    answer = in_a_loop(ask())
    assert (answer.status_code, answer.json()["kind"]) == (413, "refused")
    assert "at most 32 MB" in answer.json()["message"]


def test_a_name_that_is_no_utf_8_is_listed_and_not_opened(served: Served, client: httpx.Client) -> None:
    name = os.fsdecode(b"Tr\xe4ger.json")
    (served.server.folder.path / name).write_text(SMALL, encoding="utf-8")
    served.listed(name)
    told = client.get("/api/nests").json()
    assert told["unreadable"] == ["Tr\\udce4ger.json"]
    assert all(is_readable(one) for one in told["nests"])
    answer = client.post("/api/open", content=json.dumps({"nest": name}))
    assert (answer.status_code, answer.json()["kind"]) == (422, "input")
    assert answer.json()["message"].startswith("'Tr\\\\udce4ger.json' is no name in UTF-8: ")


def test_a_session_that_is_damaged_or_of_another_version_hinders_no_nest(tmp_path: Path) -> None:
    nest, kept = tmp_path / "small.json", KeptSessions(tmp_path / "state", tmp_path)
    kept.keep(Session("abc", "small.json", PlanRequest("small.json"), {"sha256": ""}, News()))
    (file,) = (tmp_path / "state").rglob("session.json")
    sound = json.loads(file.read_text())
    assert kept.load("abc", nest) is not None
    damaged = [{**sound, name: value} for name in sound for value in ("x", 7, None, [[]])]
    damaged += [{name: value for name, value in sound.items() if name != gone} for gone in sound]
    damaged += [{**sound, "wanted": {**sound["wanted"], name: [3]}} for name in sound["wanted"]]
    for data in damaged:
        file.write_text(json.dumps(data))
        found = kept.load("abc", nest)
        assert found is None or isinstance(found.wanted.job_text, str | None), data
    assert kept.load("abc", nest) is None, "the last one is damaged"


@pytest.mark.parametrize("text", ["{", '{"format": "kerfwise-viewer/9", "wanted": "what only that version knows"}'])
def test_a_session_that_cannot_be_read_is_set_aside_and_named(tmp_path: Path, text: str) -> None:
    session = Session("abc", "small.json", PlanRequest("small.json"), {"sha256": ""}, News())
    KeptSessions(tmp_path / "state", tmp_path).keep(session)
    (file,) = (tmp_path / "state").rglob("session.json")
    file.write_text(text, encoding="utf-8")
    kept = KeptSessions(tmp_path / "state", tmp_path)
    assert kept.told("abc")["aside"] == ""
    for _ in range(2):  # what is kept afterwards is sound
        kept.keep(session)
        aside = Path(kept.told("abc")["aside"])
        assert aside.read_text(encoding="utf-8") == text
        assert sorted(path.name for path in file.parent.iterdir()) == sorted([aside.name, "session.json"])
    again = KeptSessions(tmp_path / "state", tmp_path)
    assert again.load("abc", tmp_path / "small.json") is not None
    again.keep(session)
    assert again.told("abc")["aside"] == ""
