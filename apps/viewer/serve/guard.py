"""Who may speak to the server, how a request is read, and how what goes wrong becomes an answer in words."""

from __future__ import annotations

import asyncio
import hmac
import json
import secrets
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass, field
from html import escape
from http import HTTPStatus
from typing import Any
from urllib.parse import parse_qs

from starlette.datastructures import Headers
from starlette.requests import Request, cookie_parser
from starlette.responses import HTMLResponse, JSONResponse, RedirectResponse, Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from kerfwise.encoder.errors import InputError

from .job_edits import expect_keys
from .server import Server
from .session import Session, Stale
from .worker import Died, Refused, error_as_json

# Who may speak to the server: the browser of this machine that was given the token, from the server's own pages.

MOST_BODY_BYTES = 32_000_000
"""A drawing of ten thousand contours has a tenth of it."""
NO_KEY = (
    "wrong key, or none: use the address that kerfwise serve has printed\n"
    "An address lets one browser in, once; the terminal shows another one then. What was shown is kept: start kerfwise "
    "serve in the same folder where it has ended."
)
NAMES = ("127.0.0.1", "localhost")
READING = ("GET", "HEAD")
CODE = "code"
"""The part of an address that carries a code, which lets one browser in, once."""
BODY_S = 30.0
"""A request that is not sent to its end is waited for no longer, from one part to the next."""
HEADER = "x-kerfwise-token"


class TooLarge(Exception):
    """More is sent than the server takes; `too_large` says so."""


@dataclass(eq=False)
class Keys:
    """What lets somebody in: a program by its `token`, in the header `X-Kerfwise-Token`, a browser by its `cookie`.

    The cookie is given to who brings a code that nobody has brought before, in the address. `used` is called then.
    """

    token: str = field(default_factory=lambda: secrets.token_urlsafe(32))
    cookie: str = field(default_factory=lambda: secrets.token_urlsafe(32))
    used: Callable[[], None] = lambda: None
    _codes: set[str] = field(default_factory=set)

    def code(self) -> str:
        """A new code, for one browser."""
        made = secrets.token_urlsafe(16)
        self._codes.add(made)
        return made

    def take(self, said: str) -> bool:
        """Whether that is a code; it is none any more."""
        known = next((code for code in self._codes if _same(said, code)), None)
        if known is not None:
            self._codes.remove(known)
            self.used()
        return known is not None


class Guard:
    """Lets in what is asked of the right host, with a key, from no other site, and not too much of it.

    Parameters
    ----------
    app
        What answers then.
    keys
        What lets somebody in.
    port
        Of the server. Browsers may call it by `NAMES` and this port; any other name is a foreign one that was made to
        lead here.
    policy
        What pages may load and do (Content-Security-Policy).
    """

    def __init__(self, app: ASGIApp, keys: Keys, port: int, policy: str) -> None:
        self._app, self._keys, self._policy = app, keys, policy
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
        taken, more = 0, True

        async def bounded() -> Message:
            nonlocal taken, more
            message = await (asyncio.wait_for(receive(), BODY_S) if more else receive())
            more = bool(message.get("more_body"))
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
        by_header = _same(headers.get(HEADER), self._keys.token)
        by_cookie = _same(_cookie(headers, self.cookie), self._keys.cookie)
        tokens = parse_qs(scope["query_string"].decode("latin-1")).get(CODE, [])
        if tokens and scope["method"] == "GET" and (by_cookie or self._keys.take(tokens[0])):
            return self._with_cookie(scope)
        if not by_header and not by_cookie:
            return _no(HTTPStatus.UNAUTHORIZED, NO_KEY, "text/html" in headers.get("accept", ""))
        if scope["method"] not in READING and origin is None and not by_header:
            return _no(HTTPStatus.FORBIDDEN, "a request that changes something must say where it comes from")
        length = headers.get("content-length", "0")
        if not length.isdigit() or int(length) > MOST_BODY_BYTES:
            return too_large()
        return None

    def _with_cookie(self, scope: Scope) -> ASGIApp:
        """The same address without the code; the browser has the cookie from now on."""
        answer = RedirectResponse("/" + scope["path"].lstrip("/\\"), HTTPStatus.SEE_OTHER)
        answer.set_cookie(self.cookie, self._keys.cookie, httponly=True, samesite="strict", path="/")
        return answer

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


def _no(status: HTTPStatus, why: str, page: bool = False) -> Response:
    headers = {"connection": "close"}
    if page:
        return page_of_words("This page is not open here", why, status, headers)
    return JSONResponse({"kind": "refused", "message": why}, status, headers=headers)


def page_of_words(
    title: str, text: str, status: HTTPStatus, headers: Mapping[str, str] | None = None, link: str = ""
) -> Response:
    """A page that says something, for a browser that asked for a page; `link` leads to the list of nests."""
    more = f'<p><a href="/?list">{escape(link)}</a></p>' if link else ""
    text = "".join(f"<p>{escape(line)}</p>" for line in text.splitlines())
    head = '<!DOCTYPE html><html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width">'
    body = f"<title>{escape(title)}</title><main><h1>{escape(title)}</h1>{text}{more}</main>"
    return HTMLResponse(head + body, status, headers=dict(headers or {}))


def _same(token: str | None, key: str) -> bool:
    return token is not None and hmac.compare_digest(token.encode("utf-8", "replace"), key.encode())


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
        fields = json.loads(body or b"{}")
    except (ValueError, RecursionError):
        raise InputError("the body is not JSON") from None
    if not isinstance(fields, dict):
        raise InputError("the body: expected a JSON object")
    expect_keys("the body", fields, keys)
    return fields


def changes_in(value: object) -> list[dict[str, Any]]:
    """A list of changes."""
    if not isinstance(value, list) or not all(isinstance(change, dict) for change in value):
        raise InputError("changes: expected a list of changes")
    return value


def whole(value: object) -> int:
    """A whole number."""
    try:
        return int(str(value))
    except ValueError:
        raise InputError(f"expected a whole number, got {value!r}") from None


async def gone(request: Request) -> None:
    """Comes back once who has asked is gone; the body must have been read."""
    while (await request.receive())["type"] != "http.disconnect":
        pass


def with_error_text(server: Server, answer: Answer) -> Answer:
    """The same answer, with what goes wrong in words; a stale change gets the state as it is now."""

    async def answered(request: Request) -> Response:
        problem = await told_as_json(request)
        if problem.status_code < HTTPStatus.BAD_REQUEST or not request.url.path.startswith("/nest/"):
            return problem
        message = json.loads(bytes(problem.body))["message"]  # a browser asks for a page, and gets one
        return page_of_words(
            "This nest cannot be shown", message, HTTPStatus(problem.status_code), link="The nests of the folder"
        )

    async def told_as_json(request: Request) -> Response:
        try:
            if request.path_params.get("id", "") not in ("", *server.sessions):
                await server.reopen(request.path_params["id"])  # an earlier server had it open
            return await answer(request)
        except Stale:
            state = server.as_json(session_of(server, request))
            return JSONResponse({"kind": "stale", **state}, HTTPStatus.CONFLICT)
        except NotOpen as error:
            state = {"kind": "input", "message": f"no nest is open as {error.args[0]!r}"}
            return JSONResponse(state, HTTPStatus.NOT_FOUND)
        except TooLarge:
            return too_large()
        except TimeoutError:
            return _no(HTTPStatus.REQUEST_TIMEOUT, "the request was not sent to its end")
        except InputError as error:
            return JSONResponse(error_as_json(error), HTTPStatus.UNPROCESSABLE_ENTITY)
        except Refused as error:
            fault = error.told["kind"] == "fault"
            status = HTTPStatus.INTERNAL_SERVER_ERROR if fault else HTTPStatus.UNPROCESSABLE_ENTITY
            return JSONResponse(error.told, status)
        except Died as error:
            return JSONResponse({"kind": "died", "message": str(error)}, HTTPStatus.SERVICE_UNAVAILABLE)

    return answered
