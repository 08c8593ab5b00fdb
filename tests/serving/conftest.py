"""A server on loopback with its two processes, for the tests of a file; each takes a folder of its own."""

from __future__ import annotations

import contextlib
import json
import shutil
import socket
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
import pytest
import uvicorn
from playwright.sync_api import Browser

import kerfwise
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.serving.app import make_app
from kerfwise.serving.folder import Folder
from kerfwise.serving.run import config_of
from kerfwise.serving.server import Server
from kerfwise.tests.tools.browser import launched

TOKEN = "the-token-of-the-tests"
EXAMPLES = Path(kerfwise.__file__).parent / "examples" / "nests"
WAIT_S = 120.0
SMALL = """{"format": "kerfwise-nest/1", "sheet": {"width": 400, "height": 120}, "parts": [
 {"id": "A", "outer": [[20, 20], [100, 20], [100, 100], [20, 100]],
  "holes": [[[50, 50], [70, 50], [70, 70], [50, 70]]]},
 {"id": "B", "outer": [[130, 20], [210, 20], [210, 100], [130, 100]]},
 {"id": "C", "outer": [[240, 20], [320, 20], [320, 100], [240, 100]]}]}
"""


@dataclass
class Tab:
    """A browser's tab of one nest, as a test drives it."""

    client: httpx.Client
    id: str
    version: int
    nest: Path
    wait_s: float = WAIT_S

    def get(self, what: str, **query: Any) -> Any:
        answer = self.client.get(f"/api/{self.id}/{what}", params=query)
        assert answer.status_code == 200, answer.text
        return answer.json()

    def state(self) -> dict[str, Any]:
        told: dict[str, Any] = self.get("state")
        self.version = told["version"]
        return told

    def post(self, what: str, expected: int = 200, **said: Any) -> dict[str, Any]:
        answer = self.client.post(f"/api/{self.id}/{what}", json={"version": self.version, **said})
        assert answer.status_code == expected, (answer.status_code, answer.text)
        told: dict[str, Any] = answer.json()
        self.version = told.get("version", self.version)
        return told

    def edit(self, *changes: dict[str, str], expected: int = 200) -> dict[str, Any]:
        return self.post("edit", expected, changes=list(changes))

    def solved(self, **said: Any) -> dict[str, Any]:
        self.post("solve", 202, **said)
        return self.wait()

    def wait(self, until: Callable[[dict[str, Any]], bool] = lambda state: state["solving"] is None) -> dict[str, Any]:
        ends = time.monotonic() + self.wait_s
        while not until(state := self.state()):
            assert time.monotonic() < ends, state
            time.sleep(0.02)
        return state


Open = Callable[..., Tab]


@dataclass(frozen=True)
class Served:
    """A server that runs in this process, and where it listens."""

    server: Server
    port: int

    @property
    def address(self) -> str:
        return f"http://127.0.0.1:{self.port}"


@contextlib.contextmanager
def serving(folder: Path, work: float = 1.0) -> Iterator[Served]:
    """A server of a folder, on loopback, until the end of the context."""
    listening = socket.create_server(("127.0.0.1", 0))
    port = listening.getsockname()[1]
    server = Server(Folder(folder.resolve()), work=work)
    running = uvicorn.Server(config_of(make_app(server, TOKEN, port)))
    thread = threading.Thread(target=running.run, args=([listening],), daemon=True)
    thread.start()
    try:
        yield Served(server, port)
    finally:
        running.should_exit = True
        thread.join(30)


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    with serving(tmp_path_factory.mktemp("nests")) as made:
        yield made


@pytest.fixture(scope="module")
def client(served: Served) -> Iterator[httpx.Client]:
    """A browser that has the token, on the server's own pages."""
    headers = {"origin": served.address, "x-kerfwise-token": TOKEN}
    with httpx.Client(base_url=served.address, headers=headers, timeout=WAIT_S) as made:
        yield made


@pytest.fixture
def opened(served: Served, client: httpx.Client, tmp_path: Path) -> Open:
    """Puts a nest into a folder of the test's own, and opens it."""

    def opens(nest: str | Path = SMALL, name: str = "small.json", job: str | None = None) -> Tab:
        folder = served.server.folder.path / tmp_path.name
        folder.mkdir(exist_ok=True)
        if isinstance(nest, Path):
            name = nest.name
            shutil.copy(nest, folder / name)
        else:
            (folder / name).write_text(nest, encoding="utf-8")
        if job is not None:
            (folder / f"{Path(name).stem}.job.yaml").write_text(job, encoding="utf-8")
        answer = client.post("/api/open", json={"nest": f"{tmp_path.name}/{name}"})
        assert answer.status_code == 200, answer.text
        return Tab(client, answer.json()["id"], answer.json()["version"], folder / name)

    return opens


@pytest.fixture
def plate(opened: Open) -> Tab:
    """A plate that is planned for minutes with 200 of work: without zones nothing is proven of it."""
    return opened(json.dumps(make_sheet(1, 60)), "plate.json", "set:\n  rules.zone-order: off\n")


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """One browser for the tests of a file."""
    with launched() as made:
        yield made
