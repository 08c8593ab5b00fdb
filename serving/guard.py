"""Who may speak to the server, how a request is read, and how what goes wrong becomes an answer in words."""

from __future__ import annotations

import hmac
import json
from collections.abc import Awaitable, Callable
from http import HTTPStatus
from typing import Any
from urllib.parse import parse_qs

from starlette.datastructures import Headers
from starlette.requests import Request, cookie_parser
from starlette.responses import JSONResponse, RedirectResponse, Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from kerfwise.encoder.errors import InputError

from .job_edits import expect_keys
from .server import Server
from .session import Session, Stale
from .worker import Died, Refused, error_as_json

# Who may speak to the server: the browser of this machine that was given the token, from the server's own pages.

MOST_BODY_BYTES = 32_000_000
"""A drawing of ten thousand contours has a tenth of it."""
NAMES = ("127.0.0.1", "localhost")
READING = ("GET", "HEAD")
TOKEN = "token"
"""The part of an address that carries the token the first time."""
HEADER = "x-kerfwise-token"


class TooLarge(Exception):
    """More is sent than the server takes; `too_large` says so."""


class Guard:
    """Lets in what is asked of the right host, with the token, from no other site, and not too much of it.

    Parameters
    ----------
    app
        What answers then.
    token
        The secret: in the address the first time, in a cookie from then on, or in the header `X-Kerfwise-Token`.
    port
        Of the server. Browsers may call it by `NAMES` and this port; any other name is a foreign one that was made to
        lead here.
    policy
        What pages may load and do (Content-Security-Policy).
    """

    def __init__(self, app: ASGIApp, token: str, port: int, policy: str) -> None:
        self._app, self._token, self._policy = app, token, policy
        self._hosts = frozenset(f"{name}:{port}" for name in NAMES)
        self.cookie = f"kerfwise-{port}"

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        if scope["type"] != "http":
            return
        send = self._with_headers(send)
        refused = self._refused(scope)
        if refused is not None:
            await refused(scope, receive, send)
            return
        taken = 0

        async def bounded() -> Message:
            nonlocal taken
            message = await receive()
            taken += len(message.get("body", b""))
            if taken > MOST_BODY_BYTES:
                raise TooLarge
            return message

        await self._app(scope, bounded, send)

    def _refused(self, scope: Scope) -> ASGIApp | None:
        """The answer to a request that is not let in; None for one that is."""
        headers = Headers(scope=scope)
        if headers.get("host") not in self._hosts:
            return _no(HTTPStatus.MISDIRECTED_REQUEST, "this server answers under its own name only")
        origin = headers.get("origin")
        if origin is not None and origin.removeprefix("http://") not in self._hosts:
            return _no(HTTPStatus.FORBIDDEN, "asked from another site")
        if headers.get("sec-fetch-site") in ("cross-site", "same-site") and scope["method"] not in READING:
            return _no(HTTPStatus.FORBIDDEN, "asked from another site")
        said = parse_qs(scope["query_string"].decode("latin-1")).get(TOKEN, [])
        if said and scope["method"] == "GET" and self._is_token(said[0]):
            return self._with_cookie(scope)
        by_header = self._is_token(headers.get(HEADER))
        if not by_header and not self._is_token(_cookie(headers, self.cookie)):
            return _no(HTTPStatus.UNAUTHORIZED, "wrong token, or none: use the address that kerfwise serve has printed")
        if scope["method"] not in READING and origin is None and not by_header:
            return _no(HTTPStatus.FORBIDDEN, "a request that changes something must say where it comes from")
        length = headers.get("content-length", "0")
        if not length.isdigit() or int(length) > MOST_BODY_BYTES:
            return too_large()
        return None

    def _with_cookie(self, scope: Scope) -> ASGIApp:
        """The same address without the token, so that it is not kept in the browser's history; the cookie has it."""
        answer = RedirectResponse("/" + scope["path"].lstrip("/\\"), HTTPStatus.SEE_OTHER)
        answer.set_cookie(self.cookie, self._token, httponly=True, samesite="strict", path="/")
        return answer

    def _is_token(self, said: str | None) -> bool:
        return said is not None and hmac.compare_digest(said.encode("utf-8", "replace"), self._token.encode())

    def _with_headers(self, send: Send) -> Send:
        async def strict(message: Message) -> None:
            if message["type"] == "http.response.start":
                own = {name for name, _ in message["headers"]}
                headers = {
                    b"content-security-policy": self._policy.encode(),
                    b"x-content-type-options": b"nosniff",
                    b"x-frame-options": b"DENY",
                    b"referrer-policy": b"no-referrer",
                    b"cross-origin-opener-policy": b"same-origin",
                    b"cross-origin-resource-policy": b"same-origin",
                    b"cache-control": b"no-store",
                }
                added = [(name, value) for name, value in headers.items() if name not in own]
                message = {**message, "headers": [*message["headers"], *added]}
            await send(message)

        return strict


def too_large() -> Response:
    """The answer to a request that holds too much."""
    return _no(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"too large: at most {MOST_BODY_BYTES // 1_000_000} MB are taken")


def _no(status: HTTPStatus, why: str) -> Response:
    return JSONResponse({"kind": "refused", "message": why}, status, headers={"connection": "close"})


def _cookie(headers: Headers, name: str) -> str | None:
    """Its value, whatever other servers of this machine have put beside it: browsers send cookies to every port."""
    return cookie_parser(headers.get("cookie", "")).get(name)


Answer = Callable[[Request], Awaitable[Response]]


class NotOpen(Exception):
    """No nest is open under the name that an address has."""


def session_of(server: Server, request: Request) -> Session:
    """The session that the address names; NotOpen if there is none."""
    found = server.sessions.get(request.path_params["id"])
    if found is None:
        raise NotOpen(request.path_params["id"])
    return found


async def said_in(request: Request, *keys: str) -> dict[str, Any]:
    """The body, a JSON object with these keys and no others; nothing stands for an empty one."""
    body = await request.body()
    try:
        said = json.loads(body or b"{}")
    except (ValueError, RecursionError):
        raise InputError("the body is not JSON") from None
    if not isinstance(said, dict):
        raise InputError("the body: expected a JSON object")
    expect_keys("the body", said, keys)
    return said


def changes_in(said: object) -> list[dict[str, Any]]:
    """A list of changes."""
    if not isinstance(said, list) or not all(isinstance(change, dict) for change in said):
        raise InputError("changes: expected a list of changes")
    return said


def whole(said: object) -> int:
    """A whole number."""
    try:
        return int(str(said))
    except ValueError:
        raise InputError(f"expected a whole number, got {said!r}") from None


async def gone(request: Request) -> None:
    """Comes back once who has asked is gone; the body must have been read."""
    while (await request.receive())["type"] != "http.disconnect":
        pass


def with_error_text(server: Server, answer: Answer) -> Answer:
    """The same answer, with what goes wrong in words; a stale change gets the state as it is now."""

    async def answered(request: Request) -> Response:
        try:
            if request.path_params.get("id", "") not in ("", *server.sessions):
                await server.reopen(request.path_params["id"])  # an earlier server had it open
            return await answer(request)
        except Stale:
            told = server.as_json(session_of(server, request))
            return JSONResponse({"kind": "stale", **told}, HTTPStatus.CONFLICT)
        except NotOpen as error:
            told = {"kind": "input", "message": f"no nest is open as {error.args[0]!r}"}
            return JSONResponse(told, HTTPStatus.NOT_FOUND)
        except TooLarge:
            return too_large()
        except InputError as error:
            return JSONResponse(error_as_json(error), HTTPStatus.UNPROCESSABLE_ENTITY)
        except Refused as error:
            fault = error.told["kind"] == "fault"
            status = HTTPStatus.INTERNAL_SERVER_ERROR if fault else HTTPStatus.UNPROCESSABLE_ENTITY
            return JSONResponse(error.told, status)
        except Died as error:
            return JSONResponse({"kind": "died", "message": str(error)}, HTTPStatus.SERVICE_UNAVAILABLE)

    return answered
