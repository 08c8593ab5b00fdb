"""The application: its addresses behind the guard, and the processes for as long as it runs."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from starlette.applications import Starlette
from starlette.routing import Route

from .answers import in_words
from .guard import Guard
from .reading import Reading
from .server import Server
from .writing import Writing

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
        Route(path, in_words(server, answer), methods=[method])
        for method, answers in asked
        for path, answer in answers.items()
    ]
    return Guard(Starlette(routes=routes, lifespan=running), token, port, POLICY)
