"""Starts the server: on this machine's own address, with a new token, until Ctrl-C."""

from __future__ import annotations

import asyncio
import contextlib
import os
import socket
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from pathlib import Path

import uvicorn
from starlette.applications import Starlette
from starlette.routing import Route
from starlette.types import ASGIApp
from uvicorn.protocols.http.h11_impl import H11Protocol

from kerfwise.encoder.errors import InputError

from .guard import CODE, Guard, Keys, with_error_text
from .nest_folder import Folder
from .routes import Reading, Writing
from .server import Server, Serving

LOOPBACK = "127.0.0.1"
ENDING_S = 2
"""How long open connections are waited for at the end."""


def serve(
    path: Path,
    how: Serving,
    port: int,
    token_file: Path | None,
    ready: Callable[[str], None],
    another: Callable[[str], None],
) -> None:
    """Serve a folder of nests, or a nest and the folder that it is in, to this machine's browsers until Ctrl-C.

    Parameters
    ----------
    path
        The nest or the folder.
    port
        0 for any that is free.
    token_file
        Where the token for programs is written, for this user alone, until the server ends.
    ready
        Called with an address, a code for one browser in it, as soon as the server listens.
    another
        Called with the next address, once a browser has used the last one.

    Raises InputError if there is no such folder or nest, or the port is taken.
    """
    folder, first = _folder_of(path)
    server = Server(folder, how)
    before = server.kept.read_own(OWN)
    with contextlib.ExitStack() as until:
        listening = until.enter_context(contextlib.closing(_listening(port, before.get("port"))))
        port, keys = listening.getsockname()[1], Keys()
        if before.get("port") == port and isinstance(before.get("cookie"), str):
            keys.cookie = before["cookie"]  # pages that are still open go on
        server.kept.keep_own(OWN, {"port": port, "cookie": keys.cookie})

        def address() -> str:
            return f"http://{LOOPBACK}:{port}/?{CODE}={keys.code()}"

        keys.used = lambda: another(address())
        if token_file is not None:
            _write_token(token_file, keys.token)
            until.callback(token_file.unlink, missing_ok=True)
        listening.listen()
        ready(address())
        with contextlib.suppress(KeyboardInterrupt):
            uvicorn.Server(config_of(make_app(server, keys, port, first))).run(sockets=[listening])


OWN = "server.json"
"""What is kept of a folder's server: so a page that is still open finds the next one, and is known there."""


def _listening(port: int, before: object) -> socket.socket:
    """A socket at a port; with 0 at the one of the server before, if it is free, else at any that is."""
    tried = [port] if port else [before if isinstance(before, int) and 0 < before < 65536 else 0, 0]
    for one in tried:
        listener = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
        try:
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            listener.bind((LOOPBACK, one))
        except OSError as error:
            listener.close()
            if one == tried[-1]:
                raise InputError(f"--port {port}: {error.strerror}; leave it out for any that is free") from None
        else:
            return listener
    raise AssertionError


def _write_token(path: Path, token: str) -> None:
    """Write the token into a new file that only this user reads."""
    try:
        handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    except OSError as error:
        raise InputError(f"--token-file: {error.strerror}", file=path) from None
    with os.fdopen(handle, "w", encoding="ascii", newline="") as file:
        file.write(token)


def config_of(app: ASGIApp) -> uvicorn.Config:
    """How the application is run."""
    return uvicorn.Config(
        app, http=PromptProtocol, ws="none", lifespan="on", log_level="error", access_log=False, server_header=False,
        timeout_graceful_shutdown=ENDING_S, proxy_headers=False,
    )  # fmt: skip


HEAD_S, TAKEN_S = 15.0, 30.0
"""How long the head of a request may take to come, and somebody to take what is sent to them; then they are gone."""


class PromptProtocol(H11Protocol):
    """A connection that ends where its other end has come to a halt, so that nobody holds it for ever."""

    _halted: asyncio.TimerHandle | None = None
    _stuck: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Wait for the first request."""
        super().connection_made(transport)
        self._wait()

    def data_received(self, data: bytes) -> None:
        """Wait for the rest of the head of a request; its body is waited for by who reads it."""
        super().data_received(data)
        answering = self.cycle is not None and not self.cycle.response_complete
        if answering and self._halted is not None:
            self._halted.cancel()
            self._halted = None
        elif not answering and self._halted is None:
            self._wait()

    def pause_writing(self) -> None:
        """Nobody takes what is sent: for a while."""
        super().pause_writing()
        self._stuck = self.loop.call_later(TAKEN_S, self.transport.abort)

    def resume_writing(self) -> None:
        """It is taken."""
        super().resume_writing()
        self._rest()

    def connection_lost(self, exc: Exception | None) -> None:
        """Nothing is waited for any more."""
        super().connection_lost(exc)
        self._rest()
        if self._halted is not None:
            self._halted.cancel()

    def _wait(self) -> None:
        self._halted = self.loop.call_later(HEAD_S, self.transport.close)

    def _rest(self) -> None:
        if self._stuck is not None:
            self._stuck.cancel()
            self._stuck = None


def _folder_of(given: Path) -> tuple[Folder, str | None]:
    """The folder, and the name of the nest in it; None where a folder was given."""
    try:
        path = given.resolve()
        if path.is_dir():
            return Folder(path), None
        folder = Folder(path.parent)
        return folder, folder.nest(path.name).name if path.is_file() else _no_nest(given)
    except (OSError, ValueError, RuntimeError) as error:
        raise InputError(f"expected a nest or a folder of nests ({error})", file=given) from None


def _no_nest(path: Path) -> str:
    raise InputError("there is no such nest or folder", file=path)


# The application: its addresses behind the guard, and the processes for as long as it runs.

POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; "
    "connect-src 'self'; font-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
"""What the server's pages may load and do: nothing that is not the server's own."""


def make_app(server: Server, keys: Keys, port: int, first: str | None = None) -> Guard:
    """The whole application; `first` is the name of the nest that the server was started with."""

    @asynccontextmanager
    async def running(app: Starlette) -> AsyncIterator[None]:
        await server.begin()
        try:
            yield
        finally:
            await server.end()

    asked = (("GET", Reading(server, first).answers()), ("POST", Writing(server).answers()))
    routes = [
        Route(path, with_error_text(server, answer), methods=[method])
        for method, answers in asked
        for path, answer in answers.items()
    ]
    return Guard(Starlette(routes=routes, lifespan=running), keys, port, POLICY)
