"""Nobody but the browser that was given the token is let in, from no other site, and not with everything."""

from __future__ import annotations

import http.client
from pathlib import Path

import httpx
import pytest

from kerfwise.tests.apps.viewer.serve.served import COOKIE, SMALL, TOKEN, Open, Served, client_of

OWN = {"x-kerfwise-token": TOKEN}


@pytest.fixture(scope="module")
def stranger(served: Served) -> httpx.Client:
    return client_of(served.address)


def test_without_the_token_nothing_is_told(served: Served, stranger: httpx.Client) -> None:
    for path in ("/", "/api/nests", "/files/worked.js", "/nest/x", "/api/x/events", "/nothing"):
        answer = stranger.get(path)
        assert (answer.status_code, answer.json()["kind"]) == (401, "refused"), path
    for said in (b"wrong", b"", TOKEN[:-1].encode(), "é".encode()):
        for headers in ({"x-kerfwise-token": said}, {"cookie": b"kerfwise-" + str(served.port).encode() + b"=" + said}):
            assert stranger.get("/api/nests", headers=headers).status_code == 401
    assert stranger.get("/?code=wrong").status_code == 401
    assert stranger.post("/api/open", json={"nest": "a"}, headers={"origin": str(stranger.base_url)}).status_code == 401


def test_a_code_in_the_address_becomes_a_cookie_once(served: Served) -> None:
    entrance = served.entrance
    with httpx.Client() as browser, httpx.Client() as other:
        answer = browser.get(entrance)
        assert (answer.status_code, answer.headers["location"]) == (303, "/")
        assert "HttpOnly" in answer.headers["set-cookie"]
        assert "SameSite=strict" in answer.headers["set-cookie"]
        assert TOKEN not in answer.headers["set-cookie"]  # whoever sees the one has not the other
        browser.base_url = served.address
        assert browser.get("/api/nests").status_code == 200
        assert browser.post("/api/open", json={}).status_code == 403  # it does not say where it comes from
        assert browser.post("/api/open", json={}, headers={"origin": served.address}).status_code == 422
        assert browser.get(entrance).status_code == 303  # the same browser may press reload
        assert other.get(entrance).status_code == 401
        for said in ({"x-kerfwise-token": COOKIE}, {"cookie": f"kerfwise-{served.port}={TOKEN}"}):
            assert other.get(f"{served.address}/api/nests", headers=said).status_code == 401


def test_a_browser_without_a_key_gets_a_page_in_words(served: Served, stranger: httpx.Client) -> None:
    for path in ("/", "/nest/x", "/?code=used"):
        answer = stranger.get(path, headers={"accept": "text/html,*/*"})
        assert (answer.status_code, answer.headers["content-type"]) == (401, "text/html; charset=utf-8")
        assert "An address lets one browser in, once" in answer.text
    answer = stranger.get("/nest/000000000000", headers=OWN)
    assert answer.status_code == 404
    assert "<h1>This nest cannot be shown</h1>" in answer.text


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "https://127.0.0.1:{port}", "http://127.0.0.1:1"])
def test_another_site_is_refused(served: Served, stranger: httpx.Client, origin: str) -> None:
    headers = {**OWN, "origin": origin.format(port=served.port)}
    assert stranger.get("/api/nests", headers=headers).status_code == 403
    assert stranger.post("/api/open", json={}, headers=headers).status_code == 403


def test_a_name_that_was_made_to_lead_here_is_refused(served: Served, stranger: httpx.Client) -> None:
    for host in ("evil.example", f"evil.example:{served.port}", "127.0.0.1", "127.0.0.1:1", ""):
        assert stranger.get("/api/nests", headers={**OWN, "host": host}).status_code in (400, 421), host
    assert stranger.get("/api/nests", headers={**OWN, "host": f"localhost:{served.port}"}).status_code == 200


def test_every_answer_has_strict_headers(client: httpx.Client, stranger: httpx.Client) -> None:
    for answer in (client.get("/"), client.get("/api/nests"), stranger.get("/"), client.get("/nothing")):
        assert answer.headers["content-security-policy"].startswith("default-src 'none'; script-src 'self'; ")
        assert answer.headers["x-content-type-options"] == "nosniff"
        assert answer.headers["cache-control"] == "no-store"
        assert "access-control-allow-origin" not in answer.headers
        assert "server" not in answer.headers


def test_a_hundred_megabytes_are_refused_before_they_are_sent(served: Served) -> None:
    browser = http.client.HTTPConnection("127.0.0.1", served.port, timeout=30)
    browser.putrequest("POST", "/api/drop?name=a.json")
    for name, value in {**OWN, "Content-Length": str(100_000_000)}.items():
        browser.putheader(name, value)
    browser.endheaders()
    answer = browser.getresponse()
    assert answer.status == 413
    assert b"at most 32 MB" in answer.read()


def test_cookies_of_other_servers_of_this_machine_are_no_matter(served: Served, stranger: httpx.Client) -> None:
    for other in ('settings={"a": 1}', "a b=c", "no-value", "=x"):
        cookies = f"{other}; kerfwise-{served.port}={COOKIE}; {other}"
        assert stranger.get("/api/nests", headers={"cookie": cookies}).status_code == 200, other


def test_an_address_with_a_code_leads_to_this_server(served: Served) -> None:
    for path in ("//evil.example/", "/\\\\evil.example/"):
        answer = httpx.get(f"{served.address}{path}", params={"code": served.keys.code()})
        assert (answer.status_code, answer.headers["location"]) == (303, "/evil.example/")


@pytest.mark.parametrize(
    "name",
    [
        "../outside.json", "/etc/passwd", "..", "a/../../outside.json", "", ".", "link.json", "linked/outside.json",
        "nothing.json", "a\x00.json", "..\\outside.json", "small.plan.json/../../outside.json",
    ],
)  # fmt: skip
def test_no_file_outside_the_folder_is_opened(served: Served, client: httpx.Client, tmp_path: Path, name: str) -> None:
    folder = served.server.folder.path
    (folder.parent / "outside.json").write_text(SMALL, encoding="utf-8")
    for link, to in ((folder / "link.json", folder.parent / "outside.json"), (folder / "linked", folder.parent)):
        if not link.is_symlink():
            link.symlink_to(to)
    answer = client.post("/api/open", json={"nest": name})
    assert answer.status_code == 422
    assert "no nest of this folder has the name" in answer.json()["message"]
    assert not any("outside" in nest or "link" in nest for nest in client.get("/api/nests").json()["nests"])


@pytest.mark.parametrize(
    "name", ["../a.json", "a/b.json", ".a.json", "a.exe", "", "a.plan.json", "a\\b.json", "a\n.json"]
)
def test_a_dropped_drawing_has_a_plain_name(client: httpx.Client, served: Served, name: str) -> None:
    before = sorted(served.server.folder.path.rglob("*"))
    answer = client.post("/api/drop", params={"name": name}, content=SMALL)
    assert answer.status_code == 422
    assert sorted(served.server.folder.path.rglob("*")) == before


@pytest.mark.parametrize("name", ["../app.py", "..%2fapp.py", "app.py", "%2e%2e/app.py", "frame.html", "/etc/passwd"])
def test_only_scripts_and_styles_of_the_package_are_given(client: httpx.Client, name: str) -> None:
    assert client.get(f"/files/{name}").status_code == 404


def test_a_name_with_a_script_in_it_is_shown_and_not_run(opened: Open, client: httpx.Client) -> None:
    name = "<script>alert(1)</script>"
    tab = opened(SMALL.replace('"B"', f'"{name}"'))
    tab.solved()
    page = client.get(f"/nest/{tab.id}")
    assert name not in page.text
    assert "'sha256-" in page.headers["content-security-policy"]
    assert "unsafe" not in page.headers["content-security-policy"]
    assert name in tab.get("why", contour=f"{name}.outer")["text"]
    for what in ("state", "page"):
        assert client.get(f"/api/{tab.id}/{what}").headers["content-type"] == "application/json"
    assert name in tab.get("page")["nest"]["parts"]


def test_what_is_not_json_is_said(opened: Open, client: httpx.Client) -> None:
    tab = opened()
    for body in (b"{", b"[1]", b"\xff", b'"x"'):
        assert client.post(f"/api/{tab.id}/edit", content=body).status_code == 422
    assert client.post("/api/nothing/edit", json={}).status_code == 404
    for changes in (None, "x", [1], [{}], [{"lock": 3}], [{"format": "c:"}], [{"lock": "P9 first"}], [{"set": "a.b"}]):
        assert tab.post("edit", 422, changes=changes)["kind"] == "input"
    for value in ("{", "[a: b: c]", "!!python/object:os.system x", "2024-13-45"):
        told = tab.edit({"set": "leads.lead_in", "to": value}, expected=422)
        assert told["message"] == f"{value!r} is not a value as a job file holds it"
    for changes, said in (
        ([{"lock": "P2 first", "when": "now"}], "a change 'lock': unknown key 'when' (valid: lock)"),
        ([{"unset": "a", "to": "3"}], "a change 'unset': unknown key 'to' (valid: unset)"),
        ([{"set": "a", "to": "4", "by": "b"}], "a change 'set': unknown key 'by' (valid: set, to)"),
    ):
        assert tab.post("edit", 422, changes=changes)["message"] == said
    for what, strange, valid in (("edit", "change", "changes"), ("solve", "wrok", "work"), ("cut", "up", "upto")):
        told = tab.post(what, 422, **{strange: 3})["message"]
        assert told.startswith(f"the body: unknown key {strange!r}")
        assert valid in told
    told = tab.post("effect", 422, changes=[{"rule": "pierce", "key": "clearance", "to": "2 mm", "form": "1 mm"}])
    assert told["message"].startswith("a change of a rule: unknown key 'form'")
    assert "unknown key 'name'" in client.post("/api/open", json={"name": "x"}).json()["message"]
    for changes in (5, [3], "x", [{}]):
        assert tab.post("try", 422, changes=changes)["kind"] == "input"
    moved = client.get(f"/api/{tab.id}/move", params={"place": 3})
    assert (moved.status_code, moved.json()["kind"]) == (422, "input")
    assert moved.json()["message"] == "contours: expected the id of a contour or the name of a part"
    assert tab.state()["job_text"] is None
