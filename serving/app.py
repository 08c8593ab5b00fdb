"""What the server answers: its addresses, each with what it takes and gives."""

from __future__ import annotations

import json
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from http import HTTPStatus
from typing import Any

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import HTMLResponse, JSONResponse, Response
from starlette.routing import Route

from kerfwise.encoder.errors import InputError

from .child import as_told
from .events import Stream
from .guard import Guard, TooLarge, too_large
from .helper import Died, Refused
from .pages import list_page, static_file, worked_page
from .profiles import effect, profile_told, write_profile
from .server import Server
from .session import Session, Stale, back_to

Answer = Callable[[Request], Awaitable[Response]]


class NotOpen(Exception):
    """No nest is open under the name that an address has."""


class Addresses:
    """The server's answers, an address each."""

    def __init__(self, server: Server, first: str | None) -> None:
        self._server, self._first = server, first

    def routes(self) -> list[Route]:
        """All of them; what changes a session is sent with POST, and carries the version that it has seen."""
        reading: dict[str, Answer] = {
            "/": self.home,
            "/files/{name:path}": self.file,
            "/nest/{id}": self.nest,
            "/api/{id}/page": self.page,
            "/api/{id}/heat": self.heat,
            "/api/nests": self.nests,
            "/api/{id}/state": self.state,
            "/api/{id}/why": self.why,
            "/api/{id}/move": self.move,
            "/api/{id}/profile": self.profile,
            "/api/{id}/rule": self.rule,
            "/api/{id}/program": self.program,
            "/api/{id}/events": self.events,
        }
        writing: dict[str, Answer] = {
            "/api/open": self.open,
            "/api/drop": self.drop,
            "/api/{id}/edit": self.edit,
            "/api/{id}/cut": self.cut,
            "/api/{id}/back": self.back,
            "/api/{id}/solve": self.solve,
            "/api/{id}/cancel": self.cancel,
            "/api/{id}/try": self.tried,
            "/api/{id}/save": self.save,
            "/api/{id}/effect": self.effect,
            "/api/{id}/profile": self.write_profile,
        }
        asked = [Route(path, self._told(answer), methods=["GET"]) for path, answer in reading.items()]
        return asked + [Route(path, self._told(answer), methods=["POST"]) for path, answer in writing.items()]

    async def home(self, request: Request) -> Response:
        """The nest that the server was started with, or the list of those in its folder."""
        return HTMLResponse(list_page())

    async def file(self, request: Request) -> Response:
        return static_file(request.path_params["name"])

    async def nest(self, request: Request) -> Response:
        return worked_page(self._session(request).name)

    async def page(self, request: Request) -> Response:
        """What the page shows (`kerfwise-page/1`), of `?plan=2` or the shown plan."""
        number = request.query_params.get("plan")
        text = await self._server.page(self._session(request), _whole(number) if number else None)
        return Response(text.encode("utf-8", "surrogatepass"), media_type="application/json")

    async def heat(self, request: Request) -> Response:
        """How hot the shown plan makes the sheet, or null."""
        return JSONResponse(await self._about(request, "heat"))

    async def nests(self, request: Request) -> Response:
        """Names of the nests in the folder."""
        return JSONResponse({"nests": [*self._server.folder.nests()], "first": self._first})

    async def open(self, request: Request) -> Response:
        """`{"nest": NAME, "repair": false}` gives the session's state."""
        said = await _json(request)
        path = self._server.folder.nest(str(said.get("nest", "")))
        return JSONResponse((await self._server.open_nest(path, said.get("repair") is True)).as_json())

    async def drop(self, request: Request) -> Response:
        """A drawing as the body, `?name=plate.dxf&repair=0`: one that can be cut is written into the folder."""
        said = request.query_params
        session = await self._server.drop(said.get("name", ""), await request.body(), said.get("repair") == "1")
        return JSONResponse(session.as_json(), HTTPStatus.CREATED)

    async def state(self, request: Request) -> Response:
        return JSONResponse(self._session(request).as_json())

    async def why(self, request: Request) -> Response:
        """`?contour=P1.outer&plan=2`: as `kerfwise explain --json`, with `text`."""
        contour = request.query_params.get("contour", "")
        return JSONResponse(await self._about(request, "why", contour=contour))

    async def move(self, request: Request) -> Response:
        """`?contours=P1.outer&place=3&look=0`: whether they may be cut from that place on, and what it costs."""
        said = request.query_params
        given = {
            "contours": said.getlist("contours"),
            "place": _whole(said.get("place")),
            "look": said.get("look") == "1",
        }
        return JSONResponse(await self._about(request, "move", **given))

    async def program(self, request: Request) -> Response:
        """The NC text of a plan."""
        session, number = self._session(request), request.query_params.get("plan")
        plan = session.alternative(_whole(number)) if number else session.current
        if plan is None:
            raise InputError("there is no plan yet")
        return Response(plan.program, media_type="text/plain; charset=utf-8")

    async def events(self, request: Request) -> Response:
        """Server-sent events: `state` when anything has changed, `progress` while the engines run."""
        return Stream(self._session(request))

    async def edit(self, request: Request) -> Response:
        """`{"version": 3, "changes": [{"lock": "P2 first"}, …]}`; see `edits.py` for what can be changed."""
        session, said = await self._writing(request)
        undone = await self._server.edit(session, _changes(said.get("changes")))
        return JSONResponse({**session.as_json(), "undone": undone})

    async def cut(self, request: Request) -> Response:
        """`{"version": 3, "upto": 7}`: the first cuts of the shown plan are made already; 0 takes that back."""
        session, said = await self._writing(request)
        await self._server.cut_up_to(session, _whole(said.get("upto")))
        return JSONResponse(session.as_json())

    async def back(self, request: Request) -> Response:
        """`{"version": 3, "to": 1}`: an earlier plan is shown, and what it was made of is wanted again."""
        session, said = await self._writing(request)
        number = _whole(said.get("to"))
        await self._server.want(session, back_to(session, number), shown=number)
        return JSONResponse(session.as_json())

    async def solve(self, request: Request) -> Response:
        """`{"version": 3, "work": 30, "relax": false}`: the planning begins; events tell how it goes."""
        session, said = await self._writing(request)
        work = said.get("work")
        if work is not None and not (isinstance(work, int | float) and 0 < work <= 10_000):
            raise InputError(f"work: expected a number over 0, got {work!r}")
        self._server.solve(session, work, said.get("relax") is True)
        return JSONResponse(session.as_json(), HTTPStatus.ACCEPTED)

    async def cancel(self, request: Request) -> Response:
        """`{"at_once": false}`: the best plan so far is kept, unless it is to end at once."""
        session, said = self._session(request), await _json(request)
        self._server.cancel(session, said.get("at_once") is True)
        return JSONResponse(session.as_json(), HTTPStatus.ACCEPTED)

    async def tried(self, request: Request) -> Response:
        """`{"changes": […], "relax": false}`: what they would bring; nothing is changed."""
        session, said = self._session(request), await _json(request)
        changes = _changes(said.get("changes") or [])
        return JSONResponse(await self._server.tried(session, changes, said.get("relax") is True))

    async def save(self, request: Request) -> Response:
        """`{"version": 3}`: the files of the shown plan and its job file, and the command line that makes the same."""
        session, _ = await self._writing(request)
        told = session.save(self._server.folder)
        return JSONResponse({**session.as_json(), "saved": told})

    async def profile(self, request: Request) -> Response:
        """The rules of the nest's profile with strengths and options, and whether its file may be written."""
        return JSONResponse(await profile_told(self._server, self._session(request)))

    async def rule(self, request: Request) -> Response:
        """`?rule=pierce`: its page, and pictures of what is wrong and what is right."""
        wanted = self._session(request).wanted
        return JSONResponse(await self._server.asked("rule", wanted=wanted, rule=request.query_params.get("rule", "")))

    async def effect(self, request: Request) -> Response:
        """`{"changes": [{"rule": "pierce", "key": "clearance", "to": "2 mm"}]}`: what they would bring on the nest."""
        session, said = self._session(request), await _json(request)
        return JSONResponse(await effect(self._server, session, said.get("changes")))

    async def write_profile(self, request: Request) -> Response:
        """`{"version": 3, "sha256": …, "changes": […], "as": "ours.yaml"}`: they are written into the profile."""
        session, said = await self._writing(request)
        told = await write_profile(self._server, session, said)
        return JSONResponse({**session.as_json(), "written": told})

    async def _about(self, request: Request, question: str, **given: Any) -> Any:
        number = request.query_params.get("plan")
        return await self._server.about(self._session(request), question, _whole(number) if number else None, **given)

    def _session(self, request: Request) -> Session:
        found = self._server.sessions.get(request.path_params["id"])
        if found is None:
            raise NotOpen(request.path_params["id"])
        return found

    def _told(self, answer: Answer) -> Answer:
        """What goes wrong becomes an answer in words; a stale change gets the state as it is now."""

        async def answered(request: Request) -> Response:
            try:
                return await answer(request)
            except Stale:
                return JSONResponse({"kind": "stale", **self._session(request).as_json()}, HTTPStatus.CONFLICT)
            except NotOpen as error:
                told = {"kind": "input", "message": f"no nest is open as {error.args[0]!r}"}
                return _wrong(HTTPStatus.NOT_FOUND, told)
            except TooLarge:
                return too_large()
            except InputError as error:
                return _wrong(HTTPStatus.UNPROCESSABLE_ENTITY, as_told(error))
            except Refused as error:
                fault = error.told["kind"] == "fault"
                return _wrong(
                    HTTPStatus.INTERNAL_SERVER_ERROR if fault else HTTPStatus.UNPROCESSABLE_ENTITY, error.told
                )
            except Died as error:
                return _wrong(HTTPStatus.SERVICE_UNAVAILABLE, {"kind": "died", "message": str(error)})

        return answered

    async def _writing(self, request: Request) -> tuple[Session, dict[str, Any]]:
        session, said = self._session(request), await _json(request)
        session.expect(said.get("version"))
        return session, said


def _wrong(status: HTTPStatus, told: dict[str, Any]) -> Response:
    return JSONResponse(told, status)


async def _json(request: Request) -> dict[str, Any]:
    """The body, a JSON object; nothing stands for an empty one."""
    body = await request.body()
    try:
        said = json.loads(body or b"{}")
    except (ValueError, RecursionError):
        raise InputError("the body is not JSON") from None
    if not isinstance(said, dict):
        raise InputError("the body: expected a JSON object")
    return said


def _changes(said: object) -> list[dict[str, Any]]:
    if not isinstance(said, list) or not all(isinstance(change, dict) for change in said):
        raise InputError("changes: expected a list of changes")
    return said


def _whole(said: object) -> int:
    try:
        return int(str(said))
    except ValueError:
        raise InputError(f"expected a whole number, got {said!r}") from None


def make_app(server: Server, token: str, port: int, first: str | None = None) -> Guard:
    """The whole application; `first` is the name of the nest that the server was started with."""

    @asynccontextmanager
    async def running(app: Starlette) -> AsyncIterator[None]:
        await server.begin()
        try:
            yield
        finally:
            await server.end()

    routes = Addresses(server, first).routes()
    return Guard(Starlette(routes=list(routes), lifespan=running), token, port, POLICY)


POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; "
    "connect-src 'self'; font-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
"""What the server's pages may load and do: nothing that is not the server's own."""
