"""A server on loopback with its two processes, and a browser's tab of a nest as a test drives it."""

from __future__ import annotations

import asyncio
import contextlib
import os
import socket
import threading
import time
from collections.abc import Callable, Coroutine, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import httpx
import pytest
import uvicorn

import kerfwise
from kerfwise.apps.viewer.serve.guard import Keys
from kerfwise.apps.viewer.serve.nest_folder import Folder
from kerfwise.apps.viewer.serve.run_server import config_of, make_app
from kerfwise.apps.viewer.serve.server import Server, Serving
from kerfwise.cli import main

TOKEN, COOKIE = "the-token-of-the-tests", "the-cookie-of-the-tests"
EXAMPLES = Path(kerfwise.__file__).parent / "examples" / "nests"
WAIT_S = 120.0
T = TypeVar("T")
SMALL = """{"format": "kerfwise-nest/1", "sheet": {"width": 400, "height": 120}, "parts": [
 {"id": "A", "outer": [[20, 20], [100, 20], [100, 100], [20, 100]],
  "holes": [[[50, 50], [70, 50], [70, 70], [50, 70]]]},
 {"id": "B", "outer": [[130, 20], [210, 20], [210, 100], [130, 100]]},
 {"id": "C", "outer": [[240, 20], [320, 20], [320, 100], [240, 100]]}]}
"""


def client_of(address: str, wait_s: float = WAIT_S, **headers: str) -> httpx.Client:
    """Whoever asks a server. That closes what was idle for 5 s, as long as httpx would use it again; this does not."""
    return httpx.Client(base_url=address, headers=headers, timeout=wait_s, limits=httpx.Limits(keepalive_expiry=1.0))


def browser_of(address: str, token: str = TOKEN, wait_s: float = WAIT_S) -> httpx.Client:
    """A browser that has the token, on the server's own pages."""
    return client_of(address, wait_s, **{"origin": address, "x-kerfwise-token": token})


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


class InThread(Server):
    """The server, and the loop of the thread that it runs in."""

    loop: asyncio.AbstractEventLoop

    async def begin(self) -> None:
        """As the server does."""
        self.loop = asyncio.get_running_loop()
        await super().begin()


@dataclass(frozen=True)
class Served:
    """A server that runs in this process, and where it listens."""

    server: InThread
    port: int
    keys: Keys
    also: Sequence[Path] = ()

    @property
    def address(self) -> str:
        return f"http://127.0.0.1:{self.port}"

    @property
    def entrance(self) -> str:
        """An address that lets one browser in."""
        return f"{self.address}/?code={self.keys.code()}"

    def listed(self, *names: str) -> None:
        """Wait until the list has these nests: of a folder that was just looked at it tells what was there."""
        wait_for(lambda: {*names} <= {one.name for one in self.server.nests.known(1.0)[0]})

    @contextlib.contextmanager
    def planner_taken(self, nest: str = "another nest") -> Iterator[None]:
        """The planner works for another nest until the end of the context: whoever plans waits, and nothing is done."""
        taken, let_go = threading.Event(), asyncio.Event()

        async def take() -> None:
            async with self.server.planning.turns.turn(nest):
                taken.set()
                await let_go.wait()

        done = asyncio.run_coroutine_threadsafe(take(), self.server.loop)
        assert taken.wait(WAIT_S)
        try:
            yield
        finally:
            self.server.loop.call_soon_threadsafe(let_go.set)
            done.result(WAIT_S)


@contextlib.contextmanager
def serving(folder: Path, work: float = 1.0, also: Sequence[Path] = ()) -> Iterator[Served]:
    """A server of a folder, on loopback, until the end of the context; it reads in `also`, too."""
    listening = socket.create_server(("127.0.0.1", 0))
    port = listening.getsockname()[1]
    server = InThread(Folder(folder.resolve()), Serving(work=work, also=also))
    keys = Keys(TOKEN, COOKIE)
    running = uvicorn.Server(config_of(make_app(server, keys, port)))
    thread = threading.Thread(target=running.run, args=([listening],), daemon=True)
    thread.start()
    try:
        yield Served(server, port, keys, also)
    finally:
        running.should_exit = True
        thread.join(30)


def saved_files(tab: Tab) -> dict[str, bytes]:
    """Save what is shown; the files beside the nest, by the ends of their names."""
    tab.state()
    tab.post("save")
    stem = tab.nest.stem
    return {p.name.removeprefix(f"{stem}."): p.read_bytes() for p in tab.nest.parent.iterdir() if p != tab.nest}


def in_a_loop(work: Coroutine[Any, Any, T]) -> T:
    """What a coroutine comes to, in a thread of its own: that of the tests has the loop of the browser."""
    with ThreadPoolExecutor(1) as thread:
        return thread.submit(asyncio.run, work).result()


def wait_for(what: Callable[[], Any]) -> None:
    """Wait until something is so."""
    ends = time.monotonic() + WAIT_S
    while not what():
        assert time.monotonic() < ends
        time.sleep(0.01)


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
