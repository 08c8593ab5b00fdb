"""What all addresses share: how a request is read, and how what goes wrong becomes an answer in words."""

from __future__ import annotations

import json
from collections.abc import Awaitable, Callable
from http import HTTPStatus
from typing import Any

from starlette.requests import Request
from starlette.responses import JSONResponse, Response

from kerfwise.encoder.errors import InputError

from .child import as_told
from .edits import expect_keys
from .guard import TooLarge, too_large
from .helper import Died, Refused
from .server import Server
from .session import Session, Stale

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


def in_words(server: Server, answer: Answer) -> Answer:
    """The same answer, with what goes wrong in words; a stale change gets the state as it is now."""

    async def answered(request: Request) -> Response:
        try:
            return await answer(request)
        except Stale:
            return JSONResponse({"kind": "stale", **session_of(server, request).as_json()}, HTTPStatus.CONFLICT)
        except NotOpen as error:
            told = {"kind": "input", "message": f"no nest is open as {error.args[0]!r}"}
            return JSONResponse(told, HTTPStatus.NOT_FOUND)
        except TooLarge:
            return too_large()
        except InputError as error:
            return JSONResponse(as_told(error), HTTPStatus.UNPROCESSABLE_ENTITY)
        except Refused as error:
            fault = error.told["kind"] == "fault"
            status = HTTPStatus.INTERNAL_SERVER_ERROR if fault else HTTPStatus.UNPROCESSABLE_ENTITY
            return JSONResponse(error.told, status)
        except Died as error:
            return JSONResponse({"kind": "died", "message": str(error)}, HTTPStatus.SERVICE_UNAVAILABLE)

    return answered
