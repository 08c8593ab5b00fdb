"""The addresses that are asked with GET: pages, and what there is to know of a nest and its plans."""

from __future__ import annotations

from typing import Any

from starlette.requests import Request
from starlette.responses import HTMLResponse, JSONResponse, Response

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.shown import shown

from .answers import Answer, session_of, whole
from .events import Stream
from .folder import is_readable
from .pages import list_page, static_file, worked_page
from .profiles import profile_told
from .server import Server
from .session import Session


class Reading:
    """What changes nothing; `first` is the name of the nest that the server was started with."""

    def __init__(self, server: Server, first: str | None) -> None:
        self._server, self._first = server, first

    def answers(self) -> dict[str, Answer]:
        """Each by its address."""
        return {
            "/": self.home,
            "/files/{name:path}": self.file,
            "/nest/{id}": self.nest,
            "/api/nests": self.nests,
            "/api/events": self.all_events,
            "/api/{id}/page": self.page,
            "/api/{id}/heat": self.heat,
            "/api/{id}/state": self.state,
            "/api/{id}/why": self.why,
            "/api/{id}/move": self.move,
            "/api/{id}/profile": self.profile,
            "/api/{id}/rule": self.rule,
            "/api/{id}/program": self.program,
            "/api/{id}/events": self.events,
        }

    async def home(self, request: Request) -> Response:
        """The nest that the server was started with, or the list of those in its folder."""
        return HTMLResponse(list_page())

    async def file(self, request: Request) -> Response:
        """A script or style sheet of the list."""
        return static_file(request.path_params["name"])

    async def nest(self, request: Request) -> Response:
        """The page of a nest."""
        return worked_page(self._session(request).name)

    async def nests(self, request: Request) -> Response:
        """Names of the nests in the folder, and, as they can be shown, those under which none can be opened."""
        names = [*self._server.folder.nests()]
        readable = [name for name in names if is_readable(name)]
        unreadable = [shown(name) for name in names if not is_readable(name)]
        return JSONResponse({"nests": readable, "unreadable": unreadable, "first": self._first})

    async def page(self, request: Request) -> Response:
        """What the page shows (`kerfwise-page/1`), of `?plan=2` or the shown plan; of two with `?plan=1&with=2`."""
        number, other, session = _plan(request), request.query_params.get("with"), self._session(request)
        if other is None:
            data = await self._server.page(session, number)
        elif number is None:
            raise InputError("with: expected plan too, the number of the other plan")
        else:
            data = await self._server.compared(session, number, whole(other))
        return Response(data, media_type="application/json")

    async def heat(self, request: Request) -> Response:
        """How hot the shown plan makes the sheet, or null."""
        return JSONResponse(await self._about(request, "heat"))

    async def state(self, request: Request) -> Response:
        """The session, and the name of the nest that the planner works for."""
        return JSONResponse({**self._session(request).as_json(), "planner": self._server.planning.turns.of})

    async def why(self, request: Request) -> Response:
        """`?contour=P1.outer&plan=2`: as `kerfwise explain --json`, with `text`."""
        contour = request.query_params.get("contour", "")
        return JSONResponse(await self._about(request, "why", contour=contour))

    async def move(self, request: Request) -> Response:
        """`?contours=P1.outer&place=3&look=0`: whether they may be cut from that place on, and what it costs."""
        said = request.query_params
        contours = said.getlist("contours")
        if not contours:
            raise InputError("contours: expected the id of a contour or the name of a part")
        given = {
            "contours": contours,
            "place": whole(said.get("place")),
            "look": said.get("look") == "1",
        }
        return JSONResponse(await self._about(request, "move", **given))

    async def program(self, request: Request) -> Response:
        """The NC text of a plan."""
        plan = self._session(request).looked_at(_plan(request))
        if plan is None:
            raise InputError("there is no plan yet")
        return Response(plan.program, media_type="text/plain; charset=utf-8")

    async def all_events(self, request: Request) -> Response:
        """Server-sent events of all nests that are open, one stream for all tabs of a browser."""
        return Stream(self._server.sessions, self._server.planning.turns)

    async def events(self, request: Request) -> Response:
        """Server-sent events: `state` when anything has changed, `progress` while the engines run, `planner`."""
        return Stream(self._server.sessions, self._server.planning.turns, self._session(request).id)

    async def profile(self, request: Request) -> Response:
        """The rules of the nest's profile with strengths and options, and whether its file may be written."""
        return JSONResponse(await profile_told(self._server, self._session(request)))

    async def rule(self, request: Request) -> Response:
        """`?rule=pierce`: its page, and pictures of what is wrong and what is right."""
        wanted = self._session(request).wanted
        return JSONResponse(await self._server.asked("rule", wanted=wanted, rule=request.query_params.get("rule", "")))

    async def _about(self, request: Request, question: str, **given: Any) -> Any:
        return await self._server.about(self._session(request), question, _plan(request), **given)

    def _session(self, request: Request) -> Session:
        return session_of(self._server, request)


def _plan(request: Request) -> int | None:
    """`?plan=2`; None for the shown one."""
    number = request.query_params.get("plan")
    return whole(number) if number else None
