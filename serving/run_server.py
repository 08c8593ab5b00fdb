"""Starts the server: on this machine's own address, with a new token, until Ctrl-C."""

from __future__ import annotations

import contextlib
import secrets
import socket
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from pathlib import Path

import uvicorn
from starlette.applications import Starlette
from starlette.routing import Route
from starlette.types import ASGIApp

from kerfwise.encoder.errors import InputError
from kerfwise.jobs.request import WORK
from kerfwise.models.engines.solution import MEMORY_GB

from .guard import TOKEN, Guard, with_error_text
from .nest_folder import Folder
from .routes import Reading, Writing
from .server import Server

LOOPBACK = "127.0.0.1"
ENDING_S = 2
"""How long open connections are waited for at the end."""


def serve(
    given: Path,
    *,
    port: int = 0,
    profile: str | None = None,
    work: float = WORK,
    memory_gb: float = MEMORY_GB,
    trust: bool = False,
    ready: Callable[[str], None] = print,
) -> None:
    """Serve a folder of nests, or a nest and the folder that it is in, to this machine's browsers until Ctrl-C.

    Parameters
    ----------
    given
        The nest or the folder.
    port
        0 for any that is free.
    profile
        What nests are planned by whose job file names none, as `load_profile` takes it.
    work
        How much goes into a plan.
    memory_gb
        What the process that plans may hold, but for CP-SAT and linear programs.
    trust
        Whether Python rules of profiles are run.
    ready
        Called with the address, the token in it, as soon as the server listens.

    Raises
    ------
    InputError
        If there is no such folder or nest, or the port is taken.
    """
    folder, first = _folder_of(given)
    with contextlib.closing(socket.socket(socket.AF_INET, socket.SOCK_STREAM)) as listening:
        try:
            listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            listening.bind((LOOPBACK, port))
        except OSError as error:
            raise InputError(f"--port {port}: {error.strerror}; leave it out for any that is free") from None
        port, token = listening.getsockname()[1], secrets.token_urlsafe(32)
        app = make_app(Server(folder, profile, work, trust, memory_gb), token, port, first)
        listening.listen()
        ready(f"http://{LOOPBACK}:{port}/?{TOKEN}={token}")
        with contextlib.suppress(KeyboardInterrupt):
            uvicorn.Server(config_of(app)).run(sockets=[listening])


def config_of(app: ASGIApp) -> uvicorn.Config:
    """How the application is run."""
    return uvicorn.Config(
        app, http="h11", ws="none", lifespan="on", log_level="error", access_log=False, server_header=False,
        timeout_graceful_shutdown=ENDING_S, proxy_headers=False,
    )  # fmt: skip


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


def _no_nest(given: Path) -> str:
    raise InputError("there is no such nest or folder", file=given)


# The application: its addresses behind the guard, and the processes for as long as it runs.

POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; "
    "connect-src 'self'; font-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
"""What the server's pages may load and do: nothing that is not the server's own."""


def make_app(server: Server, token: str, port: int, first: str | None = None) -> Guard:
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
    return Guard(Starlette(routes=routes, lifespan=running), token, port, POLICY)
